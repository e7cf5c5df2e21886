//! `make-half-space-table FILE` writes the table of the half-space model, the same bytes on every run.

#[cfg(test)]
mod check;
mod fit;
mod forward;
mod grid;
mod linear;
mod reflectance;
mod single;
mod walks;

use bssrdf::half_space::layout;
use std::path::Path;
use std::process::ExitCode;

const USAGE: &str = "usage: make-half-space-table FILE
Writes the table of the half-space model from random walks (minutes), the same bytes on every run.";

/// Walks of each index.
const WALKS: u64 = 3_000_000;
const SEED: u64 = 1;

fn main() -> ExitCode {
    let arguments: Vec<_> = std::env::args_os().skip(1).collect();
    let [file] = arguments.as_slice() else {
        eprintln!("{USAGE}");
        return ExitCode::from(2);
    };
    if file == "--help" || file == "-h" {
        println!("{USAGE}");
        return ExitCode::SUCCESS;
    }
    if file.to_string_lossy().starts_with('-') {
        eprintln!("make-half-space-table: unknown option {}\n{USAGE}", file.display());
        return ExitCode::from(2);
    }
    let mut numbers: Vec<i16> = layout::ETAS.iter().flat_map(|eta| of_index(*eta)).collect();
    for eta in layout::forward::ETAS {
        println!("phase functions of index {eta}");
        numbers.extend(forward::ratios(eta, SEED).into_iter().map(|ratio| integer(ratio, layout::UNIT)));
    }
    let bytes = layout::encode(&numbers);
    if let Err(error) = std::fs::write(Path::new(file), &bytes) {
        eprintln!("make-half-space-table: cannot write {}: {error}", file.display());
        return ExitCode::from(2);
    }
    println!("{} ({} bytes)", file.display(), bytes.len());
    ExitCode::SUCCESS
}

/// The numbers of one index.
fn of_index(eta: f64) -> Vec<i16> {
    println!("index {eta}");
    let measured = fit::Measured { eta, walks: walks::walks(eta, WALKS, SEED), single: single::rings(eta) };
    let mut numbers = Vec::new();
    for record in measured.records() {
        numbers.extend(record.terms.iter().flatten().map(|value| integer(*value, layout::UNIT)));
        numbers.extend(record.high.map(|value| integer(value, layout::UNIT)));
        numbers.push(integer(record.cosine, layout::COSINE_UNIT));
    }
    numbers
}

/// The next of the integers that are stored.
fn integer(value: f64, unit: f64) -> i16 {
    (value / unit).round().clamp(f64::from(i16::MIN), f64::from(i16::MAX)) as i16
}

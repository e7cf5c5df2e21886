//! `compare REFERENCE TEST`: metrics, verdict, exit code 0, 1 or 2.

use std::path::{Path, PathBuf};

use arguments::Arguments;
use clap::Parser;
use cli::Failure;
use compare::{Report, compare};
use formats::image::Image;
use serde::Serialize;

mod arguments;

/// The report with the names of its files.
#[derive(Serialize)]
struct Document<'a> {
    #[serde(flatten)]
    report: &'a Report,
    reference: String,
    test: String,
    verdict: &'a str,
}

fn main() {
    cli::run("compare", || judge(&Arguments::parse()))
}

fn judge(arguments: &Arguments) -> Result<u8, Failure> {
    let (reference, test) = (Image::read(&arguments.reference)?, Image::read(&arguments.test)?);
    let report = compare(&reference, &test, &arguments.settings()).map_err(|mismatch| {
        let (test, reference) = (arguments.test.display(), arguments.reference.display());
        Failure::usage(format!("{test}: {mismatch} (the reference is {reference})"))
    })?;
    let name = arguments.test.file_name().unwrap_or_default().to_string_lossy();
    let verdict = report.verdict(&name);
    if let Some(path) = &arguments.json {
        write_json(path, arguments, &report, &verdict)?;
    }
    if !arguments.common.quiet {
        cli::print(&report.table())?;
    }
    cli::print(&verdict)?;
    Ok(if report.pass { 0 } else { 1 })
}

fn write_json(path: &Path, arguments: &Arguments, report: &Report, verdict: &str) -> Result<(), Failure> {
    let inputs = [&arguments.reference, &arguments.test];
    let same = |input: &PathBuf| matches!((input.canonicalize(), path.canonicalize()), (Ok(a), Ok(b)) if a == b);
    if inputs.into_iter().any(same) {
        return Err(Failure::usage(format!("{}: --json would replace an image; give another name", path.display())));
    }
    let document = Document {
        report,
        reference: arguments.reference.display().to_string(),
        test: arguments.test.display().to_string(),
        verdict: verdict.trim_end(),
    };
    let text = serde_json::to_string_pretty(&document)?;
    Ok(formats::atomic::write(path, (text + "\n").as_bytes())?)
}

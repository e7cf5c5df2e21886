//! Runs files and mutations of them through a target: `replay TARGET MUTATIONS FILE...`.
//!
//! Prints the name of each case before it runs, so that the last line names the one that failed.

use fuzz_targets::{mutation::mutate, target};
use std::process::ExitCode;

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [name, mutations, files @ ..] = &arguments[..] else { return usage() };
    let (Some(run), Ok(mutations)) = (target(name), mutations.parse::<u64>()) else { return usage() };
    let mut accepted = 0;
    for path in files {
        let Ok(file) = std::fs::read(path) else { return usage() };
        println!("{path}");
        accepted += u64::from(run(&file));
        for number in 0..mutations {
            println!("{path}, mutation {number}");
            accepted += u64::from(run(&mutate(&file, number)));
        }
    }
    println!("accepted {accepted} of {}", files.len() as u64 * (mutations + 1));
    ExitCode::SUCCESS
}

fn usage() -> ExitCode {
    eprintln!("usage: replay facts|cloud|gltf|image|limits|medium|view MUTATIONS FILE...");
    ExitCode::from(2)
}

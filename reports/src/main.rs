//! Measures the error of the models and the speed of the programs, and writes it to `docs/reports`. Called by `make
//! accuracy`, `make curve`, `make curve-full` and `make scale`.

mod accuracy;
mod error;
mod markdown;
mod program;
mod scale;
mod speed;
mod truth;

use clap::{Parser, Subcommand};
use speed::Effort;
use std::{
    fs,
    path::{Path, PathBuf},
    process::ExitCode,
};

/// Measures the error of the models and the speed of the programs
#[derive(Parser)]
struct Arguments {
    /// Folder that the report is written to
    #[arg(long)]
    output: PathBuf,
    #[command(subcommand)]
    report: Report,
}

#[derive(Subcommand)]
enum Report {
    /// The models against random walks: accuracy.md and its pictures
    Accuracy {
        /// Folder of sample-surface and gather
        #[arg(long)]
        programs: PathBuf,
        /// Folder that exact images are kept in
        #[arg(long, default_value = "out/truth")]
        truths: PathBuf,
        /// A minute, to try the program itself: the figures mean nothing
        #[arg(long)]
        tiny: bool,
    },
    /// Time against error: speed.md, its plots and speed.csv
    Speed {
        /// Folder of bunny.glb and dragon.glb
        #[arg(long)]
        meshes: PathBuf,
        /// Folder of sample-surface and gather
        #[arg(long)]
        programs: PathBuf,
        /// Folder in which exact images are kept
        #[arg(long)]
        truths: PathBuf,
        /// Larger clouds and more runs: an hour instead of minutes
        #[arg(long)]
        full: bool,
        /// Half a minute, to try the program itself: the figures mean nothing
        #[arg(long, conflicts_with = "full")]
        tiny: bool,
    },
    /// Cost of clouds and images of many sizes, and a forecast for farms: scale.md
    Scale {
        /// Folder of sample-surface and gather
        #[arg(long)]
        programs: PathBuf,
    },
}

fn main() -> ExitCode {
    match run(&Arguments::parse()) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("reports: {error}");
            ExitCode::from(2)
        }
    }
}

fn run(Arguments { output, report }: &Arguments) -> Result<(), Box<dyn std::error::Error>> {
    let data = Path::new(env!("CARGO_MANIFEST_DIR")).join("../data");
    match report {
        Report::Accuracy { programs, truths, tiny } => {
            let effort = if *tiny { accuracy::Effort::Tiny } else { accuracy::Effort::Whole };
            accuracy::write(programs, truths, effort, output)?;
        }
        Report::Speed { meshes, programs, truths, full, tiny } => {
            let effort = match (full, tiny) {
                (true, _) => Effort::Full,
                (_, true) => Effort::Tiny,
                _ => Effort::Quick,
            };
            speed::write(meshes, programs, &data, truths, effort, output)?;
        }
        Report::Scale { programs } => fs::write(output.join("scale.md"), scale::document(programs, &data)?)?,
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn accepts(line: &str) -> bool {
        Arguments::try_parse_from(line.split_whitespace()).is_ok()
    }

    #[test]
    fn the_command_line_is_checked() {
        assert!(accepts("reports --output c speed --meshes a --programs b --truths d --full"));
        assert!(accepts("reports --output c accuracy --programs b --tiny"));
        assert!(!accepts("reports speed --meshes a --programs b --truths d"));
        assert!(!accepts("reports --output c speed --meshes a --programs b --truths d --fast"));
    }
}

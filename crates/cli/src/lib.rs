//! How a stage behaves as a program: arguments in common, exit codes, progress, signals.

mod allocator;
mod count;
mod environment;
mod failure;
mod files;
mod medium;
mod memory;
mod named;
mod numbers;
mod printable;
mod progress;
mod rgb;
mod scene_args;
mod scene_settings;
mod seconds;
mod tables;
mod threads;
mod truncated;
mod words;

pub use count::{count, count_up, parse_count};
pub use environment::EnvironmentSource;
pub use failure::{Failure, run};
pub use files::{Files, file_name, is_same_file};
pub use medium::{ReadMediumError, is_file, read_medium, scene_medium};
pub use memory::{Need, available_memory_bytes, peak_memory_bytes, require_memory};
pub use named::{Candidate, Unclear, the_one, word_for};
pub use numbers::parse_relative_error;
pub use printable::printable;
pub use progress::Progress;
pub use rgb::parse_rgb;
pub use scene_args::SceneArgs;
pub use scene_settings::{SceneSettings, normal_kind};
pub use seconds::Seconds;
pub use tables::{camera_names, camera_table, material_names, material_table};
pub use words::one_of;

use clap::{Args, ValueEnum};
use std::{
    io::{self, ErrorKind, Write},
    num::NonZeroUsize,
};

/// Arguments that every program has.
#[derive(Args, Clone, Debug)]
pub struct Common {
    /// Seed of the random numbers; the same seed gives the same bytes
    #[arg(long, value_name = "N", default_value_t = 0)]
    pub seed: u64,
    /// Threads to use [default: all cores]
    #[arg(short = 'j', long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    pub threads: Option<u16>,
    /// How to show progress: a bar on a terminal and two lines elsewhere (auto), two lines, or nothing
    #[arg(long, value_name = "HOW", default_value = "auto")]
    pub progress: ProgressStyle,
    /// Print nothing but results and errors
    #[arg(long)]
    pub quiet: bool,
}

/// How progress is shown.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum ProgressStyle {
    Auto,
    Plain,
    None,
}

impl Common {
    /// Runs `work` on as many threads as asked for, or as can be started. All parallel work is done inside, so that no
    /// library starts threads of its own.
    pub fn in_pool<T: Send>(&self, work: impl FnOnce() -> T + Send) -> Result<T, Failure> {
        threads::in_pool(self.thread_count().get(), |line| self.warn(line), work)
    }

    /// The number of threads that was asked for.
    pub fn thread_count(&self) -> NonZeroUsize {
        self.threads.and_then(|count| NonZeroUsize::new(count.into())).unwrap_or_else(threads::cores)
    }

    /// A line for people, on stderr.
    pub fn say(&self, line: impl std::fmt::Display) {
        if !self.quiet {
            tell(line);
        }
    }

    /// A warning, on stderr.
    pub fn warn(&self, line: impl std::fmt::Display) {
        self.say(format_args!("warning: {line}"));
    }
}

/// A line on stderr, whatever names it holds; a closed stderr is nobody's fault.
fn tell(line: impl std::fmt::Display) {
    writeln!(io::stderr(), "{}", printable(&line.to_string())).ok();
}

/// Writes a result to stdout. A reader that has seen enough (`| head`) is no failure.
pub fn print(text: &str) -> Result<(), Failure> {
    let mut out = io::stdout().lock();
    match out.write_all(text.as_bytes()).and_then(|()| out.flush()) {
        Err(e) if e.kind() != ErrorKind::BrokenPipe => Err(Failure::usage(format!("stdout: cannot write: {e}"))),
        _ => Ok(()),
    }
}

//! Arguments and behavior that every program has.

use crate::{failure::Failure, terminal::tell, threads};
use clap::{Args, ValueEnum};
use std::{
    fmt::Display,
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
    /// Runs `work` on as many threads as were asked for, or as can be started. All parallel work is done inside, so
    /// that no library starts threads of its own.
    pub fn in_pool<T: Send>(&self, work: impl FnOnce() -> T + Send) -> Result<T, Failure> {
        threads::in_pool(self.thread_count().get(), |line| self.warn(line), work)
    }

    /// The number of threads that was asked for.
    pub fn thread_count(&self) -> NonZeroUsize {
        self.threads.and_then(|count| NonZeroUsize::new(count.into())).unwrap_or_else(threads::cores)
    }

    /// Prints a line on stderr, unless the program is to be quiet.
    pub fn say(&self, line: impl Display) {
        if !self.quiet {
            tell(line);
        }
    }

    /// Prints a warning on stderr, unless the program is to be quiet.
    pub fn warn(&self, line: impl Display) {
        self.say(format_args!("warning: {line}"));
    }
}

/// Writes a result to stdout. It is no failure if the reader closes the pipe early, as `head` does.
pub fn print(text: &str) -> Result<(), Failure> {
    let mut out = io::stdout().lock();
    match out.write_all(text.as_bytes()).and_then(|()| out.flush()) {
        Err(e) if e.kind() != ErrorKind::BrokenPipe => Err(Failure::usage(format!("stdout: cannot write: {e}"))),
        _ => Ok(()),
    }
}

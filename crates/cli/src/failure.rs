//! How a program ends.

use crate::{allocator, terminal::tell, truncated};
use signal_hook::{
    consts::{SIGHUP, SIGINT, SIGTERM, SIGXCPU, SIGXFSZ},
    flag,
    iterator::Signals,
};
use std::{
    fmt::Display,
    sync::{Arc, atomic::AtomicBool, mpsc},
    thread,
};

/// Why a program stops early: one message, and its exit code.
#[derive(Debug)]
pub struct Failure {
    pub code: u8,
    pub message: String,
}

impl Failure {
    /// Bad usage, input or output: exit code 2.
    pub fn usage(message: impl Into<String>) -> Failure {
        Failure { code: 2, message: message.into() }
    }

    /// Adds to the failure the part of the input in which it occurred.
    pub fn within(self, part: impl Display) -> Failure {
        Failure { message: format!("{part}: {}", self.message), ..self }
    }

    /// A value that is not finite reached an output: exit code 3.
    pub fn numerical(message: impl Into<String>) -> Failure {
        Failure { code: 3, message: message.into() }
    }
}

impl<E: std::error::Error> From<E> for Failure {
    fn from(error: E) -> Failure {
        Failure::usage(one_line(error))
    }
}

/// The message of a library, on one line.
fn one_line(error: impl Display) -> String {
    error.to_string().lines().map(str::trim).collect::<Vec<_>>().join(" ")
}

/// Whether the process was started with this signal ignored; false where the system does not tell.
fn is_ignored(signal: i32) -> bool {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let ignored = status.lines().find_map(|line| u64::from_str_radix(line.strip_prefix("SigIgn:")?.trim(), 16).ok());
    ignored.is_some_and(|signals| signals >> (signal - 1) & 1 == 1)
}

/// Runs a program and ends the process with its exit code. On SIGHUP, SIGINT, SIGTERM and SIGXCPU (`ulimit -t`) the
/// temporary files are removed and the exit code is 128 plus the number of the signal; under `nohup`, SIGHUP is
/// ignored. A file that grows beyond `ulimit -f` is an output that cannot be written, like one on a full disk.
pub fn run(name: &str, program: impl FnOnce() -> Result<u8, Failure>) -> ! {
    truncated::end_with_a_message();
    allocator::end_without_signal_stacks();
    // With a handler, the system reports a file that would be too long to its writer, instead of ending the process.
    flag::register(SIGXFSZ, Arc::new(AtomicBool::new(false))).ok();
    clean_up_after_signals();
    let code = program().unwrap_or_else(|failure| {
        tell(format_args!("{name}: {}", failure.message));
        failure.code
    });
    std::process::exit(i32::from(code))
}

/// Starts the thread that waits for signals. If no thread can be started, signals end the process at once, and the next
/// writer of the same file removes the temporary file.
fn clean_up_after_signals() {
    let hangup = (!is_ignored(SIGHUP)).then_some(SIGHUP);
    let (ready, is_ready) = mpsc::channel();
    let wait = move || {
        let signals = Signals::new(hangup.into_iter().chain([SIGINT, SIGTERM, SIGXCPU]));
        ready.send(()).ok();
        if let Ok(mut signals) = signals
            && let Some(signal) = signals.forever().next()
        {
            formats::atomic::abandon(128 + signal);
        }
    };
    if thread::Builder::new().spawn(wait).is_ok() {
        is_ready.recv().ok();
    }
}

//! The signal by which a user asks a running program for what it has.

use signal_hook::{consts::SIGUSR1, flag};
use std::sync::{
    Arc,
    atomic::{AtomicBool, Ordering},
};

/// Whether SIGUSR1 has come. Where the system refuses a handler, it never has.
#[derive(Debug)]
pub struct Asked(Arc<AtomicBool>);

impl Asked {
    /// From now on the signal does not end the process.
    pub fn listen() -> Asked {
        let came = Arc::new(AtomicBool::new(false));
        flag::register(SIGUSR1, came.clone()).ok();
        Asked(came)
    }

    /// Whether the signal has come since the last call.
    pub fn take(&self) -> bool {
        self.0.swap(false, Ordering::Relaxed)
    }
}

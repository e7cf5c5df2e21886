//! The threads of a program: one pool, of as many threads as were asked for, or as there are cores, or as can be
//! started.

use crate::Failure;
use rayon::{ThreadPool, ThreadPoolBuilder};
use std::{
    num::NonZeroUsize,
    sync::{Mutex, PoisonError},
    thread,
    time::Duration,
};

/// The pool of the process, once it is needed, and the number of threads that was asked for.
static POOL: Mutex<Option<(usize, &'static ThreadPool)>> = Mutex::new(None);

/// The number of cores that this process may use. Environment variables do not change it, so that the command line
/// alone decides.
pub(crate) fn cores() -> NonZeroUsize {
    thread::available_parallelism().unwrap_or(NonZeroUsize::MIN)
}

/// Runs `work` on a pool of `count` threads; `warn` is called if only fewer can be started.
pub(crate) fn in_pool<T: Send>(
    count: usize,
    warn: impl Fn(String),
    work: impl FnOnce() -> T + Send,
) -> Result<T, Failure> {
    let pool = {
        let mut kept = POOL.lock().unwrap_or_else(PoisonError::into_inner);
        match *kept {
            Some((asked, pool)) if asked == count => pool,
            _ => {
                let pool: &'static ThreadPool = Box::leak(Box::new(start(count, warn)?));
                *kept = Some((count, pool));
                pool
            }
        }
    };
    Ok(pool.install(work))
}

/// Starts a pool of `count` threads, or of half as many after each failure, and at last of the calling thread alone.
fn start(count: usize, warn: impl Fn(String)) -> Result<ThreadPool, Failure> {
    let mut wanted = count;
    let mut failure = None;
    while wanted > 0 {
        match ThreadPoolBuilder::new().num_threads(wanted).build() {
            Ok(pool) => {
                if let Some(fault) = failure {
                    warn(format!("--threads: only {wanted} of {count} threads could be started: {fault}"));
                }
                return Ok(pool);
            }
            Err(fault) => failure = Some(fault),
        }
        // The threads of the failed pool count towards the limit until they have ended by themselves.
        thread::sleep(Duration::from_millis(20));
        wanted /= 2;
    }
    let pool = ThreadPoolBuilder::new().num_threads(1).use_current_thread().build();
    let pool =
        pool.map_err(|e| Failure::usage(format!("--threads: no thread can be started: {e}; raise `ulimit -u`")))?;
    if let Some(fault) = failure {
        warn(format!("--threads: none of {count} threads could be started, all work is done by one: {fault}"));
    }
    Ok(pool)
}

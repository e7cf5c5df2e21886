//! Work on blocks of a file by several threads.

use std::{
    num::NonZeroUsize,
    sync::{Mutex, PoisonError},
    thread::{Builder, ScopedJoinHandle},
};

/// The results of `work` for each item, in the order of the items for any number of threads.
pub(crate) fn parallel<T: Send, R: Send>(threads: NonZeroUsize, items: Vec<T>, work: impl Fn(T) -> R + Sync) -> Vec<R> {
    if threads.get() == 1 || items.len() < 2 {
        return items.into_iter().map(work).collect();
    }
    let share = items.len().div_ceil(threads.get());
    let mut rest = items.into_iter();
    let shares = std::iter::from_fn(|| Some(rest.by_ref().take(share).collect::<Vec<T>>()).filter(|s| !s.is_empty()));
    let shares: Vec<Mutex<Vec<T>>> = shares.map(Mutex::new).collect();
    // Each share is done once, by its own thread, or by this one where the system starts no thread.
    let done = |share: &Mutex<Vec<T>>| {
        let items = std::mem::take(&mut *share.lock().unwrap_or_else(PoisonError::into_inner));
        items.into_iter().map(&work).collect::<Vec<R>>()
    };
    std::thread::scope(|scope| {
        let done = &done;
        let start = |share| (share, Builder::new().spawn_scoped(scope, move || done(share)).ok());
        let started: Vec<_> = shares.iter().map(start).collect();
        let result = |(share, thread): (_, Option<ScopedJoinHandle<Vec<R>>>)| match thread {
            Some(thread) => thread.join().expect("work on a block does not panic"),
            None => done(share),
        };
        started.into_iter().flat_map(result).collect()
    })
}

#[cfg(test)]
mod tests {
    use std::collections::HashSet;

    use super::*;

    /// Seen to catch: threads joined last first, more shares than threads, the last share left out.
    #[test]
    fn results_keep_the_order_of_the_items() {
        for count in [0, 1, 2, 7, 64] {
            let expected: Vec<usize> = (0..count).map(|n| n * n).collect();
            for threads in [1, 2, 3, 64, 100] {
                let work = |n: usize| (n * n, std::thread::current().id());
                let (found, by): (Vec<usize>, HashSet<_>) =
                    parallel(NonZeroUsize::new(threads).unwrap(), (0..count).collect(), work).into_iter().unzip();
                assert_eq!(found, expected, "{threads} threads");
                assert!(by.len() <= threads, "{} threads instead of {threads}", by.len());
            }
        }
    }
}

//! One result per seed: pinned random numbers, the same bytes for any number of threads, the same bits for any vector
//! width.

#[path = "determinism/streams.rs"]
mod streams;
#[path = "determinism/threads.rs"]
mod threads;
#[path = "determinism/widths.rs"]
mod widths;

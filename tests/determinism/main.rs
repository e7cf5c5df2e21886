//! One result per seed: pinned random numbers, the same bytes for any number of threads, the same bits for any vector
//! width.

mod streams;
mod threads;
mod widths;

//! Tests of the library on images with known faults, and of the program: its exit code, the last line of stdout, one
//! line of stderr, and the files that it writes.
//!
//! Seen to catch: a gate written as `!(value > limit)`, the worst channel found with `>`, infinity counted as finite,
//! gates on the channels of a layer together, each structure check left out, exit code 0 whatever the verdict, a limit
//! that may be NaN.

mod accept;
mod artifacts;
mod gates;
mod limits;
mod meaning;
mod memory;
mod names;
mod noise_program;
mod noise_statistics;
mod pages;
mod peers;
mod picture;
mod report;
mod slips;
#[cfg(unix)]
mod snippets;
mod structure;
mod support;
mod synthetic;

//! The programs as users start them.

mod bad_input;
mod pipeline;
mod support;

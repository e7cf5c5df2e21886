//! The programs as users start them.

mod bad_input;
mod hostile;
mod pipeline;
mod support;
mod targets;

//! Lines for people.

use crate::printable::printable;
use std::{
    fmt::Display,
    io::{self, Write},
};

/// Prints a line on stderr, with the names in it made safe for a terminal. A closed stderr is no failure.
pub(crate) fn tell(line: impl Display) {
    writeln!(io::stderr(), "{}", printable(&line.to_string())).ok();
}

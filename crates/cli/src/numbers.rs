//! Numbers on the command line.

/// Parses a finite number.
pub fn parse_finite(text: &str) -> Result<f64, String> {
    parse(text, |_| true, "expected a finite number")
}

/// Parses a finite number that is not negative.
pub fn parse_non_negative(text: &str) -> Result<f64, String> {
    parse(text, |x| x >= 0.0, "expected a number, zero or more")
}

/// Parses a finite number above zero.
pub fn parse_positive(text: &str) -> Result<f64, String> {
    parse(text, |x| x > 0.0, "expected a number above zero")
}

/// Parses a relative error.
pub fn parse_relative_error(text: &str) -> Result<f64, String> {
    parse(text, |x| (1e-6..=1.0).contains(&x), "expected a number between 0.000001 and 1")
}

fn parse(text: &str, accepts: fn(f64) -> bool, expected: &str) -> Result<f64, String> {
    text.parse().ok().filter(|x: &f64| x.is_finite() && accepts(*x)).ok_or_else(|| expected.into())
}

//! The values that options take: numbers, colors, and the names of a library's values.

use clap::builder::{PossibleValuesParser, TypedValueParser};

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

/// Parses `R,G,B`, three finite numbers that are not negative.
pub fn parse_rgb(text: &str) -> Result<[f64; 3], String> {
    let expected = "expected R,G,B: three numbers, zero or more";
    let numbers: Vec<f64> =
        text.split(',').map(|n| n.trim().parse()).collect::<Result<_, _>>().map_err(|_| expected)?;
    match numbers[..] {
        [r, g, b] if [r, g, b].iter().all(|x| x.is_finite() && *x >= 0.0) => Ok([r, g, b]),
        _ => Err(expected.into()),
    }
}

/// Parses the name of one of `all` values. Libraries name their values and know nothing of command lines.
pub fn one_of<T: Copy + Send + Sync + 'static>(
    all: &'static [T],
    name: fn(T) -> &'static str,
) -> impl TypedValueParser<Value = T> {
    let names = PossibleValuesParser::new(all.iter().map(|value| name(*value)));
    names.try_map(move |word| all.iter().copied().find(|value| name(*value) == word).ok_or("expected one of the names"))
}

#[cfg(test)]
mod tests {
    use super::parse_rgb;

    #[test]
    fn colors_are_three_numbers() {
        assert_eq!(parse_rgb("1,0.5, 2"), Ok([1.0, 0.5, 2.0]));
        for text in ["1,2", "1,2,3,4", "a,b,c", "-1,0,0", "nan,0,0", "map.exr"] {
            assert!(parse_rgb(text).is_err(), "{text}");
        }
    }
}

//! The values that options take: numbers, colors, and the names of a library's values.

use clap::builder::{PossibleValuesParser, TypedValueParser};
use std::time::Duration;

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

/// Parses a duration: `60s`, `2m`, `1h`, `1.5h`.
pub fn parse_duration(text: &str) -> Result<Duration, String> {
    let units = [('s', 1.0), ('m', 60.0), ('h', 3600.0)];
    let parse = |(unit, seconds): (char, f64)| Some(text.strip_suffix(unit)?.parse::<f64>().ok()? * seconds);
    let seconds = units.into_iter().find_map(parse).filter(|seconds| *seconds > 0.0 && *seconds <= LONGEST_S);
    seconds.map(Duration::from_secs_f64).ok_or_else(|| "expected a duration as 60s, 2m or 1h, of at most 10000h".into())
}

/// The longest duration that is read, s.
const LONGEST_S: f64 = 3.6e7;

#[cfg(test)]
mod tests {
    use super::{parse_duration, parse_rgb};
    use std::time::Duration;

    #[test]
    fn colors_are_three_numbers() {
        assert_eq!(parse_rgb("1,0.5, 2"), Ok([1.0, 0.5, 2.0]));
        for text in ["1,2", "1,2,3,4", "a,b,c", "-1,0,0", "nan,0,0", "map.exr"] {
            assert!(parse_rgb(text).is_err(), "{text}");
        }
    }
    #[test]
    fn durations_have_a_unit() {
        let seconds = |text: &str| parse_duration(text).map(|d| d.as_secs_f64()).ok();
        assert_eq!(parse_duration("60s"), Ok(Duration::from_secs(60)));
        assert_eq!([seconds("2m"), seconds("1h"), seconds("0.5s")], [Some(120.0), Some(3600.0), Some(0.5)]);
        for text in ["60", "s", "-1s", "0s", "nans", "infs", "1e30h", "1d", ""] {
            assert!(parse_duration(text).is_err(), "{text}");
        }
    }
}

//! Counts as people write them, `250k` or `1e6`: parsed, and printed so that they can be parsed again.

/// Suffixes and the powers of ten that they stand for, the largest first.
const SUFFIXES: [(char, u32); 4] = [('T', 12), ('G', 9), ('M', 6), ('k', 3)];

/// Significant digits of a printed count.
const DIGITS: u32 = 3;

/// Significant digits of a printed count that is an estimate.
const FEW_DIGITS: u32 = 2;

/// Parses `250k`, `1M`, `2.3M`, `1e6` or `1000000`, exactly.
pub fn parse_count(text: &str) -> Result<u64, String> {
    exact(text).ok_or_else(|| "expected a whole number such as 250k, 2.3M or 1e6".into())
}

/// The value of a decimal fraction with a suffix, if it is a whole number.
fn exact(text: &str) -> Option<u64> {
    let of = |(letter, power): &(char, u32)| {
        let digits = text.strip_suffix(*letter).or_else(|| text.strip_suffix('K').filter(|_| *letter == 'k'))?;
        Some((digits, i64::from(*power)))
    };
    let (number, power) = SUFFIXES.iter().find_map(of).unwrap_or((text, 0));
    let (decimal, exponent) = match number.split_once(['e', 'E']) {
        Some((decimal, exponent)) => (decimal, i64::from(exponent.parse::<i32>().ok()?)),
        None => (number, 0),
    };
    let decimal = decimal.strip_prefix('+').unwrap_or(decimal);
    let (whole, fraction) = decimal.split_once('.').unwrap_or((decimal, ""));
    let digits = [whole, fraction].concat();
    if digits.is_empty() || !digits.bytes().all(|b| b.is_ascii_digit()) {
        return None;
    }
    let shift = power + exponent - i64::try_from(fraction.len()).ok()?;
    let surplus = usize::try_from(-shift).unwrap_or(0).min(digits.len());
    let (kept, cut) = digits.split_at(digits.len() - surplus);
    if cut.bytes().any(|b| b != b'0') {
        return None;
    }
    let kept = if kept.is_empty() { 0 } else { kept.parse::<u64>().ok()? };
    kept.checked_mul(10u64.checked_pow(u32::try_from(shift.max(0)).ok()?)?)
}

/// Prints a count: `9999`, `16.4k`, `2.35M`, with all digits below ten thousand and three significant ones above.
pub fn count(n: u64) -> String {
    if n < 10_000 && !n.is_multiple_of(1000) { n.to_string() } else { with_suffix(rounded(n, DIGITS, false)) }
}

/// Prints a recommended count with two significant digits, rounded up so that it is not too small.
pub fn count_up(n: f64) -> String {
    with_suffix(rounded(n.ceil() as u64, FEW_DIGITS, true))
}

/// Rounds `n` to a number of significant digits.
fn rounded(n: u64, digits: u32, up: bool) -> u64 {
    let unit = 10u64.pow((n.checked_ilog10().unwrap_or(0) + 1).saturating_sub(digits));
    let half = u64::from(unit > 1 && n % unit >= unit / 2);
    let whole = if up { n.div_ceil(unit) } else { n / unit + half };
    whole.saturating_mul(unit)
}

/// Prints `n` with the largest suffix that does not exceed it, without trailing zeros.
fn with_suffix(n: u64) -> String {
    let Some((letter, power)) = SUFFIXES.iter().find(|(_, power)| n >= 10u64.pow(*power)) else {
        return n.to_string();
    };
    let unit = 10u64.pow(*power);
    let fraction = format!("{:0width$}", n % unit, width = *power as usize);
    match fraction.trim_end_matches('0') {
        "" => format!("{}{letter}", n / unit),
        fraction => format!("{}.{fraction}{letter}", n / unit),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Seen to fail with `2.3M`, which is 2299999.9999999995 in float64.
    #[test]
    fn counts_are_read_as_people_write_them() {
        let exact = [("250k", 250_000), ("1M", 1_000_000), ("1e6", 1_000_000), ("7", 7), ("0.5k", 500), ("1K", 1000)];
        let fractions = [("2.3M", 2_300_000), ("1.001k", 1001), ("0.0000010M", 1), ("1.5e3", 1500), ("15e-1k", 1500)];
        let large = [("9007199254740993", 9_007_199_254_740_993), ("18T", 18_000_000_000_000), ("0e9", 0)];
        for (text, count) in exact.into_iter().chain(fractions).chain(large) {
            assert_eq!(parse_count(text), Ok(count), "{text}");
        }
        for text in ["", "k", ".", "-1", "1.5", "1e99", "nan", "inf", "1Q", "0x10", "1.0001k", "1e-1", "1e99999999999"]
        {
            assert!(parse_count(text).is_err(), "{text}");
        }
    }

    #[test]
    fn counts_are_printed_as_people_write_them() {
        for (n, text) in [
            (0, "0"),
            (999, "999"),
            (1000, "1k"),
            (1234, "1234"),
            (16_384, "16.4k"),
            (99_950, "100k"),
            (1_000_000, "1M"),
            (2_345_678, "2.35M"),
            (1_004_999, "1M"),
            (3_400_000_000, "3.4G"),
            (u64::MAX, "18400000T"),
        ] {
            assert_eq!(count(n), text);
        }
        for (n, text) in
            [(0.2, "1"), (99.5, "100"), (2_300_000.0, "2.3M"), (2_300_001.0, "2.4M"), (991e6, "1G"), (12_345.0, "13k")]
        {
            assert_eq!(count_up(n), text);
        }
    }

    /// A printed count is parsed again to within its digits, and a recommended one to no less than the count.
    #[test]
    fn printed_counts_are_parsed_again() {
        let numbers = (0..20_000).chain((0..60).map(|k| 3u64.pow(40) >> k)).chain([u64::MAX, 10u64.pow(19)]);
        for n in numbers {
            let [near, above] = [count(n), count_up(n as f64)].map(|text| parse_count(&text).expect("a count"));
            assert!(near.abs_diff(n) <= n / 200, "{n}: {near}");
            assert!(n > 1 << 60 || (above >= n && above <= n + n / 9), "{n}: {above}");
        }
    }
}

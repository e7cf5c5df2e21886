//! Counts as people write them.

/// Parses `250k`, `1M`, `1e6` or `1000000`.
pub fn parse_count(text: &str) -> Result<u64, String> {
    let expected = "expected a whole number such as 250k, 1M or 1e6";
    let (digits, factor) = match text.char_indices().last() {
        Some((at, 'k' | 'K')) => (&text[..at], 1e3),
        Some((at, 'M')) => (&text[..at], 1e6),
        Some((at, 'G')) => (&text[..at], 1e9),
        _ => (text, 1.0),
    };
    if factor == 1.0
        && let Ok(count) = text.parse::<u64>()
    {
        return Ok(count);
    }
    let value = digits.parse::<f64>().map_err(|_| expected)? * factor;
    if value >= 0.0 && value < 2f64.powi(53) && value.fract() == 0.0 { Ok(value as u64) } else { Err(expected.into()) }
}

#[cfg(test)]
mod tests {
    use super::parse_count;

    #[test]
    fn counts_are_read_as_people_write_them() {
        for (text, count) in [("250k", 250_000), ("1M", 1_000_000), ("1e6", 1_000_000), ("7", 7), ("0.5k", 500)] {
            assert_eq!(parse_count(text), Ok(count), "{text}");
        }
        for text in ["", "k", "-1", "1.5", "1e99", "nan", "inf", "1Q", "0x10"] {
            assert!(parse_count(text).is_err(), "{text}");
        }
    }
}

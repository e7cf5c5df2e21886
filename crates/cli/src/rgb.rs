//! Colors on the command line.

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

//! Oklab, in which equal steps look equally large: Ottosson, *A perceptual color space for image processing*, 2020.

/// Linear red, green and blue of the lightness L and of the opponent channels a (green to red) and b (blue to yellow).
pub fn to_linear([lightness, a, b]: [f64; 3]) -> [f64; 3] {
    let l = (lightness + 0.396_337_777_4 * a + 0.215_803_757_3 * b).powi(3);
    let m = (lightness - 0.105_561_345_8 * a - 0.063_854_172_8 * b).powi(3);
    let s = (lightness - 0.089_484_177_5 * a - 1.291_485_548_0 * b).powi(3);
    [
        4.076_741_662_1 * l - 3.307_711_591_3 * m + 0.230_969_929_2 * s,
        -1.268_438_004_6 * l + 2.609_757_401_1 * m - 0.341_319_396_5 * s,
        -0.004_196_086_3 * l - 0.703_418_614_7 * m + 1.707_614_701_0 * s,
    ]
}

#[cfg(test)]
mod tests {
    use super::to_linear;

    /// The lightness and the opponent channels of red are those of the CSS Color Module Level 4. Seen to catch: a sign
    /// in a matrix.
    #[test]
    fn white_and_red() {
        for (lab, expected) in [([1.0, 0.0, 0.0], [1.0; 3]), ([0.627_96, 0.224_86, 0.125_85], [1.0, 0.0, 0.0])] {
            let found = to_linear(lab);
            assert!(found.iter().zip(expected).all(|(found, light)| (found - light).abs() < 1e-3), "{found:?}");
        }
    }
}

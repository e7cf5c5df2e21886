//! The transfer functions of sRGB (IEC 61966-2-1): a straight line near black, a power beyond.

/// The largest linear value on the straight line.
pub const LINE_END: f64 = 0.003_130_8;

/// The largest encoded value on the straight line.
const ENCODED_LINE_END: f64 = 0.040_45;

/// Slope of the straight line.
pub const LINE_SLOPE: f64 = 12.92;

/// Beyond the line, an encoded value is `SCALE x^(1/GAMMA) - OFFSET`.
pub const SCALE: f64 = 1.055;
pub const OFFSET: f64 = 0.055;
pub const GAMMA: f64 = 2.4;

/// The encoded value, 0 to 1, of a linear one.
pub fn encode(linear: f64) -> f64 {
    if linear <= LINE_END { LINE_SLOPE * linear } else { SCALE * linear.powf(1.0 / GAMMA) - OFFSET }
}

/// The linear value, 0 to 1, of an encoded one.
pub fn decode(encoded: f64) -> f64 {
    if encoded <= ENCODED_LINE_END { encoded / LINE_SLOPE } else { ((encoded + OFFSET) / SCALE).powf(GAMMA) }
}

/// The code of eight bits of a linear value, which is clamped to 0..1.
pub fn encode_byte(linear: f64) -> u8 {
    (255.0 * encode(linear.clamp(0.0, 1.0))).round() as u8
}

/// The linear value of a code of eight bits.
pub fn decode_byte(code: u8) -> f64 {
    decode(f64::from(code) / 255.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Values of the standard's formula by hand: 0.5 has the code 187.5, and 0.002 · 12.92 · 255 = 6.6.
    ///
    /// Seen to fail: 2.2 instead of 2.4.
    #[test]
    fn known_values() {
        assert_eq!([0.0, 1.0, 0.5, 0.002, -1.0, 9.0].map(encode_byte), [0, 255, 188, 7, 0, 255]);
        let known = [(0, 0.0), (1, 0.000303527), (10, 0.003035270), (127, 0.212230757), (188, 0.502886458)];
        for (code, linear) in known {
            assert!((decode_byte(code) - linear).abs() < 1e-9, "{code}: {}", decode_byte(code));
        }
        assert_eq!(decode_byte(255), 1.0);
    }

    #[test]
    fn each_code_decodes_to_light_that_encodes_to_it() {
        assert!((0..=255).all(|code| encode_byte(decode_byte(code)) == code));
    }
}

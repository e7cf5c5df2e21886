//! The exponential in float32: no library call, so that it vectorises and is the same everywhere.

/// Adding this rounds a float32 below 2²² to an integer, whose bits are then the low ones of the sum.
const ROUND: f32 = 12_582_912.0;

/// Below this the result is taken as zero: it would be subnormal.
const UNDERFLOW: f32 = -87.0;

/// `eˣ` for `x ≤ 1`, within 2 units in the last place; 0 below −87.
#[inline(always)]
pub fn exp_negative(x: f32) -> f32 {
    let clamped = if x > UNDERFLOW { x } else { UNDERFLOW };
    let shifted = clamped * std::f32::consts::LOG2_E + ROUND;
    let n = shifted - ROUND;
    // ln 2 in two parts: the first has few digits, so that n times it is exact.
    let f = (clamped - n * 0.693_359_4) + n * 2.121_944_4e-4;
    // Minimax polynomial of (eᶠ − 1 − f)/f² on |f| ≤ ½ ln 2, as in Cephes' expf (Moshier).
    let p = 1.987_569_1e-4f32;
    let p = p * f + 1.398_199_9e-3;
    let p = p * f + 8.333_452e-3;
    let p = p * f + 4.166_579_6e-2;
    let p = p * f + 1.666_666_5e-1;
    let p = p * f + 0.5;
    let mantissa = (p * f * f + f) + 1.0;
    let exponent = shifted.to_bits().wrapping_sub(ROUND.to_bits()).wrapping_add(127) << 23;
    let value = mantissa * f32::from_bits(exponent);
    if x > UNDERFLOW { value } else { 0.0 }
}

/// `e^{−x}` and `1 − e^{−x}` for `x ≥ −1`, each without cancellation.
#[inline(always)]
pub(super) fn decay(x: f32) -> (f32, f32) {
    // Taylor series up to x⁷; the remainder is below 10⁻⁸ of the result for |x| < ½.
    let s = 1.0 / 5040.0;
    let s = s * -x + 1.0 / 720.0;
    let s = s * -x + 1.0 / 120.0;
    let s = s * -x + 1.0 / 24.0;
    let s = s * -x + 1.0 / 6.0;
    let s = s * -x + 0.5;
    let series = x * (s * -x + 1.0);
    let rest = exp_negative(-x);
    (rest, if x.abs() < 0.5 { series } else { 1.0 - rest })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn close_to_the_library() {
        for k in 0..2_000_000 {
            let x = -87.0 * (k as f32 / 2_000_000.0);
            let exact = f64::from(x).exp();
            assert!((f64::from(exp_negative(x)) / exact - 1.0).abs() < 2.5e-7, "{x}");
            let exact = -(-f64::from(-x)).exp_m1();
            let error = f64::from(decay(-x).1) / exact - 1.0;
            assert!(x == 0.0 || error.abs() < 3e-7, "{x} {error}");
        }
    }

    #[test]
    fn ends_are_right() {
        assert_eq!(exp_negative(0.0), 1.0);
        assert_eq!(exp_negative(-1000.0), 0.0);
        assert_eq!(exp_negative(f32::NEG_INFINITY), 0.0);
        assert!((exp_negative(1.0) - std::f32::consts::E).abs() < 1e-6);
        assert_eq!(decay(0.0), (1.0, 0.0));
    }
}

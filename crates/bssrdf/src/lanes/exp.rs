//! The exponential in float32, without a library call, so that it vectorizes and has the same bits everywhere.

use std::f32::consts::LOG2_E;

/// Adding this rounds a float32 below 2²² to an integer, whose bits are the low ones of the sum. They include the bias
/// of the exponent, 127, so that a shift to the left makes a power of two.
const ROUND: f32 = 12_582_912.0 + 127.0;

/// At this exponent the power of two, and with it the result, becomes 0 instead of subnormal.
const UNDERFLOW: f32 = -127.0;

/// `eˣ` for `x ≤ 1`, within 2 units in the last place; 0 below −87.7, subnormal in the last third before.
#[inline(always)]
pub fn exp_negative(x: f32) -> f32 {
    let clamped = if x > UNDERFLOW / LOG2_E { x } else { UNDERFLOW / LOG2_E };
    let shifted = clamped * LOG2_E + ROUND;
    let n = shifted - ROUND;
    // ln 2 in two parts: the first has few digits, so that n times it is exact.
    let f = (clamped - n * 0.693_359_4) + n * 2.121_944_4e-4;
    let power = power_of_two(shifted);
    power + power * power_less_one(f * LOG2_E)
}

/// `2ˣ` for `x ≤ 100`; 0 below −126.5. It is cheaper than `eˣ`, and as exact where `x` itself is rounded.
#[inline(always)]
pub(crate) fn exp2_negative(x: f32) -> f32 {
    let (power, less_one) = split(x);
    power + power * less_one
}

/// `log₂ x` for `x` between 10⁻³ and 10³, within 3·10⁻⁷ of it or, near 1, of `x − 1`.
#[inline(always)]
pub(crate) fn log2_near_one(x: f32) -> f32 {
    // The exponent of the power of two next to x, so that the mantissa lies between √½ and √2.
    let shifted = x.to_bits().wrapping_sub(0x3F35_04F3);
    let exponent = shifted as i32 >> 23;
    let f = f32::from_bits((shifted & 0x007F_FFFF) + 0x3F35_04F3) - 1.0;
    // ln(1 + f) = 2 artanh s
    let s = f / (2.0 + f);
    let squared = s * s;
    let series = 1.0 + squared * (0.333_333_34 + squared * (0.2 + squared * (0.142_857_15 + squared * 0.111_111_11)));
    exponent as f32 + (2.0 * LOG2_E) * s * series
}

/// `2ˣ` and `1 − 2ˣ` for `x ≤ 2`, each without cancellation.
#[inline(always)]
pub(crate) fn decay2(x: f32) -> (f32, f32) {
    let (power, less_one) = split(x);
    let rest = power * less_one;
    (power + rest, (1.0 - power) - rest)
}

/// `2ⁿ` and `2ᶠ − 1` with `x = n + f`.
#[inline(always)]
fn split(x: f32) -> (f32, f32) {
    let clamped = if x > UNDERFLOW { x } else { UNDERFLOW };
    let shifted = clamped + ROUND;
    (power_of_two(shifted), power_less_one(clamped - (shifted - ROUND)))
}

/// `2ⁿ` of `n + ROUND`.
#[inline(always)]
fn power_of_two(shifted: f32) -> f32 {
    f32::from_bits(shifted.to_bits() << 23)
}

/// `2ᶠ − 1` for `|f| ≤ ½`: minimax of its relative error, 1.2·10⁻⁸.
#[inline(always)]
fn power_less_one(f: f32) -> f32 {
    // In pairs, so that few operations wait for one another.
    let squared = f * f;
    let low = 2.402_265e-1 * f + 6.931_472e-1;
    let middle = 9.618_238e-3 * f + 5.550_357_4e-2;
    let high = 1.540_351_8e-4 * f + 1.339_073_5e-3;
    ((high * squared + middle) * squared + low) * f
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
            let x = x * 1.4;
            let exact = f64::from(x).exp2();
            assert!((f64::from(exp2_negative(x)) / exact - 1.0).abs() < 2.5e-7, "{x}");
            let exact = -(f64::from(x) * std::f64::consts::LN_2).exp_m1();
            let (decay, one_minus_decay) = decay2(x);
            assert_eq!(decay, exp2_negative(x));
            let error = f64::from(one_minus_decay) / exact - 1.0;
            assert!(x == 0.0 || error.abs() < 3e-7, "{x} {error}");
        }
    }

    #[test]
    fn ends_are_right() {
        assert_eq!(exp_negative(0.0), 1.0);
        assert_eq!(exp_negative(-1000.0), 0.0);
        assert_eq!(exp_negative(f32::NEG_INFINITY), 0.0);
        assert!((exp_negative(1.0) - std::f32::consts::E).abs() < 1e-6);
        assert_eq!(exp2_negative(-1000.0), 0.0);
        assert_eq!(exp2_negative(f32::NEG_INFINITY), 0.0);
        assert_eq!([1.0, 0.0, -1.0, -126.0].map(exp2_negative), [2.0, 1.0, 0.5, f32::MIN_POSITIVE]);
        assert_eq!(decay2(0.0), (1.0, 0.0));
        assert_eq!(decay2(1.0), (2.0, -1.0));
        assert_eq!(decay2(f32::NEG_INFINITY), (0.0, 1.0));
    }
}

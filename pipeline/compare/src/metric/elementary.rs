//! Logarithm, exponential and power in float32, accurate to a few units in the last place.
//!
//! They have no calls and no branches, so that loops over them become vector instructions, with the same bits on every
//! processor.

/// 1.5 * 2^23: the sum of a float32 and this has no fraction, and its lowest bits are the rounded number.
const ROUND: f32 = 12_582_912.0;

/// The logarithm of a positive normal number. That of zero is about -127, so that its powers are negligible.
#[inline(always)]
pub(super) fn log2(x: f32) -> f32 {
    // x = 2^exponent * mantissa with the mantissa in [1/sqrt 2, sqrt 2).
    let offset = x.to_bits().wrapping_sub(std::f32::consts::FRAC_1_SQRT_2.to_bits());
    let exponent = (offset as i32) >> 23;
    let mantissa = f32::from_bits(x.to_bits().wrapping_sub((exponent as u32) << 23));
    // ln m = 2 artanh((m - 1) / (m + 1)) by a series whose next term is below 1e-9.
    let s = (mantissa - 1.0) / (mantissa + 1.0);
    let s2 = s * s;
    let series = 1.0 + s2 * (1.0 / 3.0 + s2 * (1.0 / 5.0 + s2 * (1.0 / 7.0 + s2 * (1.0 / 9.0))));
    exponent as f32 + s * series * (2.0 * std::f32::consts::LOG2_E)
}

/// 2^x for x from -126 to 127.
#[inline(always)]
pub(super) fn exp2(x: f32) -> f32 {
    let rounded = x + ROUND;
    let y = (x - (rounded - ROUND)) * std::f32::consts::LN_2;
    // The next term of this Taylor series of e^y is below 1e-8 for |y| < 0.35.
    let series = 1.0 / 24.0 + y * (1.0 / 120.0 + y * (1.0 / 720.0 + y * (1.0 / 5040.0)));
    let power = 1.0 + y * (1.0 + y * (0.5 + y * (1.0 / 6.0 + y * series)));
    power * f32::from_bits((rounded.to_bits() << 23).wrapping_add(1.0f32.to_bits()))
}

/// x^p for x of at least 0. Zero to a negative power is large but finite.
#[inline(always)]
pub(super) fn power(x: f32, p: f32) -> f32 {
    exp2(p * log2(x))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn against_the_standard_library() {
        for i in 1..4000 {
            let x = i as f32 * i as f32 * 1e-5;
            let exact = f64::from(x).log2();
            // The tolerance is the rounding of a result of up to 8.
            assert!((f64::from(log2(x)) - exact).abs() < 5e-7, "log2 {x}");
            for p in [1.0 / 3.0, 1.0 / 2.4, 0.7, -0.3] {
                let (found, exact) = (f64::from(power(x, p)), f64::from(x).powf(f64::from(p)));
                assert!((found / exact - 1.0).abs() < 1e-6, "{x}^{p} is {exact}, not {found}");
            }
        }
        assert_eq!([exp2(-126.0), exp2(0.0), exp2(1.0), exp2(127.0)], [f32::MIN_POSITIVE, 1.0, 2.0, 2f32.powi(127)]);
    }

    #[test]
    fn powers_of_zero_are_negligible() {
        assert!(power(0.0, 0.7) < 1e-20);
        assert_eq!(0.0 * power(0.0, -1.0), 0.0);
    }
}

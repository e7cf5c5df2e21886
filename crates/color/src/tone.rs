//! Tone curves: bright light compressed into what a screen can show.

/// The coefficients `a` to `e` of [`aces`].
pub const ACES: [f64; 5] = [2.51, 0.03, 2.43, 0.59, 0.14];

/// `x (a x + b) / (x (c x + d) + e)`, at most 1: Krzysztof Narkowicz' fit of the ACES output transform ("ACES Filmic
/// Tone Mapping Curve", 2016), with a toe, a straight part and a shoulder. Applied to each channel, it takes what is
/// far too bright to white.
pub fn aces(linear: f64) -> f64 {
    let [a, b, c, d, e] = ACES;
    // The curve exceeds 1 beyond 7.25; the squares of huge numbers could overflow.
    let x = linear.clamp(0.0, 100.0);
    (x * (a * x + b) / (x * (c * x + d) + e)).min(1.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// 0.6 (2.51 · 0.6 + 0.03) / (0.6 (2.43 · 0.6 + 0.59) + 0.14) = 0.9216 / 1.3688.
    #[test]
    fn known_values() {
        assert_eq!([-1.0, 0.0, 8.0, f64::MAX].map(aces), [0.0, 0.0, 1.0, 1.0]);
        assert!((aces(0.6) - 0.9216 / 1.3688).abs() < 1e-15);
    }

    #[test]
    fn the_curve_rises_and_its_shoulder_flattens() {
        let curve: Vec<f64> = (0..70).map(|k| aces(0.1 * f64::from(k))).collect();
        assert!(curve.windows(2).all(|w| w[0] < w[1]), "{curve:?}");
        // Two stops above 0.65, where the shoulder begins, are worth less than half of one.
        assert!(aces(2.6) < 1.4 * aces(0.65));
    }
}

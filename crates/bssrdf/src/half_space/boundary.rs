//! Moments of the transmittance of a smooth boundary, by quadrature.

use bsdf::fresnel::transmittance;
use std::f64::consts::PI;

/// Steps of the integrals: they are then good for eight digits.
const STEPS: usize = 64;

/// `μ_c`: below this cosine light that hits the boundary from inside is totally reflected; 0 if `eta ≤ 1`.
pub fn critical_cosine(eta: f64) -> f64 {
    if eta > 1.0 { ((eta - 1.0) * (eta + 1.0)).sqrt() / eta } else { 0.0 }
}

/// `∫ T f(μ, ν) μ dμ` over the cosines `μ` outside, to which the cosines `ν` inside belong.
fn integral(eta: f64, f: impl Fn(f64, f64) -> f64) -> f64 {
    // The rarer side is integrated over: there the cosines run from 0 to 1, and T has no root at an end.
    let rarer = eta.max(1.0 / eta);
    let at = |k: usize| {
        // A smooth step, whose derivatives vanish at the ends: the rule of the middles is then of high order.
        let t = (k as f64 + 0.5) / STEPS as f64;
        let rare = t * t * t * (10.0 - t * (15.0 - 6.0 * t));
        let slope = 30.0 * t * t * (1.0 - t) * (1.0 - t);
        let dense = (1.0 - (1.0 - rare * rare) / (rarer * rarer)).sqrt();
        let (outside, inside) = if eta >= 1.0 { (rare, dense) } else { (dense, rare) };
        transmittance(rare, rarer) * f(outside, inside) * rare * slope
    };
    // μ dμ = η² ν dν
    let measure = if eta >= 1.0 { 1.0 } else { eta * eta };
    measure * (0..STEPS).map(at).sum::<f64>() / STEPS as f64
}

/// `m_k = ∫ T21 μ^{k+1} dω` outside (docs/method.md 15.8).
pub fn exit_moment(k: i32, eta: f64) -> f64 {
    2.0 * PI * integral(eta, |outside, _| outside.powi(k))
}

/// `a` and `b` of the exit lobe `T21 (a + b μ)` that carries the power of `T21` alone and has the mean cosine
/// `mean_cosine` outside (docs/method.md 15.8).
pub fn exit_lobe(eta: f64, mean_cosine: f64) -> [f64; 2] {
    let moments = [0, 1, 2].map(|k| exit_moment(k, eta));
    lobe_of(moments, moments[0], mean_cosine)
}

/// The same with these moments of `T21`, for this power.
pub fn lobe_of([m0, m1, m2]: [f64; 3], power: f64, mean_cosine: f64) -> [f64; 2] {
    let slope = power * (m0 * mean_cosine - m1) / (m0 * m2 - m1 * m1);
    [power / m0 - slope * m1 / m0, slope]
}

/// `A = (1 + 3C₂)/(1 − 2C₁)` from the definitions of the moments instead of their fits (docs/method.md 2.7, 15.2).
pub fn reflection(eta: f64) -> f64 {
    let inside = |k: i32| integral(eta, |_, inside| inside.powi(k)) / (eta * eta); // ∫ T ν^{k+1} dν
    (2.0 - 3.0 * inside(1)) / (2.0 * inside(0))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Interface;

    /// `∫ T21 μ dω = 4π C_φ(1/η)`, of which the published fit is good for three digits; and the sum of many steps.
    #[test]
    fn moments_are_integrals() {
        for eta in [0.41, 0.8, 0.999, 1.0, 1.001, 1.3, 1.5, 2.5] {
            let fit = Interface::new(eta);
            assert!((exit_moment(0, eta) / (PI * fit.exit_norm) - 1.0).abs() < 5e-3, "{eta}");
            assert!((reflection(eta) / fit.reflection - 1.0).abs() < 0.02, "{eta}: {}", reflection(eta));
            for k in 0..3 {
                let steps = 1_000_000;
                let at = |i: i32| {
                    let cosine = (f64::from(i) + 0.5) / f64::from(steps);
                    2.0 * PI * transmittance(cosine, eta) * cosine.powi(k + 1) / f64::from(steps)
                };
                let sum: f64 = (0..steps).map(at).sum();
                assert!((exit_moment(k, eta) / sum - 1.0).abs() < 2e-6, "{eta} {k}");
            }
        }
        assert!((reflection(1.0) - 1.0).abs() < 1e-6 && (exit_moment(1, 1.0) - 2.0 * PI / 3.0).abs() < 1e-6);
    }

    /// Seen to catch: the two coefficients exchanged.
    #[test]
    fn the_lobe_keeps_power_and_has_the_mean_cosine() {
        for eta in [0.7, 1.0, 1.3, 1.5, 2.5] {
            let [m0, m1, m2] = [0, 1, 2].map(|k| exit_moment(k, eta));
            for mean in [0.55, m1 / m0, 0.75] {
                let [a, b] = exit_lobe(eta, mean);
                assert!(((a * m0 + b * m1) / m0 - 1.0).abs() < 1e-12);
                assert!(((a * m1 + b * m2) / m0 / mean - 1.0).abs() < 1e-12);
            }
            let [a, b] = exit_lobe(eta, m1 / m0);
            assert!((a - 1.0).abs() < 1e-12 && b.abs() < 1e-12);
        }
    }
}

//! Integrals of known accuracy: composite Gauss-Legendre, with graded panels where functions span many scales.

use bssrdf::{Bssrdf, Separation};
use glam::DVec3;
use std::f64::consts::PI;

/// Number of points in a panel.
const ORDER: usize = 12;

/// Nodes and weights on [−1, 1]: Newton's method on the Legendre polynomial.
fn rule() -> [(f64, f64); ORDER] {
    let n = ORDER as f64;
    std::array::from_fn(|k| {
        let mut x = (PI * (k as f64 + 0.75) / (n + 0.5)).cos();
        let mut derivative = 1.0;
        for _ in 0..8 {
            let (mut p, mut before) = (1.0, 0.0);
            for j in 0..ORDER {
                let j = j as f64;
                (p, before) = (((2.0 * j + 1.0) * x * p - j * before) / (j + 1.0), p);
            }
            derivative = n * (x * p - before) / (x * x - 1.0);
            x -= p / derivative;
        }
        (x, 2.0 / ((1.0 - x * x) * derivative * derivative))
    })
}

/// `∫ f` over [low, high] by panels of equal width.
pub fn integrate(low: f64, high: f64, panels: usize, f: impl Fn(f64) -> f64) -> f64 {
    let rule = rule();
    let half = 0.5 * (high - low) / panels as f64;
    let panel = |k: usize| {
        let middle = low + (2 * k + 1) as f64 * half;
        rule.iter().map(|(x, w)| w * f(middle + half * x)).sum::<f64>() * half
    };
    (0..panels).map(panel).sum()
}

/// `∫ f` over [low, high] in the logarithm of the variable, for functions that span many scales.
pub fn integrate_graded(low: f64, high: f64, panels: usize, f: impl Fn(f64) -> f64) -> f64 {
    integrate(low.ln(), high.ln(), panels, |u| u.exp() * f(u.exp()))
}

/// The annulus over which a plane integral is evaluated.
#[derive(Clone, Copy, Debug)]
pub struct Annulus {
    /// The integrand is taken as constant within this radius, m.
    pub inner: f64,
    /// The integrand is taken as zero beyond this radius, m.
    pub outer: f64,
}

/// `∫ S_bare dA` of one channel over a plane, for light refracted to the polar angle of `sine`; in polar coordinates
/// about the exitant point, graded in the radius, evenly spaced in the (periodic) angle.
pub fn plane_integral(model: &dyn Bssrdf, channel: usize, sine: f64, annulus: Annulus) -> f64 {
    const ANGLES: usize = 128;
    let refracted = DVec3::new(sine, 0.0, -(1.0 - sine * sine).sqrt());
    let ring = |radius: f64| {
        let at = |k: usize| {
            let (s, c) = (PI * (k as f64 + 0.5) / ANGLES as f64).sin_cos();
            let offset = DVec3::new(c, s, 0.0) * radius;
            model.bare(channel, &Separation { offset, normal_in: DVec3::Z, refracted, normal_out: DVec3::Z })
        };
        2.0 * PI * radius * (0..ANGLES).map(at).sum::<f64>() / ANGLES as f64
    };
    integrate_graded(annulus.inner, annulus.outer, 40, ring)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn known_integrals() {
        assert!((integrate(0.0, PI, 2, f64::sin) - 2.0).abs() < 1e-13);
        assert!((integrate_graded(1e-6, 60.0, 20, |x| (-x).exp()) - (-1e-6f64).exp()).abs() < 1e-10);
        let weights: f64 = rule().iter().map(|(_, w)| w).sum();
        assert!((weights - 2.0).abs() < 1e-14);
    }
}

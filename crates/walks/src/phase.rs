//! The phase function of Henyey and Greenstein 1941.

use crate::random::Sequence;
use glam::DVec3;
use std::f64::consts::{PI, TAU};

/// Below this, the phase function is taken as constant: the inversion of its distribution divides by `g`.
const ISOTROPIC: f64 = 1e-6;

/// A direction after scattering, by the inverse of the distribution of the cosine (docs/method.md 14.3).
#[inline(always)]
pub fn scatter(direction: DVec3, g: f64, random: &mut Sequence) -> DVec3 {
    if g.abs() < ISOTROPIC {
        return random.direction();
    }
    let cosine = cosine(g, random.uniform());
    turned(direction, cosine, random.angle())
}

/// The same by given numbers in [0, 1).
pub fn scatter_by(direction: DVec3, g: f64, [xi, angle]: [f64; 2]) -> DVec3 {
    let cosine = if g.abs() < ISOTROPIC { 1.0 - 2.0 * xi } else { cosine(g, xi) };
    let (sine, cosine_of_angle) = (TAU * angle).sin_cos();
    turned(direction, cosine, (cosine_of_angle, sine))
}

#[inline(always)]
fn cosine(g: f64, xi: f64) -> f64 {
    let s = (1.0 - g * g) / (1.0 - g + 2.0 * g * xi);
    ((1.0 + g * g - s * s) / (2.0 * g)).clamp(-1.0, 1.0)
}

/// A direction at this cosine from another, and at an angle about it that is given by its cosine and sine.
#[inline(always)]
fn turned(direction: DVec3, cosine: f64, (a, b): (f64, f64)) -> DVec3 {
    let sine = ((1.0 - cosine) * (1.0 + cosine)).sqrt();
    let (x, y) = direction.any_orthonormal_pair();
    (x * (sine * a) + y * (sine * b) + direction * cosine).normalize()
}

/// The density of that direction, 1/sr (docs/method.md 14.2).
#[inline(always)]
pub fn density(cosine: f64, g: f64) -> f64 {
    let q = 1.0 + g * g - 2.0 * g * cosine;
    (1.0 - g) * (1.0 + g) / (4.0 * PI * q * q.sqrt())
}

#[cfg(test)]
mod tests {
    use super::*;
    use scene::random::{Purpose, Stream};

    /// The mean cosine is `g`, and its second moment `(1 + 2g²)/3`; four standard deviations of 10⁵ directions.
    ///
    /// Seen to catch: the sign of `g`.
    #[test]
    fn moments_of_the_cosine() {
        for (k, g) in [-0.6, 0.0, 0.3, 0.9].into_iter().enumerate() {
            let mut random = Sequence::new(Stream::new(1, Purpose::LightWalk).item(k as u64));
            let axis = random.direction();
            let cosines: Vec<f64> = (0..100_000).map(|_| scatter(axis, g, &mut random).dot(axis)).collect();
            let mean = |power: i32| cosines.iter().map(|c| c.powi(power)).sum::<f64>() / cosines.len() as f64;
            assert!((mean(1) - g).abs() < 4.0 * 0.6 / 316.0, "{g}: {}", mean(1));
            assert!((mean(2) - (1.0 + 2.0 * g * g) / 3.0).abs() < 4.0 * 0.4 / 316.0, "{g}: {}", mean(2));
        }
    }

    #[test]
    fn the_density_integrates_to_one() {
        for g in [-0.6, 0.0, 0.9] {
            let steps = 20_000;
            let cosine = |k: usize| (2.0 * k as f64 + 1.0) / steps as f64 - 1.0;
            let integral: f64 = (0..steps).map(|k| density(cosine(k), g) * 4.0 * PI / steps as f64).sum();
            assert!((integral - 1.0).abs() < 1e-4, "{g}: {integral}");
        }
    }
}

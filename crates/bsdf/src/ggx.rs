//! The GGX distribution of microfacets with Smith's height-correlated shadowing, isotropic (docs/method.md 18.1).
//!
//! Directions are in the frame of the surface: `z` is along its normal.

use glam::DVec3;
use std::f64::consts::{PI, TAU};

/// Surfaces of a smaller `α` are smooth. Their highlights are 0.02 degrees wide.
pub const SMOOTH_BELOW: f64 = 1e-4;

/// Microfacets of the slope scale `α`, the square of the roughness that an artist states.
#[derive(Clone, Copy, Debug)]
pub struct Ggx {
    alpha: f64,
}

impl Ggx {
    pub fn new(alpha: f64) -> Ggx {
        Ggx { alpha }
    }

    /// `D(h)`, 1/sr, of a microfacet normal whose cosine is `cosine`: `∫ D cos θ dω = 1`.
    pub fn distribution(&self, cosine: f64) -> f64 {
        let squared = self.alpha * self.alpha;
        // The sine keeps its digits where the distribution is narrow and high.
        let root = (1.0 - cosine) * (1.0 + cosine) + squared * cosine * cosine;
        squared / (PI * root * root)
    }

    /// Smith's `Λ` of a direction by its cosine, which is above 0.
    pub fn lambda(&self, cosine: f64) -> f64 {
        let tangent_squared = (1.0 - cosine * cosine).max(0.0) / (cosine * cosine);
        let x = self.alpha * self.alpha * tangent_squared;
        // (√(1 + x) − 1)/2 without its cancellation.
        0.5 * x / (1.0 + (1.0 + x).sqrt())
    }

    /// The share of the microfacets seen from a direction that are not hidden.
    pub fn masking(&self, cosine: f64) -> f64 {
        1.0 / (1.0 + self.lambda(cosine))
    }

    /// The height-correlated share of microfacets that two directions on the same side both see (Heitz 2014).
    pub fn shadowing(&self, cosines: [f64; 2]) -> f64 {
        1.0 / (1.0 + self.lambda(cosines[0]) + self.lambda(cosines[1]))
    }

    /// A microfacet normal in proportion to the area that is seen of it from `view` (Heitz 2018).
    pub fn sample_visible(&self, view: DVec3, xi: [f64; 2]) -> DVec3 {
        let alpha = self.alpha;
        let stretched = DVec3::new(alpha * view.x, alpha * view.y, view.z).normalize();
        let across = stretched.x * stretched.x + stretched.y * stretched.y;
        let first = if across > 0.0 { DVec3::new(-stretched.y, stretched.x, 0.0) / across.sqrt() } else { DVec3::X };
        let second = stretched.cross(first);
        let radius = xi[0].sqrt();
        let (sine, cosine) = (TAU * xi[1]).sin_cos();
        let (a, b) = (radius * cosine, radius * sine);
        let share = 0.5 * (1.0 + stretched.z);
        let b = (1.0 - share) * (1.0 - a * a).max(0.0).sqrt() + share * b;
        let c = (1.0 - a * a - b * b).max(0.0).sqrt();
        let normal = a * first + b * second + c * stretched;
        DVec3::new(alpha * normal.x, alpha * normal.y, normal.z.max(1e-12)).normalize()
    }
}

/// Points of a lattice that are spread evenly over the unit square; the means below are over it.
const LATTICE: usize = 987;
const LATTICE_STEP: usize = 610;

/// The mean over the microfacets that are seen from `view`, each with its visible area.
pub(crate) fn mean_over_visible<const N: usize>(ggx: &Ggx, view: DVec3, value: impl Fn(DVec3) -> [f64; N]) -> [f64; N] {
    let mut sum = [0.0; N];
    for k in 0..LATTICE {
        let xi = [k, k * LATTICE_STEP % LATTICE].map(|k| (k as f64 + 0.5) / LATTICE as f64);
        let normal = ggx.sample_visible(view, xi);
        sum.iter_mut().zip(value(normal)).for_each(|(sum, x)| *sum += x);
    }
    sum.map(|x| x / LATTICE as f64)
}

/// A direction in the frame of the surface at this cosine.
pub(crate) fn at_cosine(cosine: f64) -> DVec3 {
    DVec3::new((1.0 - cosine * cosine).max(0.0).sqrt(), 0.0, cosine)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The distribution is that of a height field: its facets' projected areas add up to the surface, and those that a
    /// viewer sees, by the share that is not hidden, to the surface's projection. Seen to catch: `D` with `α` for `α²`, `Λ` without its half.
    #[test]
    fn projected_areas_add_up() {
        for alpha in [0.05, 0.3, 1.0] {
            let ggx = Ggx::new(alpha);
            let view = at_cosine(0.3);
            let (n, mut all, mut seen) = (1500, 0.0, 0.0);
            for i in 0..n {
                // Uniform in the tangent of the angle's half keeps small angles apart.
                let t = (f64::from(i) + 0.5) / f64::from(n);
                let (theta, width) = (0.5 * PI * t * t, PI * t / f64::from(n));
                for j in 0..64 {
                    let phi = TAU * (f64::from(j) + 0.5) / 64.0;
                    let normal = DVec3::new(theta.sin() * phi.cos(), theta.sin() * phi.sin(), theta.cos());
                    let solid = theta.sin() * width * TAU / 64.0;
                    all += ggx.distribution(normal.z) * normal.z * solid;
                    seen += ggx.distribution(normal.z) * normal.dot(view).max(0.0) * solid;
                }
            }
            assert!((all - 1.0).abs() < 1e-3, "alpha {alpha}: {all}");
            let seen = seen * ggx.masking(view.z) / view.z;
            assert!((seen - 1.0).abs() < 1e-3, "alpha {alpha}: {seen}");
        }
    }
}

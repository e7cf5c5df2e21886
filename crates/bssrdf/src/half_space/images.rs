//! The diffuse light of a beam that enters a half-space: a source below the surface and its image above.
//!
//! Lengths are reduced mean free paths, `1/σ_t'`.

use super::boundary::reflection;
use std::f64::consts::PI;

/// The squared radius within which the source does not become brighter: a beam has an extent.
pub const SOFTNESS2: f64 = 0.25;

/// The constants of the two sources for one medium and channel (docs/method.md 15.1, 15.2).
#[derive(Clone, Copy, Debug)]
pub struct Images {
    /// `κ`, which the light falls with far away.
    pub transport: f64,
    /// `z_b`: so far above the surface the fluence vanishes.
    pub extrapolation: f64,
    /// `1/(8πAD)`.
    pub strength: f64,
}

impl Images {
    /// The images for an absorbed share `1 − α'` of each collision.
    pub fn new(absorbed: f64, eta: f64) -> Images {
        let transport = transport(absorbed);
        let diffusion = if transport > 1e-6 { absorbed / (transport * transport) } else { 1.0 / 3.0 };
        let reflection = reflection(eta);
        Images {
            transport,
            extrapolation: 2.0 * reflection * diffusion,
            strength: 1.0 / (8.0 * PI * reflection * diffusion),
        }
    }

    /// The exitance over `α'` (docs/method.md 15.3, 15.4) at the squared distance `r2`, of which `along = x_t·ω12` along
    /// the surface and `depth` below it; `cosine` is `μ12`.
    pub fn exitance(&self, r2: f64, along: f64, depth: f64, cosine: f64) -> f64 {
        let depth = saturated(depth);
        let real2 = r2 + 1.0 - 2.0 * (along + depth * cosine) + SOFTNESS2;
        let delta2 = 4.0 * (depth + self.extrapolation) * (cosine + self.extrapolation);
        let (real, mirrored) = (real2.sqrt(), (real2 + delta2).sqrt());
        let delta = delta2 / (real + mirrored);
        let q = self.transport * delta;
        // e^{−κ d_r}/d_r − e^{−κ d_v}/d_v without cancellation
        self.strength * (-self.transport * real).exp() * (delta / real - (-q).exp_m1()) / mirrored
    }
}

/// `z̃ = z/(1 + z)`: the depth below the tangent plane counts in full near it, as at a crease, and as one mean free path
/// far from it, because there the surface ends the object.
fn saturated(depth: f64) -> f64 {
    depth / (1.0 + depth)
}

/// `−log₂(1.01 − w)`, by powers of which the light is stronger in the direction of the beam, `w` being the cosine to it
/// (docs/method.md 15.5). Light of one scattering that is not absorbed falls as `1/(1 − w)`.
pub fn forwardness(w: f64) -> f64 {
    -(GRAZING - w).log2()
}

/// Keeps light that grazes along the surface finite: `w ≤ 1`.
pub const GRAZING: f64 = 1.01;

/// `κ` with `α' artanh(κ)/κ = 1` (docs/method.md 15.1), for the absorbed share `1 − α'`.
pub fn transport(absorbed: f64) -> f64 {
    if absorbed < 1e-6 {
        return (3.0 * absorbed.max(0.0)).sqrt() * (1.0 - 0.4 * absorbed);
    }
    // artanh(κ)/κ − 1
    let excess = |k: f64| {
        let k2 = k * k;
        if k < 0.3 {
            (1..16).rev().fold(0.0, |sum, j| k2 * (1.0 / f64::from(2 * j + 1) + sum))
        } else {
            k.atanh() / k - 1.0
        }
    };
    let (mut low, mut high) = (0.0, 1.0);
    for _ in 0..80 {
        let middle = 0.5 * (low + high);
        if (1.0 - absorbed) * excess(middle) > absorbed { high = middle } else { low = middle }
    }
    0.5 * (low + high)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_far_field_is_that_of_transport() {
        for absorbed in [1e-12, 1e-7, 9.9e-7, 1.1e-6, 1e-4, 0.01, 0.0294, 0.0295, 0.1, 0.5] {
            let k = transport(absorbed);
            // κ² = 3a(1 − 4a/5 + ...) for small a; the definition elsewhere.
            let error = if absorbed < 1e-3 {
                k / (3.0 * absorbed * (1.0 - 0.8 * absorbed)).sqrt() - 1.0
            } else {
                (1.0 - absorbed) * k.atanh() / k - 1.0
            };
            assert!(error.abs() < 1e-6, "{absorbed}: {k} {error}");
        }
        assert_eq!(transport(0.0), 0.0);
        assert!((transport(1.0) - 1.0).abs() < 1e-15);
    }
}

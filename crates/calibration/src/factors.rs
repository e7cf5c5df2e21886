//! The factors of one material as images use them.

use crate::patches::{Patches, Site};
use bssrdf::Coefficients;
use formats::calibration::CalibratedMaterial;
use glam::{DVec3, Vec3};

/// The factor between the model's light and the true light, at any point of a surface and for any angle of view.
#[derive(Clone, Debug)]
pub struct Factors {
    patches: Patches,
    /// For each patch, the natural logarithm of the factor of each channel.
    log_factors: Vec<[f32; 3]>,
    /// For each patch, the gradient of the logarithm of the light of each channel, 1/m.
    gradients: Vec<[DVec3; 3]>,
    lobe: [[f64; 2]; 3],
    /// The smallest `l/η = 1/(σ_t' η)` of the channels, m: so far the model's point is moved.
    moved: f64,
    /// The rest of `l/η` of each channel, m.
    rest: [f64; 3],
}

/// The largest logarithm of the factor by the shift. Light that is diffuse changes by less within a mean free path.
const MAX_SHIFT: f64 = 1.0;

/// Below this reduced extinction, 1/m, nothing is scattered; the shifts of others are finite.
const VACUUM: f64 = 1e-60;

/// `l/η = 1/(σ_t' η)`, m; 0 where nothing is scattered, as there is nothing to shift.
pub fn shift(c: &Coefficients, eta: f64) -> f64 {
    let reduced = c.reduced_extinction();
    if reduced > VACUUM { 1.0 / (reduced * eta) } else { 0.0 }
}

/// The mean of `(v_t·s)²` over the views `v` of a surface that shows all of them alike, up to that of the largest factor;
/// `slope` is the length of `s`.
pub fn mean_square_turn(slope: f64) -> f64 {
    0.25 * slope.min(MAX_SHIFT).powi(2)
}

impl Factors {
    pub fn new(material: &CalibratedMaterial) -> Factors {
        let log_factors = material.surface.patches.iter().map(|p| p.log_factor).collect();
        let gradients =
            material.surface.patches.iter().map(|p| p.gradient.map(|g| Vec3::from_array(g).as_dvec3())).collect();
        let medium = &material.medium;
        let shift = [0, 1, 2].map(|c| {
            let (sigma_a, sigma_s, asymmetry) = (medium.sigma_a[c], medium.sigma_s[c], medium.g[c]);
            shift(&Coefficients { sigma_a, sigma_s, asymmetry }, medium.eta)
        });
        let shortest = shift.into_iter().filter(|s| *s > 0.0).fold(f64::INFINITY, f64::min);
        let moved = if shortest.is_finite() { shortest } else { 0.0 };
        let rest = shift.map(|s| (s - moved).max(0.0));
        let patches = Patches::from_facts(&material.surface);
        Factors { patches, log_factors, gradients, lobe: material.lobe, moved, rest }
    }

    /// How far from a point of the surface the model is evaluated for its light towards the unit vector `view`, m
    /// (docs/method.md 16.5).
    pub fn offset(&self, site: &Site, view: DVec3) -> DVec3 {
        (site.normal.dot(view) * site.normal - view) * self.moved
    }

    /// `a` and `b` of the exit lobe `a + b cosθ` of each channel.
    pub fn lobe(&self) -> &[[f64; 2]; 3] {
        &self.lobe
    }

    /// The exit lobe at the cosine `to` over that at `from`; 1 where the latter is dark.
    pub fn turned_lobe(&self, from: f64, to: f64) -> DVec3 {
        let ratio = |[a, b]: [f64; 2]| if a + b * from > 0.0 { ((a + b * to) / (a + b * from)).max(0.0) } else { 1.0 };
        DVec3::from_array(self.lobe.map(ratio))
    }

    /// The factor of the radiance without `T21` that leaves at a point of the surface towards the unit vector `view`
    /// (docs/method.md 16.5).
    pub fn at(&self, site: &Site, view: DVec3) -> DVec3 {
        let cosine = site.normal.dot(view);
        let along = view - cosine * site.normal;
        let (mut sum, mut shift) = (DVec3::ZERO, DVec3::ZERO);
        self.patches.weights(site, |patch, weight| {
            let gradients = &self.gradients[patch as usize];
            sum += weight * DVec3::from_array(self.log_factors[patch as usize].map(f64::from));
            shift += weight * DVec3::from_array(gradients.map(|g| g.dot(along)));
        });
        let bounded = (shift * DVec3::from_array(self.rest)).clamp(DVec3::splat(-MAX_SHIFT), DVec3::splat(MAX_SHIFT));
        let lobe = DVec3::from_array(self.lobe.map(|[a, b]| a + b * cosine));
        lobe * (sum - bounded).exp()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use formats::calibration::{CalibratedPatch, CalibratedSurface, ChannelErrors, MediumFacts};

    /// The point moves away from the eye by the shortest mean free path, seen along the surface; the other channels go
    /// on from there by their gradients. Along the normal nothing changes.
    ///
    /// Seen to catch: the whole mean free path in the factor; a point that moves towards the eye.
    #[test]
    fn the_eyes_angle_moves_the_point_and_turns_the_factor() {
        let medium = MediumFacts {
            name: "three".into(),
            source: String::new(),
            sigma_a: [0.0; 3],
            sigma_s: [1000.0, 500.0, 250.0],
            g: [0.0; 3],
            eta: 1.25,
        };
        let gradient = [[100.0, 0.0, 0.0]; 3];
        let patch = CalibratedPatch { center: [0.0; 6], radius: 0.02, log_factor: [0.0; 3], gradient };
        let surface = CalibratedSurface { normal_scale: 0.03, splits: Vec::new(), patches: vec![patch] };
        let errors = [ChannelErrors::default(); 3];
        let material = CalibratedMaterial {
            name: "flat".into(),
            index: 0,
            medium,
            roughness: None,
            lobe: [[1.0, 0.0]; 3],
            errors,
            surface,
        };
        let factors = Factors::new(&material);
        let site = Site { position: DVec3::ZERO, normal: DVec3::Z };
        let view = DVec3::new(0.6, 0.0, 0.8);
        assert!((factors.offset(&site, view) - DVec3::new(-0.6 * 0.8e-3, 0.0, 0.0)).length() < 1e-15);
        let expected = DVec3::new(1.0, (-0.6f64 * 0.08).exp(), (-0.6f64 * 0.24).exp());
        assert!((factors.at(&site, view) - expected).length() < 1e-12);
        assert!(factors.offset(&site, DVec3::Z).length() < 1e-15);
        assert!((factors.at(&site, DVec3::Z) - DVec3::ONE).length() < 1e-12);
    }
}

//! The factors of one material as images use them.

use crate::patches::{Patches, Site};
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

impl Factors {
    pub fn new(material: &CalibratedMaterial) -> Factors {
        let log_factors = material.surface.patches.iter().map(|p| p.log_factor).collect();
        let gradients =
            material.surface.patches.iter().map(|p| p.gradient.map(|g| Vec3::from_array(g).as_dvec3())).collect();
        let medium = &material.medium;
        let shift = [0, 1, 2].map(|c| {
            let reduced = medium.sigma_a[c] + (1.0 - medium.g[c]) * medium.sigma_s[c];
            // Where nothing is scattered there is nothing to shift.
            if reduced > VACUUM { 1.0 / (reduced * medium.eta) } else { 0.0 }
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

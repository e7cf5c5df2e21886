//! The contract of all lights.

use super::bounds::LightBounds;
use crate::mesh::SurfacePoint;
use glam::DVec3;

/// Light that reaches a point if nothing is in the way.
#[derive(Clone, Copy, Debug)]
pub struct Illumination {
    /// Unit direction towards the light.
    pub direction: DVec3,
    /// Distance to the light, m; infinite for distant light.
    pub distance: f64,
    /// `E = L_i (n·ω)/pdf_solid_angle(ω)`, cosine included, visibility not, W/m².
    // note: [irradiance]
    pub irradiance: DVec3,
    /// `pdf_solid_angle(ω)`, 1/sr; 0 for a delta distribution.
    pub density: f64,
}

impl Illumination {
    /// Light from infinitely far away.
    pub(super) fn distant(direction: DVec3, irradiance: DVec3, density: f64) -> Illumination {
        Illumination { direction, distance: f64::INFINITY, irradiance, density }
    }
}

/// Where the light of a delta distribution comes from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Delta {
    /// This unit direction, everywhere.
    Direction(DVec3),
    /// This point, m.
    Point(DVec3),
}

/// A source of light. No method has a default: a light that leaves one out does not compile.
pub trait Light: Send + Sync {
    /// The weight by which one light of many is chosen, W/m²: near the unshadowed irradiance at `at`, positive wherever
    /// the light could reach that point, and 0 only where it certainly cannot.
    fn importance(&self, at: &SurfacePoint) -> f64;

    /// Bounds of the light's position and emission; none if it is infinitely far away.
    fn bounds(&self) -> Option<LightBounds>;

    /// Samples the light that arrives at `at`, from the direction that the uniform numbers `xi` choose; none if it
    /// arrives from below the surface.
    fn illuminate(&self, at: &SurfacePoint, xi: [f64; 2]) -> Option<Illumination>;

    /// Density with which [`Light::illuminate`] chooses `direction` at `at`, 1/sr; 0 if the light has a single
    /// direction there (a delta distribution).
    fn pdf_solid_angle(&self, at: &SurfacePoint, direction: DVec3) -> f64;

    /// Emitted radiance that arrives at `position` from `direction` if nothing is in the way, W/(m² sr); 0 if the light
    /// has a single direction there.
    fn radiance(&self, position: DVec3, direction: DVec3) -> DVec3;

    /// The material whose surface shines; none for lights that are no surfaces.
    fn material(&self) -> Option<u16>;

    /// The origin of a light that has a single direction at each point; none for others, which rays may meet.
    fn delta(&self) -> Option<Delta>;

    /// Hashes everything that defines the light: a cloud is kept as long as this stays the same.
    fn hash_into(&self, hasher: &mut blake3::Hasher);
}

/// The sum of the three channels: positive wherever one of them is.
pub(crate) fn channel_sum(color: DVec3) -> f64 {
    color.element_sum()
}

/// Hashes a mark of the kind of light, and its numbers.
pub(super) fn hash_numbers(hasher: &mut blake3::Hasher, kind: u8, numbers: &[f64]) {
    hasher.update(&[kind]);
    numbers.iter().for_each(|x| _ = hasher.update(&x.to_le_bytes()));
}

//! Light from infinitely far away, of one direction.

use super::{
    bounds::LightBounds,
    contract::{Delta, Illumination, Light, channel_sum, hash_numbers},
};
use crate::mesh::SurfacePoint;
use glam::DVec3;

/// A directional light (KHR_lights_punctual): `E = E⊥ (n·ω)`.
#[derive(Clone, Debug)]
pub struct DirectionalLight {
    /// Unit direction towards the light.
    pub direction: DVec3,
    /// Irradiance `E⊥` on a plane perpendicular to the light, W/m².
    pub irradiance: DVec3,
}

impl Light for DirectionalLight {
    fn bounds(&self) -> Option<LightBounds> {
        None
    }

    fn importance(&self, at: &SurfacePoint) -> f64 {
        if at.geometric_normal.dot(self.direction) <= 0.0 {
            return 0.0;
        }
        channel_sum(self.irradiance) * at.normal.dot(self.direction).max(0.0)
    }

    fn illuminate(&self, at: &SurfacePoint, _xi: [f64; 2]) -> Option<Illumination> {
        let cosine = at.normal.dot(self.direction);
        (cosine > 0.0).then(|| Illumination::distant(self.direction, self.irradiance * cosine, 0.0))
    }

    fn pdf_solid_angle(&self, _at: &SurfacePoint, _direction: DVec3) -> f64 {
        0.0
    }

    fn material(&self) -> Option<u16> {
        None
    }

    fn delta(&self) -> Option<Delta> {
        Some(Delta::Direction(self.direction))
    }

    fn radiance(&self, _position: DVec3, _direction: DVec3) -> DVec3 {
        DVec3::ZERO
    }

    fn hash_into(&self, hasher: &mut blake3::Hasher) {
        hash_numbers(hasher, 1, &[(-self.direction).to_array(), self.irradiance.to_array()].concat());
    }
}

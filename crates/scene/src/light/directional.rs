//! Light from infinitely far away.

use super::{Illumination, Light, LightBounds, channel_sum};
use crate::mesh::SurfacePoint;
use glam::DVec3;

/// A directional light (KHR_lights_punctual): `E = E⊥ (n·ω)`.
#[derive(Clone, Debug)]
pub struct DirectionalLight {
    /// Unit direction towards the light.
    pub direction: DVec3,
    /// Irradiance `E⊥` on a plane across the light, W/m².
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
        (cosine > 0.0).then(|| Illumination {
            direction: self.direction,
            distance: f64::INFINITY,
            irradiance: self.irradiance * cosine,
        })
    }
}

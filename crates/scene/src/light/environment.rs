//! Light from all around.

use super::{Illumination, Light, strength};
use crate::{mesh::SurfacePoint, warp};
use glam::DVec3;
use std::f64::consts::PI;

/// The same radiance from every direction: with cosine-distributed directions `E = V π L` (method.md 6.4).
#[derive(Clone, Debug)]
pub struct ConstantEnvironment {
    /// W/(m² sr).
    pub radiance: DVec3,
}

impl Light for ConstantEnvironment {
    fn importance(&self, _at: &SurfacePoint) -> f64 {
        PI * strength(self.radiance)
    }

    fn illuminate(&self, at: &SurfacePoint, xi: [f64; 2]) -> Option<Illumination> {
        let direction = warp::cosine_hemisphere(at.normal, xi);
        Some(Illumination { direction, distance: f64::INFINITY, irradiance: self.radiance * PI })
    }
}

//! Light from all around.

use super::{
    bounds::LightBounds,
    contract::{Delta, Illumination, Light, channel_sum},
    environment_map::EnvironmentMap,
};
use crate::{mesh::SurfacePoint, warp};
use glam::DVec3;
use std::{f64::consts::PI, sync::Arc};

/// Light from infinitely far away in every direction.
#[derive(Clone, Debug)]
pub enum Environment {
    /// The same radiance from every direction, W/(m² sr).
    Constant(DVec3),
    Map(Arc<EnvironmentMap>),
}

impl Environment {
    /// True if no light comes from it.
    pub fn is_black(&self) -> bool {
        match self {
            Environment::Constant(radiance) => *radiance == DVec3::ZERO,
            Environment::Map(map) => map.is_black(),
        }
    }

    /// Its identity as text: `R,G,B`, or a digest of the map's pixels with its scale and rotation.
    pub fn identity(&self) -> String {
        match self {
            Environment::Constant(DVec3 { x, y, z }) => format!("{x},{y},{z}"),
            Environment::Map(map) => map.identity(),
        }
    }
}

impl From<DVec3> for Environment {
    fn from(radiance: DVec3) -> Environment {
        Environment::Constant(radiance)
    }
}

impl Light for Environment {
    fn bounds(&self) -> Option<LightBounds> {
        None
    }

    fn importance(&self, at: &SurfacePoint) -> f64 {
        match self {
            Environment::Constant(radiance) => PI * channel_sum(*radiance),
            Environment::Map(map) => map.importance(at),
        }
    }

    /// A constant environment gives cosine-distributed directions, `E = V π L` (docs/method.md 6.4).
    fn illuminate(&self, at: &SurfacePoint, xi: [f64; 2]) -> Option<Illumination> {
        match self {
            Environment::Constant(radiance) => {
                let direction = warp::cosine_hemisphere(at.normal, xi);
                let density = warp::cosine_hemisphere_pdf_solid_angle(at.normal.dot(direction));
                Some(Illumination::distant(direction, *radiance * PI, density))
            }
            Environment::Map(map) => map.illuminate(at, xi),
        }
    }

    fn pdf_solid_angle(&self, at: &SurfacePoint, direction: DVec3) -> f64 {
        match self {
            Environment::Constant(_) => warp::cosine_hemisphere_pdf_solid_angle(at.normal.dot(direction)),
            Environment::Map(map) => map.pdf_solid_angle(at, direction),
        }
    }

    fn material(&self) -> Option<u16> {
        None
    }

    fn delta(&self) -> Option<Delta> {
        None
    }

    fn radiance(&self, _position: DVec3, direction: DVec3) -> DVec3 {
        match self {
            Environment::Constant(radiance) => *radiance,
            Environment::Map(map) => map.radiance(direction),
        }
    }

    fn hash_into(&self, hasher: &mut blake3::Hasher) {
        hasher.update(self.identity().as_bytes());
    }
}

//! The roughness of a translucent material, for models and walks alike.

use crate::boundary::{Meeting, Rough};
use bsdf::{RoughBoundary, RoughDielectric, SMOOTH_BELOW};
use bssrdf::RoughInterface;
use glam::DVec3;
use scene::{Material, Scene};

/// The roughness of a translucent surface.
pub struct Roughness {
    pub boundary: RoughBoundary,
    /// 0 to 1; its square is `α`. By this mean light enters below a model; it leaves, is mirrored and walks by the local
    /// one.
    pub mean: f64,
    /// Whether a texture varies it.
    varies: bool,
}

/// Boundaries between nearly equal indices mirror next to nothing, and have no microfacet that would bend light back.
const EQUAL_INDICES: f64 = 1e-3;

impl Roughness {
    /// That of a material; none if it is smooth.
    pub fn new(material: &Material, eta: f64) -> Option<Roughness> {
        let gloss = material.gloss.as_ref()?;
        let (mean, varies) = (gloss.mean_roughness(), gloss.texture.is_some());
        if mean * mean < SMOOTH_BELOW || (eta - 1.0).abs() < EQUAL_INDICES {
            return None;
        }
        let boundary = if varies { RoughBoundary::of_any_roughness(eta) } else { RoughBoundary::new(eta, mean) };
        Some(Roughness { boundary, mean, varies })
    }

    /// The interface of the mean roughness.
    pub fn interface(&self) -> RoughInterface<'_> {
        RoughInterface { boundary: &self.boundary, roughness: self.mean, eta: self.boundary.eta() }
    }

    /// The roughness at a point of a triangle.
    pub fn at(&self, scene: &Scene, triangle: u32, weights: [f64; 3]) -> f64 {
        let local = self.varies.then(|| scene.roughness(triangle, weights)).flatten();
        local.unwrap_or(self.mean)
    }

    /// The surface where light meets it. Where a texture makes it smooth, it is as rough as a surface can be that is not.
    #[inline(always)]
    pub fn surface(&self, scene: &Scene, meeting: &Meeting) -> RoughDielectric<'_> {
        if !self.varies {
            return self.boundary.surface(self.mean);
        }
        let weights = barycentric(meeting.position, scene.mesh.corners(meeting.face as usize));
        self.boundary.surface(self.at(scene, meeting.face, weights))
    }

    /// The boundary of the material's medium for walks.
    pub fn of_walks<'a>(&'a self, scene: &'a Scene) -> Rough<impl Fn(&Meeting) -> RoughDielectric<'a>> {
        Rough(move |meeting: &Meeting| self.surface(scene, meeting))
    }
}

/// The barycentric weights of a point of a triangle.
fn barycentric(position: DVec3, [a, b, c]: [DVec3; 3]) -> [f64; 3] {
    let normal = (b - a).cross(c - a);
    let inverse = 1.0 / normal.length_squared();
    let v = normal.dot((position - a).cross(c - a)) * inverse;
    let w = normal.dot((b - a).cross(position - a)) * inverse;
    [1.0 - v - w, v, w]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Seen to catch: two weights exchanged.
    #[test]
    fn a_point_is_its_weighted_corners() {
        let corners = [DVec3::new(1.0, 0.2, 0.0), DVec3::new(0.3, 2.0, 0.5), DVec3::new(-1.0, 0.1, 0.7)];
        let weights = [0.2, 0.5, 0.3];
        let point = (0..3).map(|k| corners[k] * weights[k]).sum();
        let found = barycentric(point, corners);
        assert!((0..3).all(|k| (found[k] - weights[k]).abs() < 1e-14), "{found:?}");
    }
}

//! Light from emitting triangles.

use super::{Illumination, Light, strength};
use crate::{
    mesh::{Mesh, SurfacePoint, unit},
    warp,
};
use glam::DVec3;
use std::f64::consts::PI;

/// An emitting triangle.
#[derive(Clone, Debug)]
struct Emitter {
    corners: [DVec3; 3],
    normal: DVec3,
    /// Area of this and all triangles before it, m².
    area_so_far: f64,
}

/// All triangles of one emitting material (KHR_materials_emissive_strength): a uniform point on them is seen under
/// `E = L (n·ω)(n_l·−ω) A/d²`.
#[derive(Clone, Debug)]
pub struct AreaLight {
    radiance: DVec3,
    double_sided: bool,
    emitters: Vec<Emitter>,
    area: f64,
    centre: DVec3,
    radius: f64,
}

impl AreaLight {
    /// These triangles of `mesh`, emitting `radiance`, W/(m² sr); none if there are none.
    pub fn new(mesh: &Mesh, triangles: &[usize], radiance: DVec3, double_sided: bool) -> Option<AreaLight> {
        let (mut emitters, mut area) = (Vec::new(), 0.0);
        let (mut low, mut high) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
        for k in triangles {
            let corners = mesh.corners(*k);
            area += mesh.area(*k);
            corners.iter().for_each(|c| (low, high) = (low.min(*c), high.max(*c)));
            let normal = unit((corners[1] - corners[0]).cross(corners[2] - corners[0]));
            emitters.push(Emitter { corners, normal, area_so_far: area });
        }
        let (centre, radius) = ((low + high) / 2.0, (high - low).length() / 2.0);
        (area > 0.0).then_some(AreaLight { radiance, double_sided, emitters, area, centre, radius })
    }
}

impl Light for AreaLight {
    /// The light as if it were a small one-sided source at its centre, at least its radius away, under the largest
    /// cosine that a point of it can have; 0 only if all of it lies behind the surface.
    fn importance(&self, at: &SurfacePoint) -> f64 {
        let offset = self.centre - at.position;
        let distance = offset.length().max(self.radius);
        let cosine = |normal: DVec3| ((offset.dot(normal) + self.radius) / distance).clamp(0.0, 1.0);
        let cosine = cosine(at.normal) * if cosine(at.geometric_normal) > 0.0 { 1.0 } else { 0.0 };
        strength(self.radiance) * self.area * cosine / (PI * distance * distance)
    }

    fn illuminate(&self, at: &SurfacePoint, xi: [f64; 2]) -> Option<Illumination> {
        let target = xi[0] * self.area;
        let index = self.emitters.partition_point(|e| e.area_so_far <= target).min(self.emitters.len() - 1);
        let before = if index == 0 { 0.0 } else { self.emitters[index - 1].area_so_far };
        let emitter = &self.emitters[index];
        // The digits of xi that the choice of triangle left over choose the point on it.
        let rest = ((target - before) / (emitter.area_so_far - before)).clamp(0.0, 1.0);
        let [a, b, c] = emitter.corners;
        let w = warp::triangle([rest, xi[1]]);
        let offset = a * w[0] + b * w[1] + c * w[2] - at.position;
        let distance = offset.length();
        if distance == 0.0 {
            return None; // the point lies on the light
        }
        let direction = offset / distance;
        let cosine_out = -emitter.normal.dot(direction);
        let cosine_out = if self.double_sided { cosine_out.abs() } else { cosine_out };
        let factor = at.normal.dot(direction) * cosine_out * self.area / (distance * distance);
        let lit = at.normal.dot(direction) > 0.0 && cosine_out > 0.0 && factor.is_finite();
        lit.then(|| Illumination { direction, distance, irradiance: self.radiance * factor })
    }
}

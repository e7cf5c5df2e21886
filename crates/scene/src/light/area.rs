//! Light from emitting triangles.

use super::{Illumination, Light, LightBounds, ReceiverBounds, bounds::LightSphere, channel_sum};
use crate::{
    mesh::{Mesh, SurfacePoint, unit},
    warp,
};
use glam::DVec3;
use std::f64::consts::{FRAC_PI_2, PI};

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
    bounds: LightBounds,
    sphere: LightSphere,
}

impl AreaLight {
    /// These triangles of `mesh`, emitting `radiance`, W/(m² sr); none if there are none.
    pub fn new(mesh: &Mesh, triangles: &[usize], radiance: DVec3, double_sided: bool) -> Option<AreaLight> {
        let (mut emitters, mut area) = (Vec::new(), 0.0);
        let mut bounds: Option<LightBounds> = None;
        for k in triangles {
            let corners = mesh.corners(*k);
            area += mesh.area(*k);
            let normal = unit((corners[1] - corners[0]).cross(corners[2] - corners[0]));
            emitters.push(Emitter { corners, normal, area_so_far: area });
            let own = LightBounds {
                low: corners[0].min(corners[1]).min(corners[2]),
                high: corners[0].max(corners[1]).max(corners[2]),
                // The mean over the half space that a triangle shines into.
                intensity: channel_sum(radiance) * mesh.area(*k) / PI,
                axis: normal,
                reach: if double_sided { PI } else { FRAC_PI_2 },
                range: f64::INFINITY,
            };
            bounds = Some(bounds.map_or(own, |all| all.join(&own)));
        }
        let bounds = bounds.filter(|_| area > 0.0)?;
        Some(AreaLight { radiance, double_sided, emitters, area, bounds, sphere: LightSphere::new(&bounds) })
    }
}

impl Light for AreaLight {
    /// With the largest cosine that a place of it can have.
    fn importance(&self, at: &SurfacePoint) -> f64 {
        let [_, most] = self.sphere.arriving(&ReceiverBounds::point(at));
        most
    }

    fn bounds(&self) -> Option<LightBounds> {
        Some(self.bounds)
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

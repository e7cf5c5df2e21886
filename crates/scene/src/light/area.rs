//! Light from emitting triangles.

use super::{
    bounds::{LightBounds, LightSphere, ReceiverBounds},
    contract::{Delta, Illumination, Light, channel_sum, hash_numbers},
    direction_cone::DirectionCone,
};
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
    /// Sum of the areas of this triangle and all before it, m².
    area_so_far: f64,
}

impl Emitter {
    /// Distance to the triangle along a unit direction, m (Möller and Trumbore 1997); none if the ray misses it.
    fn distance(&self, origin: DVec3, direction: DVec3) -> Option<f64> {
        let [a, b, c] = self.corners;
        let (ab, ac, offset) = (b - a, c - a, origin - a);
        let across = direction.cross(ac);
        let determinant = ab.dot(across);
        let u = offset.dot(across) / determinant;
        let v = direction.dot(offset.cross(ab)) / determinant;
        let distance = ac.dot(offset.cross(ab)) / determinant;
        (u >= 0.0 && v >= 0.0 && u + v <= 1.0 && distance > 0.0).then_some(distance)
    }
}

/// All triangles of one emitting material (KHR_materials_emissive_strength): a uniform point on them lights a surface
/// by `E = L (n·ω)(n_l·−ω) A/d²`.
#[derive(Clone, Debug)]
pub struct AreaLight {
    /// Index of the material.
    material: u16,
    radiance: DVec3,
    double_sided: bool,
    emitters: Vec<Emitter>,
    area: f64,
    bounds: LightBounds,
    sphere: LightSphere,
}

impl AreaLight {
    /// These triangles of `mesh`, of one material that emits `radiance`, W/(m² sr); none if there are none.
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
                // The mean over the half-space that a triangle shines into.
                intensity: channel_sum(radiance) * mesh.area(*k) / PI,
                cone: DirectionCone { axis: normal, half_angle: if double_sided { PI } else { FRAC_PI_2 } },
                range: f64::INFINITY,
            };
            bounds = Some(bounds.map_or(own, |all| all.join(&own)));
        }
        let bounds = bounds.filter(|_| area > 0.0)?;
        let material = mesh.triangles[*triangles.first()?].material;
        let sphere = LightSphere::new(&bounds);
        Some(AreaLight { material, radiance, double_sided, emitters, area, bounds, sphere })
    }

    /// The cosine at which a triangle shines against `direction`, not positive on its dark side.
    fn cosine_out(&self, emitter: &Emitter, direction: DVec3) -> f64 {
        let cosine = -emitter.normal.dot(direction);
        if self.double_sided { cosine.abs() } else { cosine }
    }

    /// Distance to the first triangle along a ray, and the cosine at which that shines back; none if it does not.
    fn seen(&self, origin: DVec3, direction: DVec3) -> Option<(f64, f64)> {
        let hits = self.emitters.iter().filter_map(|e| Some((e.distance(origin, direction)?, e)));
        let (distance, emitter) = hits.min_by(|(a, _), (b, _)| a.total_cmp(b))?;
        Some((distance, self.cosine_out(emitter, direction))).filter(|(_, cosine)| *cosine > 0.0)
    }
}

impl Light for AreaLight {
    /// The irradiance with the largest cosine that any point of the light can have.
    fn importance(&self, at: &SurfacePoint) -> f64 {
        let [_, max] = self.sphere.irradiance(&ReceiverBounds::point(at));
        max
    }

    fn bounds(&self) -> Option<LightBounds> {
        Some(self.bounds)
    }

    fn illuminate(&self, at: &SurfacePoint, xi: [f64; 2]) -> Option<Illumination> {
        let target = xi[0] * self.area;
        let index = self.emitters.partition_point(|e| e.area_so_far <= target).min(self.emitters.len() - 1);
        let before = if index == 0 { 0.0 } else { self.emitters[index - 1].area_so_far };
        let emitter = &self.emitters[index];
        // Within the triangle's share the number is uniform again: it chooses the point.
        let rest = ((target - before) / (emitter.area_so_far - before)).clamp(0.0, 1.0);
        let [a, b, c] = emitter.corners;
        let w = warp::triangle([rest, xi[1]]);
        let offset = a * w[0] + b * w[1] + c * w[2] - at.position;
        let distance = offset.length();
        if distance == 0.0 {
            return None; // The point lies on the light.
        }
        let direction = offset / distance;
        let cosine_out = self.cosine_out(emitter, direction);
        let factor = at.normal.dot(direction) * cosine_out * self.area / (distance * distance);
        let lit = at.normal.dot(direction) > 0.0 && cosine_out > 0.0 && factor.is_finite();
        lit.then(|| Illumination { direction, distance, irradiance: self.radiance * factor })
    }

    fn pdf_solid_angle(&self, at: &SurfacePoint, direction: DVec3) -> f64 {
        let seen = self.seen(at.position, direction);
        seen.map_or(0.0, |(distance, cosine_out)| distance * distance / (cosine_out * self.area))
    }

    fn delta(&self) -> Option<Delta> {
        None
    }

    fn radiance(&self, position: DVec3, direction: DVec3) -> DVec3 {
        self.seen(position, direction).map_or(DVec3::ZERO, |_| self.radiance)
    }

    /// The geometry of the triangles is a part of the scene's own digest.
    fn hash_into(&self, hasher: &mut blake3::Hasher) {
        hash_numbers(hasher, 3, &[f64::from(self.material), f64::from(u8::from(self.double_sided))]);
        hash_numbers(hasher, 3, &self.radiance.to_array());
    }
}

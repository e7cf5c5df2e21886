//! Light from emitting triangles.

use super::{
    bounds::{LightBounds, LightSphere, ReceiverBounds},
    contract::{Delta, Illumination, Light, channel_sum, hash_numbers},
    direction_cone::DirectionCone,
    glow,
};
use crate::{
    mesh::{Mesh, SurfacePoint, unit},
    texture::Texture,
    warp,
};
use glam::{DVec2, DVec3};
use std::f64::consts::{FRAC_PI_2, PI};

/// An emitting triangle.
#[derive(Clone, Debug)]
struct Emitter {
    corners: [DVec3; 3],
    normal: DVec3,
    /// Sum of the weights of this triangle and all before it. The weight is the area, m², times the brightness of its
    /// texture, if it has one.
    weight_so_far: f64,
    /// Its area over its weight.
    area_per_weight: f64,
}

impl Emitter {
    /// Distance to the triangle along a unit direction, m (Möller and Trumbore 1997), and the weights of the second and
    /// third corner; none if the ray misses it.
    fn meet(&self, origin: DVec3, direction: DVec3) -> Option<(f64, [f64; 2])> {
        let [a, b, c] = self.corners;
        let (ab, ac, offset) = (b - a, c - a, origin - a);
        let across = direction.cross(ac);
        let determinant = ab.dot(across);
        let u = offset.dot(across) / determinant;
        let v = direction.dot(offset.cross(ab)) / determinant;
        let distance = ac.dot(offset.cross(ab)) / determinant;
        (u >= 0.0 && v >= 0.0 && u + v <= 1.0 && distance > 0.0).then_some((distance, [u, v]))
    }
}

/// The texture of a light, and its coordinates at the corners of each triangle.
#[derive(Clone, Debug)]
struct Glow {
    texture: Texture,
    coordinates: Vec<[DVec2; 3]>,
}

/// All triangles of one emitting material (KHR_materials_emissive_strength): a point on them lights a surface by
/// `E = L (n·ω)(n_l·−ω) A/d²`. The point is uniform or, where a texture varies the radiance, uniform on a part of a
/// triangle that is chosen by its brightness; `A` is then the inverse density.
#[derive(Clone, Debug)]
pub struct AreaLight {
    /// Index of the material.
    material: u16,
    radiance: DVec3,
    double_sided: bool,
    emitters: Vec<Emitter>,
    glow: Option<Glow>,
    /// Sum of all weights.
    weight: f64,
    bounds: LightBounds,
    sphere: LightSphere,
}

/// A point where a ray meets the light.
struct Seen {
    distance: f64,
    /// Index of the emitter, and the weights of its second and third corner.
    emitter: usize,
    weights: [f64; 2],
    /// The cosine at which it shines back, above zero.
    cosine: f64,
}

impl AreaLight {
    /// These triangles of `mesh`, of one material that emits `radiance`, W/(m² sr); none if there are none.
    pub fn new(mesh: &Mesh, triangles: &[usize], radiance: DVec3, double_sided: bool) -> Option<AreaLight> {
        let plain = triangles.iter().map(|k| (mesh.corners(*k), mesh.area(*k), mesh.area(*k), channel_sum(radiance)));
        let material = mesh.triangles[*triangles.first()?].material;
        AreaLight::of(plain, (material, radiance, double_sided), None)
    }

    /// The same, where `radiance` is a factor of a texture; none if it is black on all triangles.
    pub fn textured(
        mesh: &Mesh,
        triangles: &[usize],
        radiance: DVec3,
        double_sided: bool,
        texture: &Texture,
    ) -> Option<AreaLight> {
        let parts = glow::parts(mesh, triangles, radiance, texture);
        let coordinates = parts.iter().map(|part| part.coordinates).collect();
        let weighed = parts.iter().map(|part| (part.corners, part.area, part.area * part.brightness, part.brightness));
        let material = mesh.triangles[*triangles.first()?].material;
        AreaLight::of(weighed, (material, radiance, double_sided), Some(Glow { texture: texture.clone(), coordinates }))
    }

    /// Triangles with area, weight, and the channel sum of their mean radiance.
    fn of(
        triangles: impl Iterator<Item = ([DVec3; 3], f64, f64, f64)>,
        (material, radiance, double_sided): (u16, DVec3, bool),
        glow: Option<Glow>,
    ) -> Option<AreaLight> {
        let (mut emitters, mut sum) = (Vec::new(), 0.0);
        let mut bounds: Option<LightBounds> = None;
        for (corners, area, weight, brightness) in triangles {
            sum += weight;
            let normal = unit((corners[1] - corners[0]).cross(corners[2] - corners[0]));
            emitters.push(Emitter { corners, normal, weight_so_far: sum, area_per_weight: area / weight });
            let own = LightBounds {
                low: corners[0].min(corners[1]).min(corners[2]),
                high: corners[0].max(corners[1]).max(corners[2]),
                // The mean over the half-space that a triangle shines into.
                intensity: brightness * area / PI,
                cone: DirectionCone { axis: normal, half_angle: if double_sided { PI } else { FRAC_PI_2 } },
                range: f64::INFINITY,
            };
            bounds = Some(bounds.map_or(own, |all| all.join(&own)));
        }
        let bounds = bounds.filter(|_| sum > 0.0)?;
        let sphere = LightSphere::new(&bounds);
        Some(AreaLight { material, radiance, double_sided, emitters, glow, weight: sum, bounds, sphere })
    }

    /// Radiance of a point of an emitter by the weights of its second and third corner, W/(m² sr).
    fn radiance_at(&self, emitter: usize, [u, v]: [f64; 2]) -> DVec3 {
        let Some(glow) = &self.glow else { return self.radiance };
        let [a, b, c] = glow.coordinates[emitter];
        self.radiance * glow.texture.at((a + (b - a) * u + (c - a) * v).to_array()).truncate()
    }

    /// The cosine at which a triangle shines against `direction`, not positive on its dark side.
    fn cosine_out(&self, emitter: &Emitter, direction: DVec3) -> f64 {
        let cosine = -emitter.normal.dot(direction);
        if self.double_sided { cosine.abs() } else { cosine }
    }

    /// The first triangle along a ray; none if it does not shine back.
    fn seen(&self, origin: DVec3, direction: DVec3) -> Option<Seen> {
        let hits = self.emitters.iter().enumerate().filter_map(|(k, e)| Some((k, e.meet(origin, direction)?)));
        let (emitter, (distance, weights)) = hits.min_by(|(_, (a, _)), (_, (b, _))| a.total_cmp(b))?;
        let cosine = self.cosine_out(&self.emitters[emitter], direction);
        (cosine > 0.0).then_some(Seen { distance, emitter, weights, cosine })
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
        let target = xi[0] * self.weight;
        let index = self.emitters.partition_point(|e| e.weight_so_far <= target).min(self.emitters.len() - 1);
        let before = if index == 0 { 0.0 } else { self.emitters[index - 1].weight_so_far };
        let emitter = &self.emitters[index];
        // Within the triangle's share the number is uniform again: it chooses the point.
        let rest = ((target - before) / (emitter.weight_so_far - before)).clamp(0.0, 1.0);
        let [a, b, c] = emitter.corners;
        let w = warp::triangle([rest, xi[1]]);
        let offset = a * w[0] + b * w[1] + c * w[2] - at.position;
        let distance = offset.length();
        if distance == 0.0 {
            return None; // The point lies on the light.
        }
        let direction = offset / distance;
        let cosine_out = self.cosine_out(emitter, direction);
        let area = self.weight * emitter.area_per_weight;
        let factor = at.normal.dot(direction) * cosine_out * area / (distance * distance);
        let lit = at.normal.dot(direction) > 0.0 && cosine_out > 0.0 && factor.is_finite();
        let radiance = || self.radiance_at(index, [w[1], w[2]]);
        let density = || distance * distance / (cosine_out * area);
        lit.then(|| Illumination { direction, distance, irradiance: radiance() * factor, density: density() })
    }

    fn pdf_solid_angle(&self, at: &SurfacePoint, direction: DVec3) -> f64 {
        self.seen(at.position, direction).map_or(0.0, |seen| {
            let area = self.weight * self.emitters[seen.emitter].area_per_weight;
            seen.distance * seen.distance / (seen.cosine * area)
        })
    }

    fn material(&self) -> Option<u16> {
        Some(self.material)
    }

    fn delta(&self) -> Option<Delta> {
        None
    }

    fn radiance(&self, position: DVec3, direction: DVec3) -> DVec3 {
        self.seen(position, direction).map_or(DVec3::ZERO, |seen| self.radiance_at(seen.emitter, seen.weights))
    }

    /// The geometry of the triangles is a part of the scene's own digest.
    fn hash_into(&self, hasher: &mut blake3::Hasher) {
        hash_numbers(hasher, 3, &[f64::from(self.material), f64::from(u8::from(self.double_sided))]);
        hash_numbers(hasher, 3, &self.radiance.to_array());
        let Some(Glow { texture, coordinates }) = &self.glow else { return };
        let wrap = texture.wrap.map(|w| f64::from(w as u8));
        let width = texture.picture.width as f64;
        hash_numbers(hasher, 3, &[wrap[0], wrap[1], f64::from(u8::from(texture.nearest)), width]);
        hasher.update(texture.picture.texels.as_flattened());
        coordinates.iter().flatten().for_each(|uv| hash_numbers(hasher, 3, &uv.to_array()));
    }
}

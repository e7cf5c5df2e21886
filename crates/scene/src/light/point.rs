//! Light from one point, to all sides or within a cone.

use super::{
    bounds::LightBounds,
    contract::{Delta, Illumination, Light, channel_sum, hash_numbers},
    direction_cone::DirectionCone,
};
use crate::mesh::SurfacePoint;
use glam::DVec3;

/// The falloff of a spot light. The cosines of small angles are equal in float64: this holds `1 - cos x = 2 sin²(x/2)`
/// instead, which keeps its digits.
#[derive(Clone, Copy, Debug)]
pub struct Spot {
    /// The directions that get light.
    cone: DirectionCone,
    /// The angle from the axis up to which the intensity is whole, rad.
    inner: f64,
    /// `1 - cos` of the inner angle, and of the half angle of the cone.
    versines: [f64; 2],
    /// The difference of the two.
    width: f64,
}

impl Spot {
    /// A cone about a unit vector, whole up to the angle `inner` and dark from `outer` on, rad, `inner <= outer`. Where
    /// both are the same, the edge is hard.
    pub fn new(axis: DVec3, inner: f64, outer: f64) -> Spot {
        let versine = |angle: f64| 2.0 * (0.5 * angle).sin().powi(2);
        // cos inner - cos outer, without a difference of numbers that are nearly equal.
        let width = 2.0 * (0.5 * (outer + inner)).sin() * (0.5 * (outer - inner)).sin();
        let cone = DirectionCone { axis, half_angle: outer };
        Spot { cone, inner, versines: [versine(inner), versine(outer)], width }
    }

    /// Share of the intensity that leaves towards a point in direction `-direction` (KHR_lights_punctual).
    fn attenuation(&self, direction: DVec3) -> f64 {
        // 1 - cos of the angle from the axis: half the square of its chord.
        let versine = 0.5 * (self.cone.axis + direction).length_squared();
        let [inner, outer] = self.versines;
        if versine <= inner {
            1.0
        } else if versine < outer {
            ((outer - versine) / self.width).min(1.0).powi(2)
        } else {
            0.0
        }
    }
}

/// A point or spot light (KHR_lights_punctual): `E = I (n·ω)/d²`.
#[derive(Clone, Debug)]
pub struct PointLight {
    /// m, relative to the scene's origin.
    pub position: DVec3,
    /// Radiant intensity `I`, W/sr.
    pub intensity: DVec3,
    pub spot: Option<Spot>,
    /// Distance at which the light fades to nothing, m.
    pub range: Option<f64>,
}

impl PointLight {
    /// Share of the intensity that leaves towards a point at `distance` in direction `-direction`.
    fn attenuation(&self, direction: DVec3, distance: f64) -> f64 {
        let spot = self.spot.map_or(1.0, |spot| spot.attenuation(direction));
        let range = self.range.map_or(1.0, |range| (1.0 - (distance / range).powi(4)).clamp(0.0, 1.0));
        spot * range
    }
}

impl Light for PointLight {
    fn importance(&self, at: &SurfacePoint) -> f64 {
        match self.illuminate(at, [0.0; 2]) {
            Some(light) if light.direction.dot(at.geometric_normal) > 0.0 => channel_sum(light.irradiance),
            _ => 0.0,
        }
    }

    fn bounds(&self) -> Option<LightBounds> {
        Some(LightBounds {
            low: self.position,
            high: self.position,
            intensity: channel_sum(self.intensity),
            cone: self.spot.map_or(DirectionCone::SPHERE, |spot| spot.cone),
            range: self.range.unwrap_or(f64::INFINITY),
        })
    }

    fn illuminate(&self, at: &SurfacePoint, _xi: [f64; 2]) -> Option<Illumination> {
        let offset = self.position - at.position;
        let distance = offset.length();
        if distance == 0.0 {
            return None; // The light lies in the surface: there is no direction and no finite irradiance.
        }
        let direction = offset / distance;
        let cosine = at.normal.dot(direction);
        let factor = self.attenuation(direction, distance) * cosine / (distance * distance);
        let lit = cosine > 0.0 && factor > 0.0 && factor.is_finite();
        lit.then(|| Illumination { direction, distance, irradiance: self.intensity * factor, density: 0.0 })
    }

    fn pdf_solid_angle(&self, _at: &SurfacePoint, _direction: DVec3) -> f64 {
        0.0
    }

    fn material(&self) -> Option<u16> {
        None
    }

    fn delta(&self) -> Option<Delta> {
        Some(Delta::Point(self.position))
    }

    fn radiance(&self, _position: DVec3, _direction: DVec3) -> DVec3 {
        DVec3::ZERO
    }

    fn hash_into(&self, hasher: &mut blake3::Hasher) {
        hash_numbers(hasher, 2, &[self.position.to_array(), self.intensity.to_array()].concat());
        let spot = self.spot.map(|spot| [&spot.cone.axis.to_array()[..], &[spot.inner, spot.cone.half_angle]].concat());
        hash_numbers(hasher, 2, &spot.unwrap_or_default());
        hash_numbers(hasher, 2, &[self.range.unwrap_or(f64::INFINITY)]);
    }
}

//! Bounds of one light or of many, where they are and what they can send, and of surface points that lights are chosen
//! for together.

use super::direction_cone::DirectionCone;
use crate::mesh::SurfacePoint;
use glam::DVec3;
use std::f64::consts::PI;

/// Two spheres whose centers are closer than this many times the sum of their radii are near each other.
const NEAR_RADII: f64 = 3.0;

/// Bounds of lights at finite distance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LightBounds {
    /// Corners of the box around the lights, m.
    pub low: DVec3,
    pub high: DVec3,
    /// Radiant intensity, the sum of all channels, W/sr.
    pub intensity: f64,
    /// Directions that the lights shine into.
    pub cone: DirectionCone,
    /// Distance beyond which no light arrives, m.
    pub range: f64,
}

impl LightBounds {
    /// The middle of the box.
    pub fn center(&self) -> DVec3 {
        self.low + 0.5 * (self.high - self.low)
    }

    /// The bounds of both.
    pub fn join(&self, other: &LightBounds) -> LightBounds {
        LightBounds {
            low: self.low.min(other.low),
            high: self.high.max(other.high),
            intensity: self.intensity + other.intensity,
            cone: self.cone.join(other.cone),
            range: self.range.max(other.range),
        }
    }
}

/// The bounding sphere of a light's bounds, with what the importance of the light for a receiver is computed from.
#[derive(Clone, Copy, Debug)]
pub(super) struct LightSphere {
    center: DVec3,
    /// m.
    radius: f64,
    intensity: f64,
    axis: DVec3,
    cos_half_angle: f64,
    range: f64,
}

impl LightSphere {
    pub fn new(bounds: &LightBounds) -> LightSphere {
        let DirectionCone { axis, half_angle } = bounds.cone;
        LightSphere {
            center: bounds.center(),
            radius: 0.5 * (bounds.high - bounds.low).length(),
            intensity: bounds.intensity,
            axis,
            // Rounding must not hide what lies on the cone.
            cos_half_angle: if half_angle < PI { (half_angle + 1e-6).min(PI).cos() } else { -1.0 },
            range: bounds.range,
        }
    }

    /// Whether the sphere and the receiver are so close that the distances between their points differ much.
    pub fn is_near(&self, receiver: &ReceiverBounds) -> bool {
        self.center.distance(receiver.center.position) < NEAR_RADII * (self.radius + receiver.radius)
    }

    /// Whether the light that arrives depends on more than distance and cosine.
    pub fn falls_off(&self) -> bool {
        self.cos_half_angle > -1.0 || self.range < f64::INFINITY
    }

    /// The irradiance at the center of a receiver as if all light came from the center of the sphere; and the same with
    /// the largest cosine between any point of the one and any of the other, W/m². The latter is 0 only if no point of
    /// the sphere can light a point of the receiver.
    pub fn irradiance(&self, receiver: &ReceiverBounds) -> [f64; 2] {
        let offset = self.center - receiver.center.position;
        let length = offset.length();
        let radius = self.radius + receiver.radius + 1e-9 * length;
        if length - radius > self.range || (self.cos_half_angle > -1.0 && !self.shines_towards(offset, length, radius))
        {
            return [0.0; 2];
        }
        let distance = length.max(radius);
        // If all lights and the receiver are one point, the distance is 0 and any positive number serves.
        let square = (distance * distance).max(f64::MIN_POSITIVE);
        let [cosine, max_cosine] = if length > radius {
            let cosine = receiver.center.normal.dot(offset) / length;
            [cosine.clamp(0.0, 1.0), (receiver.max_cosine(cosine) + radius / length).clamp(0.0, 1.0)]
        } else {
            [1.0; 2]
        };
        [cosine, max_cosine].map(|c| (self.intensity * c / square).min(f64::MAX / 1e9))
    }

    /// Whether points within `radius` of the one at `-offset` from the center may lie in the cone of a light of the
    /// sphere.
    fn shines_towards(&self, offset: DVec3, length: f64, radius: f64) -> bool {
        if length <= radius {
            return true;
        }
        // cos(φ - α): the angle φ from the axis less the angle α that the two radii subtend.
        let cosine = -self.axis.dot(offset) / length;
        let sin_subtended = radius / length;
        let cos_subtended = (1.0 - sin_subtended * sin_subtended).sqrt();
        let sine = (1.0 - cosine * cosine).max(0.0).sqrt();
        cosine >= cos_subtended || cosine * cos_subtended + sine * sin_subtended >= self.cos_half_angle
    }
}

/// A sphere that holds some surface points, and a cone that holds their normals. Of the cone's half angle it keeps
/// cosine and sine: the choice of lights asks for nothing else, for many lights each time.
#[derive(Clone, Copy, Debug)]
pub struct ReceiverBounds {
    /// The center of the sphere, with the axis of the cone as its normals.
    pub(super) center: SurfacePoint,
    /// m.
    radius: f64,
    cos_half_angle: f64,
    sin_half_angle: f64,
}

impl ReceiverBounds {
    /// The bounds of one point.
    pub fn point(at: &SurfacePoint) -> ReceiverBounds {
        ReceiverBounds { center: *at, radius: 0.0, cos_half_angle: 1.0, sin_half_angle: 0.0 }
    }

    /// The bounds of these points; none if there are none.
    pub fn around(points: &[SurfacePoint]) -> Option<ReceiverBounds> {
        let first = points.first()?;
        let start = (DVec3::INFINITY, DVec3::NEG_INFINITY, DVec3::ZERO);
        let (low, high, sum) = points
            .iter()
            .fold(start, |(low, high, sum), p| (low.min(p.position), high.max(p.position), sum + p.normal));
        let normal = sum.try_normalize().unwrap_or(first.normal);
        let position = low + 0.5 * (high - low);
        let radius = points.iter().map(|p| p.position.distance(position)).fold(0.0, f64::max);
        // Rounding must leave no normal outside.
        let cosine = (points.iter().map(|p| p.normal.dot(normal)).fold(1.0, f64::min) - 1e-9).max(-1.0);
        let center = SurfacePoint { position, normal, geometric_normal: normal, ..*first };
        let sine = (1.0 - cosine * cosine).sqrt();
        Some(ReceiverBounds { center, radius, cos_half_angle: cosine, sin_half_angle: sine })
    }

    /// The largest cosine between a normal of the cone and a direction whose cosine with the axis is `cosine`.
    fn max_cosine(&self, cosine: f64) -> f64 {
        if cosine >= self.cos_half_angle {
            return 1.0;
        }
        cosine * self.cos_half_angle + (1.0 - cosine * cosine).max(0.0).sqrt() * self.sin_half_angle
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::{Purpose, Stream};

    /// No normal has a larger cosine with a direction than the bound, and all points lie within the sphere.
    /// Planted: the spread left out; the cone of the mean of the first two normals.
    #[test]
    fn receivers_hold_their_points_and_normals() {
        let stream = Stream::new(6, Purpose::Surface);
        for index in 0..2000 {
            let item = stream.item(index);
            let vector = |d: u64| DVec3::from_array([0, 1, 2].map(|k| 2.0 * item.uniform(3 * d + k) - 1.0));
            let size = 4.0 * item.uniform(100);
            let point = |k: u64| {
                let normal = (DVec3::Y + size * vector(2 * k)).normalize();
                SurfacePoint::smooth(vector(2 * k + 1), normal, normal, 0, 0)
            };
            let points: Vec<SurfacePoint> = (0..5).map(point).collect();
            let receiver = ReceiverBounds::around(&points).expect("points");
            let direction = vector(20).normalize();
            let max = receiver.max_cosine(receiver.center.normal.dot(direction));
            for p in &points {
                assert!(p.normal.dot(direction) <= max, "{index}: {} {max}", p.normal.dot(direction));
                assert!(p.position.distance(receiver.center.position) <= receiver.radius);
            }
        }
        assert!(ReceiverBounds::around(&[]).is_none());
    }
}

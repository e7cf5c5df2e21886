//! Bounds of one light or of many: where they are and what they can send.

use super::{direction_cone::DirectionCone, receiver::ReceiverBounds};
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
    /// Bounds of a light at one point that shines into all directions.
    pub fn point(position: DVec3, intensity: f64) -> LightBounds {
        let cone = DirectionCone::SPHERE;
        LightBounds { low: position, high: position, intensity, cone, range: f64::INFINITY }
    }

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

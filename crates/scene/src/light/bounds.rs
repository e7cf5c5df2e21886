//! Where lights are and what they can send, one or many of them.

use super::receiver::ReceiverBounds;
use glam::DVec3;
use std::f64::consts::PI;

/// What is nearer than so many radii is near.
const NEAR: f64 = 3.0;

/// Bounds of lights that are not infinitely far away.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LightBounds {
    /// Box around them, m.
    pub low: DVec3,
    pub high: DVec3,
    /// Radiant intensity, all channels, W/sr.
    pub intensity: f64,
    /// Unit vector that they shine along, and how far from it they shine at most, radians.
    pub axis: DVec3,
    pub reach: f64,
    /// Distance beyond which they give nothing, m.
    pub range: f64,
}

impl LightBounds {
    /// A light at one place that shines to all sides.
    pub fn point(position: DVec3, intensity: f64) -> LightBounds {
        LightBounds { low: position, high: position, intensity, axis: DVec3::Z, reach: PI, range: f64::INFINITY }
    }

    pub fn centre(&self) -> DVec3 {
        self.low + 0.5 * (self.high - self.low)
    }

    /// The bounds of both.
    pub fn join(&self, other: &LightBounds) -> LightBounds {
        let (axis, reach) = join_cones((self.axis, self.reach), (other.axis, other.reach));
        LightBounds {
            low: self.low.min(other.low),
            high: self.high.max(other.high),
            intensity: self.intensity + other.intensity,
            axis,
            reach,
            range: self.range.max(other.range),
        }
    }
}

/// A cone around two cones, each an axis and an angle from it.
fn join_cones(a: (DVec3, f64), b: (DVec3, f64)) -> (DVec3, f64) {
    let (wide, narrow) = if a.1 >= b.1 { (a, b) } else { (b, a) };
    let between = wide.0.angle_between(narrow.0);
    if between + narrow.1 <= wide.1 {
        return wide;
    }
    let angle = 0.5 * (wide.1 + between + narrow.1);
    let across = (narrow.0 - wide.0 * narrow.0.dot(wide.0)).try_normalize();
    // Opposite axes have no direction from one to the other.
    let Some(across) = across.filter(|_| angle < PI) else {
        return (wide.0, PI);
    };
    let (sine, cosine) = (angle - wide.1).sin_cos();
    ((wide.0 * cosine + across * sine).normalize(), angle)
}

/// The bounding sphere of a light's bounds, by which it lights receivers.
#[derive(Clone, Copy, Debug)]
pub(super) struct LightSphere {
    centre: DVec3,
    /// m.
    radius: f64,
    intensity: f64,
    axis: DVec3,
    cos_reach: f64,
    range: f64,
}

impl LightSphere {
    pub fn new(bounds: &LightBounds) -> LightSphere {
        LightSphere {
            centre: bounds.centre(),
            radius: 0.5 * (bounds.high - bounds.low).length(),
            intensity: bounds.intensity,
            axis: bounds.axis,
            // Rounding must not hide what lies on the cone.
            cos_reach: if bounds.reach < PI { (bounds.reach + 1e-6).min(PI).cos() } else { -1.0 },
            range: bounds.range,
        }
    }

    /// Whether points of the receiver and of the sphere are so near to each other that their distances differ much.
    pub fn is_near(&self, region: &ReceiverBounds) -> bool {
        self.centre.distance(region.middle.position) < NEAR * (self.radius + region.radius)
    }

    /// Whether what it sends depends on more than the distance.
    pub fn falls_off(&self) -> bool {
        self.cos_reach > -1.0 || self.range < f64::INFINITY
    }

    /// The light that arrives at the middle of a receiver, as if all of it came from the sphere's centre; and as much with the
    /// largest cosine that any two points can have. The latter is 0 only if no point of the sphere can light one of the
    /// region, W/m².
    pub fn arriving(&self, region: &ReceiverBounds) -> [f64; 2] {
        let offset = self.centre - region.middle.position;
        let length = offset.length();
        let radius = self.radius + region.radius + 1e-9 * length;
        if length - radius > self.range || (self.cos_reach > -1.0 && !self.shines_towards(offset, length, radius)) {
            return [0.0; 2];
        }
        let distance = length.max(radius);
        // Lights in one place, and the point there too: any number will do.
        let square = (distance * distance).max(f64::MIN_POSITIVE);
        let [cosine, most] = if length > radius {
            let cosine = region.middle.normal.dot(offset) / length;
            [cosine.clamp(0.0, 1.0), (region.max_cosine(cosine) + radius / length).clamp(0.0, 1.0)]
        } else {
            [1.0; 2]
        };
        [cosine, most].map(|c| (self.intensity * c / square).min(f64::MAX / 1e9))
    }

    /// Whether points within `radius` of one at `-offset` of the centre may lie in the cone of a light of the sphere.
    fn shines_towards(&self, offset: DVec3, length: f64, radius: f64) -> bool {
        if length <= radius {
            return true;
        }
        // The angle to the centre less that which both fill: cos(φ - α).
        let cosine = -self.axis.dot(offset) / length;
        let filled = radius / length;
        let cos_filled = (1.0 - filled * filled).sqrt();
        cosine >= cos_filled || cosine * cos_filled + (1.0 - cosine * cosine).max(0.0).sqrt() * filled >= self.cos_reach
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::{Item, Purpose, Stream};

    fn direction(item: Item, first: u64) -> DVec3 {
        let at = |k| 2.0 * item.uniform(first + k) - 1.0;
        DVec3::new(at(0), at(1), at(2)).normalize()
    }

    /// Planted: the wider cone returned when the other sticks out; half of the sum of the angles alone.
    #[test]
    fn joined_cones_hold_both() {
        let stream = Stream::new(5, Purpose::Surface);
        for k in 0..20_000 {
            let item = stream.item(k);
            let [a, b] = [0, 4].map(|d| (direction(item, d), PI * item.uniform(d + 3).powi(2)));
            let joined = join_cones(a, b);
            for (axis, angle) in [a, b] {
                assert!((joined.0.angle_between(axis) + angle).min(PI) <= joined.1 + 1e-6, "{a:?} {b:?} {joined:?}");
            }
        }
        assert_eq!(join_cones((DVec3::X, 0.1), (DVec3::NEG_X, 0.1)).1, PI);
    }
}

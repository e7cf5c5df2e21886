//! Bounds of surface points that lights are chosen for together.

use crate::mesh::SurfacePoint;
use glam::DVec3;

/// A sphere that holds some surface points, and a cone that holds their normals. Of the cone's half angle it keeps
/// cosine and sine: the choice of lights asks for nothing else, for many lights each time.
#[derive(Clone, Copy, Debug)]
pub struct ReceiverBounds {
    /// The center of the sphere, with the axis of the cone as its normals.
    pub(super) center: SurfacePoint,
    /// m.
    pub(super) radius: f64,
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
    pub(super) fn max_cosine(&self, cosine: f64) -> f64 {
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
    /// Seen to catch: the spread left out; the cone of the mean of the first two normals.
    #[test]
    fn receivers_hold_their_points_and_normals() {
        let stream = Stream::new(6, Purpose::Surface);
        for index in 0..2000 {
            let item = stream.item(index);
            let vector = |d: u64| DVec3::from_array([0, 1, 2].map(|k| 2.0 * item.uniform(3 * d + k) - 1.0));
            let size = 4.0 * item.uniform(100);
            let point = |k: u64| {
                let normal = (DVec3::Y + size * vector(2 * k)).normalize();
                SurfacePoint { position: vector(2 * k + 1), normal, geometric_normal: normal, triangle: 0, material: 0 }
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

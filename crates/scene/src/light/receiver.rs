//! Points of a surface that lights are chosen for together.

use crate::mesh::SurfacePoint;
use glam::DVec3;

/// A sphere that holds some points, and a cone that holds their normals.
#[derive(Clone, Copy, Debug)]
pub struct ReceiverBounds {
    /// Its middle, as if it were a point of the surface.
    pub(super) middle: SurfacePoint,
    /// m.
    pub(super) radius: f64,
    /// Cosine and sine of the largest angle between a normal and that of the middle.
    spread: [f64; 2],
}

impl ReceiverBounds {
    /// One point.
    pub fn point(at: &SurfacePoint) -> ReceiverBounds {
        ReceiverBounds { middle: *at, radius: 0.0, spread: [1.0, 0.0] }
    }

    /// The region of these points; none if there are none.
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
        let middle = SurfacePoint { position, normal, geometric_normal: normal, ..*first };
        Some(ReceiverBounds { middle, radius, spread: [cosine, (1.0 - cosine * cosine).sqrt()] })
    }

    /// The largest cosine of a normal with a direction that has this one with the middle's.
    pub(super) fn max_cosine(&self, cosine: f64) -> f64 {
        let [cos_spread, sin_spread] = self.spread;
        if cosine >= cos_spread {
            return 1.0;
        }
        cosine * cos_spread + (1.0 - cosine * cosine).max(0.0).sqrt() * sin_spread
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::{Purpose, Stream};

    /// No normal of a region has a larger cosine with a direction than is said, and all points lie within.
    /// Planted: the spread left out; the cone of the mean of the first two normals.
    #[test]
    fn regions_hold_their_points_and_normals() {
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
            let region = ReceiverBounds::around(&points).expect("points");
            let direction = vector(20).normalize();
            let most = region.max_cosine(region.middle.normal.dot(direction));
            for p in &points {
                assert!(p.normal.dot(direction) <= most, "{index}: {} {most}", p.normal.dot(direction));
                assert!(p.position.distance(region.middle.position) <= region.radius);
            }
        }
        assert!(ReceiverBounds::around(&[]).is_none());
    }
}

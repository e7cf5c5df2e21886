//! Points of a surface that lights are chosen for together.

use crate::mesh::SurfacePoint;
use glam::DVec3;

/// A ball that holds some points, and a cone that holds their normals.
#[derive(Clone, Copy, Debug)]
pub struct Region {
    /// Its middle, as if it were a point of the surface.
    pub(super) middle: SurfacePoint,
    /// m.
    pub(super) radius: f64,
    /// Cosine and sine of the largest angle between a normal and that of the middle.
    spread: [f64; 2],
}

impl Region {
    /// One point.
    pub fn point(at: &SurfacePoint) -> Region {
        Region { middle: *at, radius: 0.0, spread: [1.0, 0.0] }
    }

    /// The region of these points; none if there are none.
    pub fn around(points: &[SurfacePoint]) -> Option<Region> {
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
        Some(Region { middle, radius, spread: [cosine, (1.0 - cosine * cosine).sqrt()] })
    }

    /// The largest cosine of a normal with a direction that has this one with the middle's.
    pub(super) fn most_cosine(&self, cosine: f64) -> f64 {
        let [cos_spread, sin_spread] = self.spread;
        if cosine >= cos_spread {
            return 1.0;
        }
        cosine * cos_spread + (1.0 - cosine * cosine).max(0.0).sqrt() * sin_spread
    }
}

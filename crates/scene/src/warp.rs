//! Uniform numbers to points and directions: each routine takes its `xi` and has its density beside it.

use glam::DVec3;
use std::f64::consts::PI;

/// note: [point] Barycentric weights of a uniform point on a triangle (method.md 6.2):
/// `x = (1−√ξ₀) v₀ + (1−ξ₁)√ξ₀ v₁ + ξ₁√ξ₀ v₂`. Its density per area is `1/A`.
pub fn triangle(xi: [f64; 2]) -> [f64; 3] {
    let root = xi[0].sqrt();
    [1.0 - root, (1.0 - xi[1]) * root, xi[1] * root]
}

/// The corners, as barycentric weights, of the piece at `along` in [0, 1) of a curve that fills a triangle: Sierpiński's,
/// which halves the triangle from its third corner to the middle of the opposite edge, `levels` times, and leads from the
/// first corner to the second. All pieces have one area, and what is near on the curve is near on the triangle.
pub fn triangle_piece(along: f64, levels: u32) -> [DVec3; 3] {
    let (mut a, mut b, mut c) = (DVec3::X, DVec3::Y, DVec3::Z);
    let mut rest = along;
    for _ in 0..levels {
        let middle = (a + b) * 0.5;
        rest *= 2.0;
        if rest < 1.0 {
            (b, c) = (c, middle);
        } else {
            rest -= 1.0;
            (a, c) = (c, middle);
        }
    }
    [a, b, c]
}

/// The numbers that [`triangle`] maps to these weights.
pub fn triangle_inverse(weights: [f64; 3]) -> [f64; 2] {
    let root = weights[1] + weights[2];
    [root * root, if root > 0.0 { weights[2] / root } else { 0.0 }]
}

/// Cosine-distributed unit direction about the unit `normal`; its density per solid angle is
/// [`cosine_hemisphere_pdf_solid_angle`].
pub fn cosine_hemisphere(normal: DVec3, xi: [f64; 2]) -> DVec3 {
    let radius = xi[0].sqrt();
    let (sine, cosine) = (2.0 * PI * xi[1]).sin_cos();
    let (tangent, bitangent) = normal.any_orthonormal_pair();
    let height = (1.0 - xi[0]).sqrt();
    (tangent * (radius * cosine) + bitangent * (radius * sine) + normal * height).normalize()
}

/// `cos θ/π`, 1/sr.
pub fn cosine_hemisphere_pdf_solid_angle(cosine: f64) -> f64 {
    cosine.max(0.0) / PI
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn triangle_map_is_inverted() {
        for xi in [[0.25, 0.5], [0.9, 0.1], [1e-8, 0.7]] {
            let back = triangle_inverse(triangle(xi));
            assert!((back[0] - xi[0]).abs() < 1e-9 && (back[1] - xi[1]).abs() < 1e-7);
        }
    }

    /// Planted: pieces in the wrong order leave a jump, a lost half leaves an empty place.
    #[test]
    fn the_curve_is_continuous_and_fills_the_triangle_evenly() {
        let levels = 12;
        let n = 1 << levels;
        let points: Vec<DVec3> = (0..n)
            .map(|k| triangle_piece((f64::from(k) + 0.5) / f64::from(n), levels))
            .map(|[a, b, c]| (a + b + c) / 3.0)
            .collect();
        // Pieces of area 2^-12 of a triangle with edges √2: neighbours are within twice their diameter.
        assert!(points.windows(2).all(|p| (p[1] - p[0]).length() < 0.07));
        let mean: DVec3 = points.iter().sum::<DVec3>() / f64::from(n);
        assert!((mean - DVec3::splat(1.0 / 3.0)).length() < 1e-3);
        let corner = points.iter().filter(|p| p.x > 0.5).count();
        assert!((corner as f64 / f64::from(n) - 0.25).abs() < 2e-3);
        assert!(points.iter().all(|p| p.min_element() >= 0.0 && (p.element_sum() - 1.0).abs() < 1e-12));
    }

    #[test]
    fn cosine_directions_have_the_mean_cosine_two_thirds() {
        let normal = DVec3::new(0.6, 0.0, -0.8);
        let n = 100;
        let grid = |k: usize| (k as f64 + 0.5) / n as f64;
        let mean: f64 =
            (0..n * n).map(|k| cosine_hemisphere(normal, [grid(k / n), grid(k % n)]).dot(normal)).sum::<f64>()
                / (n * n) as f64;
        assert!((mean - 2.0 / 3.0).abs() < 1e-4);
    }
}

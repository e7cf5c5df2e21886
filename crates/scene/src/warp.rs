//! Uniform numbers to points and directions: each routine takes its `xi` and has its density beside it.

use glam::DVec3;
use std::f64::consts::PI;

/// note: [point] Barycentric weights of a uniform point on a triangle (method.md 6.2):
/// `x = (1−√ξ₀) v₀ + (1−ξ₁)√ξ₀ v₁ + ξ₁√ξ₀ v₂`. Its density per area is `1/A`.
pub fn triangle(xi: [f64; 2]) -> [f64; 3] {
    let root = xi[0].sqrt();
    [1.0 - root, (1.0 - xi[1]) * root, xi[1] * root]
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

//! Maps of uniform numbers `xi` to points and directions, each with its density.
//!
//! ```
//! let weights = scene::warp::triangle([0.25, 0.5]);
//! assert_eq!(weights, [0.5, 0.25, 0.25]);
//! ```

use glam::DVec3;
use std::f64::consts::PI;

/// Barycentric weights of a uniform point on a triangle (docs/method.md 6.2):
/// `x = (1−√ξ₀) v₀ + (1−ξ₁)√ξ₀ v₁ + ξ₁√ξ₀ v₂`. Its density per area is `1/A`.
// note: [point]
pub fn triangle(xi: [f64; 2]) -> [f64; 3] {
    let root = xi[0].sqrt();
    [1.0 - root, (1.0 - xi[1]) * root, xi[1] * root]
}

/// A point `[x, y]` of the unit square, which is cut from (1, 0) to (0, 1) into two triangles, and whether it lies in
/// the second one. Points are uniform in each triangle, and each gets its share of them; `x` grows with the first
/// number, and at each `x`, `y` grows with the second. With a share of 0 the second triangle is empty.
pub fn halved_square(xi: [f64; 2], shares: [f64; 2]) -> ([f64; 2], bool) {
    // The column at x holds 2 s₀ (1−x) + 2 s₁ x, so with q = (s₁−s₀)/(s₀+s₁) its integral q x² + (1−q) x is ξ₀.
    let total = shares[0] + shares[1];
    let q = (shares[1] - shares[0]) / total;
    let p = 1.0 - q;
    let x = (2.0 * xi[0] / (p + (p * p + 4.0 * q * xi[0]).max(0.0).sqrt())).min(1.0);
    let (first, second) = (shares[0] * (1.0 - x), shares[1] * x);
    let cut = first / (first + second);
    if xi[1] < cut || second == 0.0 {
        ([x, xi[1] / cut * (1.0 - x)], false)
    } else {
        ([x, 1.0 - x + (xi[1] - cut) / (1.0 - cut) * x], true)
    }
}

/// A uniform point of the unit disc; its density per area is `1/π`. Squares about the middle of the unit square become
/// circles, so that points which are spread evenly stay so (Shirley and Chiu 1997).
pub fn disk(xi: [f64; 2]) -> [f64; 2] {
    let [x, y] = xi.map(|u| 2.0 * u - 1.0);
    let (radius, angle) = match (x == 0.0 && y == 0.0, x.abs() > y.abs()) {
        (true, _) => return [0.0; 2],
        (_, true) => (x, 0.25 * PI * (y / x)),
        (_, false) => (y, PI * (0.5 - 0.25 * (x / y))),
    };
    let (sine, cosine) = angle.sin_cos();
    [radius * cosine, radius * sine]
}

/// Cosine-distributed unit direction about the unit `normal`; its density per solid angle is
/// [`cosine_hemisphere_pdf_solid_angle`].
pub fn cosine_hemisphere(normal: DVec3, xi: [f64; 2]) -> DVec3 {
    let (tangent, bitangent) = normal.any_orthonormal_pair();
    cosine_hemisphere_in([tangent, bitangent, normal], xi)
}

/// Cosine-distributed unit direction about the last of three orthonormal vectors.
pub fn cosine_hemisphere_in([tangent, bitangent, normal]: [DVec3; 3], xi: [f64; 2]) -> DVec3 {
    let radius = xi[0].sqrt();
    let (sine, cosine) = (2.0 * PI * xi[1]).sin_cos();
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

    /// Of a uniform point of the disc `r²` is uniform, and no side is preferred.
    ///
    /// Seen to catch: a radius that is uniform; the square cut along one diagonal only.
    #[test]
    fn the_disc_is_covered_evenly() {
        let n = 400;
        let grid = |k: usize| (k as f64 + 0.5) / n as f64;
        let points: Vec<[f64; 2]> = (0..n * n).map(|k| disk([grid(k / n), grid(k % n)])).collect();
        let mean = |f: &dyn Fn(f64, f64) -> f64| points.iter().map(|[x, y]| f(*x, *y)).sum::<f64>() / (n * n) as f64;
        for share in [0.1, 0.5, 0.9, 1.0] {
            let within = mean(&|x, y| f64::from(u8::from(x * x + y * y <= share)));
            assert!((within - share).abs() < 5e-3, "{share}: {within}");
        }
        for (turn, second) in [(0.0f64, 0.25), (0.3, 0.25), (0.785, 0.25)] {
            let (sine, cosine) = turn.sin_cos();
            assert!((mean(&|x, y| (cosine * x + sine * y).powi(2)) - second).abs() < 1e-3);
            assert!(mean(&|x, y| cosine * x + sine * y).abs() < 1e-12);
        }
        assert_eq!(disk([0.5; 2]), [0.0; 2]);
    }

    /// Seen to catch: shares exchanged; a column cut in the middle.
    #[test]
    fn the_halves_of_the_square_are_covered_evenly_and_by_their_shares() {
        let n = 400;
        let grid = |k: usize| (k as f64 + 0.5) / n as f64;
        for shares in [[1.0, 1.0], [1.0, 3.0], [5.0, 1.0], [2.0, 0.0], [0.0, 2.0]] {
            let points: Vec<_> = (0..n * n).map(|k| halved_square([grid(k / n), grid(k % n)], shares)).collect();
            let side = |beyond: bool| if beyond { 1.0 } else { -1.0 };
            assert!(points.iter().all(|([x, y], beyond)| (x + y - 1.0) * side(*beyond) > -1e-12 && x.max(*y) <= 1.0));
            let total = shares[0] + shares[1];
            for (half, side) in [(false, 0.0), (true, 1.0)] {
                let own: Vec<[f64; 2]> = points.iter().filter(|p| p.1 == half).map(|p| p.0).collect();
                let share = shares[usize::from(half)] / total;
                assert!((own.len() as f64 / points.len() as f64 - share).abs() < 2e-3, "{shares:?}: {}", own.len());
                if share > 0.0 {
                    // A triangle of legs 1 has its centroid at 1/3 of them and the second moments 1/6 about the corner.
                    let mean = |f: &dyn Fn(f64, f64) -> f64| {
                        let sum: f64 = own.iter().map(|[x, y]| f((side - x).abs(), (side - y).abs())).sum();
                        sum / own.len() as f64
                    };
                    assert!((mean(&|x, _| x) - 1.0 / 3.0).abs() < 2e-3 && (mean(&|_, y| y) - 1.0 / 3.0).abs() < 2e-3);
                    assert!((mean(&|x, _| x * x) - 1.0 / 6.0).abs() < 2e-3);
                    assert!((mean(&|x, y| x * y) - 1.0 / 12.0).abs() < 2e-3);
                }
            }
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

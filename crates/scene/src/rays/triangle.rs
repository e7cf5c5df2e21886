//! The triangle test in float64, and the four triangles of a leaf.

use glam::{DVec3, Vec3};
use std::array::from_fn;

/// The least weight of a corner. A ray that starts on an edge itself would cross the neighbor there or not, as rounding
/// has it: so far off the edge, ten thousand rounding steps, it is on one side of the neighbor.
const MIN_WEIGHT: f64 = 1e-12;

/// The triangles of a leaf: up to four.
#[repr(align(32))]
pub(super) struct Leaf {
    /// The corners, by axis, then corner, then triangle. Lanes without a triangle hold a point, which no ray meets.
    pub corners: [[[f32; 4]; 3]; 3],
    /// Indices of the triangles in the mesh.
    pub triangles: [u32; 4],
}

/// A ray sheared so that it runs along the axis of its largest component: the triangle test is then two-dimensional.
pub(super) struct TriangleTest {
    /// The two other axes, then this one; the components below are in the same order.
    pub axes: [usize; 3],
    pub origin: [f64; 3],
    pub shear: [f64; 3],
}

/// Where the line of a ray meets the planes of the triangles of a leaf.
pub(super) struct Crossings {
    /// Distances along the ray, of any sign.
    pub distances: [f64; 4],
    /// Twice the areas opposite the corners, as seen along the axis: by corner, then triangle.
    pub areas: [[f64; 4]; 3],
}

impl Leaf {
    /// Holds one to four triangles; `corners` gives the corners of each.
    pub fn new(triangles: &[u32], corners: impl Fn(u32) -> [Vec3; 3]) -> Leaf {
        let triangle = |lane: usize| triangles.get(lane).copied().unwrap_or(triangles[0]);
        let lanes: [[Vec3; 3]; 4] = from_fn(|lane| {
            let [a, b, c] = corners(triangle(lane));
            if lane < triangles.len() { [a, b, c] } else { [a; 3] }
        });
        let corners = from_fn(|axis| from_fn(|corner| from_fn(|lane| lanes[lane][corner][axis])));
        Leaf { corners, triangles: from_fn(triangle) }
    }

    /// The corners of one of the triangles.
    pub fn triangle(&self, lane: usize) -> [DVec3; 3] {
        from_fn(|corner| DVec3::from_array(from_fn(|axis| f64::from(self.corners[axis][corner][lane]))))
    }
}

impl TriangleTest {
    #[inline(always)]
    pub fn new(origin: DVec3, direction: DVec3) -> Self {
        let [x, y, z] = direction.abs().to_array();
        // Without branches, which no processor could predict.
        let along_z = usize::from((z > x) & (z > y));
        let along_y = usize::from(y > x) & !along_z;
        let along = 2 * along_z + along_y;
        let axes = [(along + 1) % 3, (along + 2) % 3, along];
        let [x, y, z] = axes.map(|axis| direction[axis]);
        TriangleTest { axes, origin: axes.map(|axis| origin[axis]), shear: [x / z, y / z, 1.0 / z] }
    }

    /// The crossings with the triangles, and the bits of those that the ray meets from its start up to `limit`, edges
    /// and corners included. A triangle that is seen edge-on is not met.
    #[inline(always)]
    pub fn crossings(&self, leaf: &Leaf, limit: f64) -> (Crossings, u32) {
        let mut crossings = Crossings { distances: [0.0; 4], areas: [[0.0; 4]; 3] };
        let mut met = 0;
        for lane in 0..4 {
            let corners = self.sheared(leaf, lane);
            let areas = areas(&corners);
            let [u, v, w] = areas;
            let [a, b, c] = corners.map(|corner| corner[2]);
            let distance = self.shear[2] * ((u * a + v * b + w * c) / (u + v + w));
            let crosses = areas.iter().any(|x| *x < 0.0) != areas.iter().any(|x| *x > 0.0);
            met |= u32::from(crosses && 0.0 <= distance && distance <= limit) << lane;
            crossings.distances[lane] = distance;
            (0..3).for_each(|corner| crossings.areas[corner][lane] = areas[corner]);
        }
        (crossings, met)
    }

    #[inline(always)]
    fn sheared(&self, leaf: &Leaf, lane: usize) -> [[f64; 3]; 3] {
        from_fn(|corner| {
            let [x, y, z] = from_fn(|k| f64::from(leaf.corners[self.axes[k]][corner][lane]) - self.origin[k]);
            [x - self.shear[0] * z, y - self.shear[1] * z, z]
        })
    }
}

/// Rounding keeps the order of the two products: a sign is never wrong, at worst the area is zero.
#[inline(always)]
fn areas([a, b, c]: &[[f64; 3]; 3]) -> [f64; 3] {
    [c[0] * b[1] - c[1] * b[0], a[0] * c[1] - a[1] * c[0], b[0] * a[1] - b[1] * a[0]]
}

impl Crossings {
    /// Barycentric weights of the point where a triangle is met, moved off its edges by [`MIN_WEIGHT`].
    #[inline(always)]
    pub fn weights(&self, lane: usize) -> [f64; 3] {
        let areas = self.areas.map(|areas| areas[lane]);
        let sum = areas.iter().sum::<f64>();
        let weights = areas.map(|area| area / sum);
        if weights.iter().all(|weight| *weight >= MIN_WEIGHT) { weights } else { off_the_edges(weights) }
    }
}

#[cold]
#[inline(never)]
fn off_the_edges(weights: [f64; 3]) -> [f64; 3] {
    let weights = weights.map(|weight| weight.max(MIN_WEIGHT));
    let sum = weights.iter().sum::<f64>();
    weights.map(|weight| weight / sum)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Seen to catch: z taken where it is larger than x alone.
    #[test]
    fn rays_are_sheared_along_their_largest_component() {
        for k in 0..5 * 5 * 5 {
            let component = |place: i32| f64::from(k / place % 5 - 2);
            let direction = DVec3::new(component(1), component(5), component(25));
            if direction == DVec3::ZERO {
                continue;
            }
            let TriangleTest { axes, origin, shear } = TriangleTest::new(DVec3::new(7.0, 8.0, 9.0), direction);
            let along = axes[2];
            assert_eq!(direction[along].abs(), direction.abs().max_element(), "{direction}");
            assert_eq!([axes[0], axes[1]], [(along + 1) % 3, (along + 2) % 3]);
            assert_eq!(origin, axes.map(|axis| 7.0 + axis as f64));
            assert_eq!(shear, [direction[axes[0]], direction[axes[1]], 1.0].map(|x| x / direction[along]));
        }
    }
}

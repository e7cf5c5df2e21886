//! The triangle test in float64, and the four triangles of a leaf.

use glam::{DVec3, Vec3};
use std::array::from_fn;

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

/// Where a ray meets the plane of a triangle, within it.
pub(super) struct Crossing {
    /// Distance along the ray, of any sign.
    pub distance: f64,
    /// Twice the areas opposite the corners, as seen along the axis; no two have opposite signs.
    areas: [f64; 3],
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
        let axes = if z > x && z > y {
            [0, 1, 2]
        } else if y > x {
            [2, 0, 1]
        } else {
            [1, 2, 0]
        };
        let [x, y, z] = axes.map(|axis| direction[axis]);
        TriangleTest { axes, origin: axes.map(|axis| origin[axis]), shear: [x / z, y / z, 1.0 / z] }
    }

    /// Whether the line of the ray meets a triangle, edges and corners included. One seen edge-on is not met.
    #[inline(always)]
    pub fn meets(&self, leaf: &Leaf, lane: usize) -> bool {
        let areas = areas(&self.sheared(leaf, lane));
        areas.iter().any(|x| *x < 0.0) != areas.iter().any(|x| *x > 0.0)
    }

    /// The crossing with a triangle that is met.
    #[inline(always)]
    pub fn crossing(&self, leaf: &Leaf, lane: usize) -> Crossing {
        let corners = self.sheared(leaf, lane);
        let areas = areas(&corners);
        let [u, v, w] = areas;
        let [a, b, c] = corners.map(|corner| corner[2]);
        Crossing { distance: self.shear[2] * ((u * a + v * b + w * c) / (u + v + w)), areas }
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

impl Crossing {
    /// Barycentric weights.
    #[inline(always)]
    pub fn weights(&self) -> [f64; 3] {
        let sum = self.areas.iter().sum::<f64>();
        self.areas.map(|area| area / sum)
    }
}

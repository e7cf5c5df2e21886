//! The triangle test in float64.

use glam::{DVec3, Vec3};

/// A ray sheared so that it runs along one axis: the triangle test is then two-dimensional. The axis is the one along
/// which the ray's direction is largest; it is known when this is compiled, so that no component is looked up.
pub(super) struct TriangleTest<const AXIS: usize> {
    /// Components along the two other axes, then along this one.
    origin: [f64; 3],
    shear: [f64; 3],
}

/// Where a ray meets the plane of a triangle, within it.
pub(super) struct Crossing {
    /// Of any sign.
    pub distance: f64,
    /// Twice the areas opposite the corners, as seen along the axis; all of one sign.
    areas: [f64; 3],
}

impl<const AXIS: usize> TriangleTest<AXIS> {
    const OTHERS: [usize; 2] = [(AXIS + 1) % 3, (AXIS + 2) % 3];

    pub fn new(origin: DVec3, direction: DVec3) -> Self {
        let [x, y] = Self::OTHERS;
        let along = direction[AXIS];
        TriangleTest {
            origin: [origin[x], origin[y], origin[AXIS]],
            shear: [direction[x] / along, direction[y] / along, 1.0 / along],
        }
    }

    /// The crossing, edges and corners included.
    #[inline(always)]
    pub fn intersect(&self, corners: &[Vec3; 3]) -> Option<Crossing> {
        let [x, y] = Self::OTHERS;
        let [a, b, c] = corners.map(|corner| {
            let v = corner.to_array();
            let z = f64::from(v[AXIS]) - self.origin[2];
            let sheared = |k: usize, i: usize| f64::from(v[k]) - self.origin[i] - self.shear[i] * z;
            [sheared(x, 0), sheared(y, 1), z]
        });
        // Rounding keeps the order of the two products: none of the signs is ever wrong, at worst it is zero.
        let u = c[0] * b[1] - c[1] * b[0];
        let v = a[0] * c[1] - a[1] * c[0];
        let w = b[0] * a[1] - b[1] * a[0];
        if u.min(v).min(w) < 0.0 && u.max(v).max(w) > 0.0 {
            return None;
        }
        let sum = u + v + w;
        if sum == 0.0 {
            return None; // seen edge-on
        }
        let distance = self.shear[2] * ((u * a[2] + v * b[2] + w * c[2]) / sum);
        Some(Crossing { distance, areas: [u, v, w] })
    }
}

impl Crossing {
    /// Barycentric weights.
    pub fn weights(&self) -> [f64; 3] {
        let sum = self.areas.iter().sum::<f64>();
        self.areas.map(|area| area / sum)
    }
}

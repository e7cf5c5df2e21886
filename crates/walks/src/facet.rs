//! Triangles with a beam of light below them.

use glam::DVec3;

/// A triangle that sends a beam into the medium: it lets the light in, or reflects a beam inside.
pub struct Facet {
    pub triangle: u32,
    /// Unit direction of the light below it, or about the middle of the directions of a point's light.
    pub direction: DVec3,
    /// The angle by which the light of a point may differ from that direction.
    pub turn: f64,
    /// The fluence just below it, without extinction, W/m²; in the middle for a point.
    pub fluence: DVec3,
    /// How far its light came inside at least, m.
    pub depth: f64,
    /// The facet whose beam it reflects.
    pub parent: Option<u32>,
    /// How parallel light finds it.
    pub parallel: Parallel,
}

/// Affine functions of a point: the distance along parallel light to a triangle, m, and two barycentric weights of the
/// crossing. Points are measured from the triangle's first corner.
#[derive(Clone, Copy)]
pub struct Parallel {
    pub corner: DVec3,
    distance: DVec3,
    weights: [DVec3; 2],
}

impl Parallel {
    /// For light of this direction.
    pub fn new([a, b, c]: [DVec3; 3], direction: DVec3) -> Parallel {
        let (ab, ac) = (b - a, c - a);
        let normal = ab.cross(ac);
        // Along the light, a point p falls on a + v ab + w ac: by Cramer's rule for p − a = v ab + w ac + s direction.
        let volume = normal.dot(direction);
        Parallel {
            corner: a,
            distance: normal / volume,
            weights: [ac.cross(direction) / volume, direction.cross(ab) / volume],
        }
    }

    /// Distance and barycentric weights.
    #[inline(always)]
    pub fn meets(&self, position: DVec3) -> Option<(f64, [f64; 3])> {
        let offset = position - self.corner;
        let [v, w] = self.weights.map(|row| row.dot(offset));
        let distance = self.distance(position);
        (v >= 0.0 && w >= 0.0 && v + w <= 1.0 && distance > 0.0).then_some((distance, [1.0 - v - w, v, w]))
    }

    /// Distance from the triangle's plane along the light, m.
    #[inline(always)]
    pub fn distance(&self, position: DVec3) -> f64 {
        self.distance.dot(position - self.corner)
    }
}

/// The weights of [`Parallel`] in float32, in one line of the processor's cache: most facets are passed over by them.
#[repr(align(64))]
pub struct Shadow {
    corner: [f32; 3],
    weights: [[f32; 3]; 2],
    /// What rounding and the spread of the light may do to a weight.
    margin: f32,
}

impl Shadow {
    /// For points at most `extent` from the triangle, whose light may miss its mean direction by `spread` there, m.
    pub fn new(parallel: &Parallel, extent: f64, spread: f64) -> Shadow {
        let largest = parallel.weights.iter().map(|row| row.length()).fold(0.0, f64::max);
        let rounding = 16.0 * f64::from(f32::EPSILON) * (extent + parallel.corner.length());
        Shadow {
            corner: parallel.corner.as_vec3().to_array(),
            weights: parallel.weights.map(|row| row.as_vec3().to_array()),
            margin: (largest * (spread + rounding)) as f32,
        }
    }

    /// True if light from the facet certainly does not arrive at a point.
    #[inline(always)]
    pub fn misses(&self, position: DVec3) -> bool {
        let p = position.as_vec3().to_array();
        let [x, y, z] = [p[0] - self.corner[0], p[1] - self.corner[1], p[2] - self.corner[2]];
        let [v, w] = self.weights.map(|row| row[0] * x + row[1] * y + row[2] * z);
        v < -self.margin || w < -self.margin || v + w > 1.0 + self.margin
    }
}

/// Distance and barycentric weights at which a ray meets a triangle (Möller and Trumbore 1997).
#[inline(always)]
pub fn meets(origin: DVec3, direction: DVec3, [a, b, c]: [DVec3; 3]) -> Option<(f64, [f64; 3])> {
    let (ab, ac, offset) = (b - a, c - a, origin - a);
    let across = direction.cross(ac);
    let inverse = 1.0 / ab.dot(across);
    let v = offset.dot(across) * inverse;
    let normal = offset.cross(ab);
    let w = direction.dot(normal) * inverse;
    let distance = ac.dot(normal) * inverse;
    (v >= 0.0 && w >= 0.0 && v + w <= 1.0 && distance > 0.0).then_some((distance, [1.0 - v - w, v, w]))
}

/// A direction mirrored in a plane with this unit normal.
#[inline(always)]
pub fn mirrored(direction: DVec3, normal: DVec3) -> DVec3 {
    direction - 2.0 * direction.dot(normal) * normal
}

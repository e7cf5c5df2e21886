//! Triangles: normals, areas, interpolation.

use glam::{DVec3, Vec3};

/// A triangle by vertex indices, wound counter-clockwise seen from outside.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Triangle {
    pub vertices: [u32; 3],
    /// Index into the scene's materials.
    pub material: u16,
}

/// Vertices and triangles in metres, relative to the scene's origin.
#[derive(Clone, Debug, Default)]
pub struct Mesh {
    pub positions: Vec<Vec3>,
    /// Unit normals, or zero where the file has none: the triangle's own normal is meant then.
    pub normals: Vec<Vec3>,
    pub triangles: Vec<Triangle>,
}

/// Which normal shading uses.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NormalKind {
    /// Interpolated from the vertices.
    Shading,
    /// The triangle's, as in the note.
    Geometric,
}

/// A point on the surface.
#[derive(Clone, Copy, Debug)]
pub struct SurfacePoint {
    /// m, relative to the scene's origin.
    pub position: DVec3,
    /// Unit normal that cosines are taken with.
    pub normal: DVec3,
    /// Unit normal of the triangle.
    pub geometric_normal: DVec3,
    pub triangle: u32,
    pub material: u16,
}

impl Mesh {
    /// The corners of a triangle, m.
    pub fn corners(&self, triangle: usize) -> [DVec3; 3] {
        self.triangles[triangle].vertices.map(|i| self.positions[i as usize].as_dvec3())
    }

    /// note: [area] `A_j = ½ ‖(v₁−v₀) × (v₂−v₀)‖`, m².
    pub fn area(&self, triangle: usize) -> f64 {
        let [a, b, c] = self.corners(triangle);
        0.5 * (b - a).cross(c - a).length()
    }

    /// The point with barycentric `weights` on a triangle.
    pub fn point(&self, triangle: u32, weights: [f64; 3], kind: NormalKind) -> SurfacePoint {
        let index = triangle as usize;
        let [a, b, c] = self.corners(index);
        // note: [normal] counter-clockwise winding, outward.
        let geometric_normal = unit((b - a).cross(c - a));
        let normal = match kind {
            NormalKind::Geometric => geometric_normal,
            NormalKind::Shading => self.interpolated_normal(index, weights).unwrap_or(geometric_normal),
        };
        SurfacePoint {
            position: a * weights[0] + b * weights[1] + c * weights[2],
            normal,
            geometric_normal,
            triangle,
            material: self.triangles[index].material,
        }
    }

    /// The interpolated vertex normal; none where the vertices have none or cancel.
    fn interpolated_normal(&self, triangle: usize, weights: [f64; 3]) -> Option<DVec3> {
        let [a, b, c] = self.triangles[triangle].vertices.map(|i| self.normals[i as usize].as_dvec3());
        let sum = a * weights[0] + b * weights[1] + c * weights[2];
        (sum.length_squared() > 1e-12).then(|| sum.normalize())
    }

    /// Smallest and largest coordinates of the triangles, m.
    pub fn bounds(&self) -> (DVec3, DVec3) {
        let start = (Vec3::INFINITY, Vec3::NEG_INFINITY);
        let corners = self.triangles.iter().flat_map(|t| t.vertices.map(|i| self.positions[i as usize]));
        let (low, high) = corners.fold(start, |(low, high), p| (low.min(p), high.max(p)));
        (low.as_dvec3(), high.as_dvec3())
    }

    /// Length of the diagonal of the bounding box, m.
    pub fn diagonal(&self) -> f64 {
        let (low, high) = self.bounds();
        (high - low).length()
    }
}

/// `v/‖v‖` without the underflow that squaring a tiny triangle's cross product brings.
pub(crate) fn unit(v: DVec3) -> DVec3 {
    let largest = v.abs().max_element();
    (v / largest).normalize()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn area_and_normal_of_a_right_triangle() {
        let mesh = Mesh {
            positions: vec![Vec3::ZERO, Vec3::new(3.0, 0.0, 0.0), Vec3::new(0.0, 4.0, 0.0)],
            normals: vec![Vec3::ZERO; 3],
            triangles: vec![Triangle { vertices: [0, 1, 2], material: 0 }],
        };
        assert_eq!(mesh.area(0), 6.0);
        let point = mesh.point(0, [0.2, 0.3, 0.5], NormalKind::Shading);
        assert_eq!(point.normal, DVec3::Z);
        assert!((point.position - DVec3::new(0.9, 2.0, 0.0)).length() < 1e-15);
    }
}

//! Triangles: normals, areas, interpolation.

use crate::bumps::{Bump, Bumps, Place};
use glam::{DVec2, DVec3, DVec4, Vec3};
use std::ops::{Add, Mul};

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
    /// Unit normals, or zero where the file has none and the triangle's own normal is used.
    pub normals: Vec<Vec3>,
    pub triangles: Vec<Triangle>,
    /// Texture coordinates of the base color, in its picture; empty if no vertex has any.
    pub coordinates: Vec<[f32; 2]>,
    /// The same of emission; empty if no vertex has any.
    pub emission_coordinates: Vec<[f32; 2]>,
    /// The same of metallic and roughness; empty if no vertex has any.
    pub gloss_coordinates: Vec<[f32; 2]>,
    /// The same of the shares of light that thin walls scatter, and of its colors; empty if no vertex has any.
    pub scatter_coordinates: [Vec<[f32; 2]>; 2],
    /// Linear red, green and blue, and alpha; empty if no vertex has any.
    pub colors: Vec<[f32; 4]>,
    /// The normal maps of materials, if there are any.
    pub bumps: Option<Box<Bumps>>,
}

/// The normal that cosines are taken with.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NormalKind {
    /// Interpolated from the vertices, and tilted by normal maps.
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
    /// The same without normal maps.
    pub smooth_normal: DVec3,
    /// The bumps of a normal map.
    pub bump: Bump,
    /// Unit normal of the triangle.
    pub geometric_normal: DVec3,
    pub triangle: u32,
    pub material: u16,
}

impl SurfacePoint {
    /// A point of a smooth surface.
    #[inline]
    pub fn smooth(position: DVec3, normal: DVec3, geometric_normal: DVec3, triangle: u32, material: u16) -> Self {
        let (smooth_normal, bump) = (normal, Bump::default());
        SurfacePoint { position, normal, smooth_normal, bump, geometric_normal, triangle, material }
    }

    /// The same point without the bumps of normal maps.
    pub fn smoothed(self) -> SurfacePoint {
        SurfacePoint { normal: self.smooth_normal, bump: Bump::default(), ..self }
    }

    /// The point with its normals on the side of the triangle that `view` leads to, a direction away from it.
    pub fn facing(self, view: DVec3) -> SurfacePoint {
        let sign = if self.geometric_normal.dot(view) > 0.0 { 1.0 } else { -1.0 };
        let [normal, smooth_normal, geometric_normal] =
            [self.normal, self.smooth_normal, self.geometric_normal].map(|n| n * sign);
        SurfacePoint { normal, smooth_normal, geometric_normal, ..self }
    }
}

impl Mesh {
    /// The corners of a triangle, m.
    pub fn corners(&self, triangle: usize) -> [DVec3; 3] {
        self.triangles[triangle].vertices.map(|i| self.positions[i as usize].as_dvec3())
    }

    /// Area of a triangle, m².
    pub fn area(&self, triangle: usize) -> f64 {
        area(self.corners(triangle))
    }

    /// The point with barycentric `weights` on a triangle.
    pub fn point(&self, triangle: u32, weights: [f64; 3], kind: NormalKind) -> SurfacePoint {
        let index = triangle as usize;
        let [a, b, c] = self.corners(index);
        // note: [normal] counter-clockwise winding, outward.
        let geometric_normal = unit((b - a).cross(c - a));
        let normal = match kind {
            NormalKind::Geometric => geometric_normal,
            NormalKind::Shading => self.interpolated_normal(triangle, weights).unwrap_or(geometric_normal),
        };
        let position = a * weights[0] + b * weights[1] + c * weights[2];
        let point = SurfacePoint::smooth(position, normal, geometric_normal, triangle, self.triangles[index].material);
        match (&self.bumps, kind) {
            (Some(bumps), NormalKind::Shading) => self.bumpy(bumps, point, weights),
            _ => point,
        }
    }

    /// The point with the normal of its bumps, if it has any.
    #[cold]
    fn bumpy(&self, bumps: &Bumps, point: SurfacePoint, weights: [f64; 3]) -> SurfacePoint {
        let Triangle { vertices, material } = self.triangles[point.triangle as usize];
        // The interpolated normal is not normalized, as those who make pictures with MikkTSpace have it.
        let sum = self.normal_sum(point.triangle, weights);
        let smooth = if sum.length_squared() > 1e-12 { sum } else { point.normal };
        match bumps.tilted(Place { triangle: point.triangle, vertices, material, weights }, smooth) {
            Some((normal, bump)) => SurfacePoint { normal, bump, ..point },
            None => point,
        }
    }

    /// The interpolated vertex normal; none where the vertices have none or cancel.
    fn interpolated_normal(&self, triangle: u32, weights: [f64; 3]) -> Option<DVec3> {
        let sum = self.normal_sum(triangle, weights);
        (sum.length_squared() > 1e-12).then(|| sum.normalize())
    }

    /// The interpolated vertex normal, not normalized.
    pub(crate) fn normal_sum(&self, triangle: u32, weights: [f64; 3]) -> DVec3 {
        self.interpolated(triangle, weights, |i| self.normals[i as usize].as_dvec3())
    }

    /// Texture coordinates at the point with barycentric `weights`; 0 where the file has none.
    pub fn coordinates(&self, triangle: u32, weights: [f64; 3]) -> [f64; 2] {
        self.placed(&self.coordinates, triangle, weights)
    }

    fn placed(&self, coordinates: &[[f32; 2]], triangle: u32, weights: [f64; 3]) -> [f64; 2] {
        let of = |i: u32| DVec2::from_array(coordinates.get(i as usize).copied().unwrap_or_default().map(f64::from));
        self.interpolated(triangle, weights, of).to_array()
    }

    /// Texture coordinates of emission at a vertex; 0 where the file has none.
    pub(crate) fn emission_coordinate(&self, vertex: u32) -> DVec2 {
        let own = self.emission_coordinates.get(vertex as usize).copied();
        DVec2::from_array(own.unwrap_or_default().map(f64::from))
    }

    /// Texture coordinates of emission at the point with barycentric `weights`; 0 where the file has none.
    pub(crate) fn emission_coordinates(&self, triangle: u32, weights: [f64; 3]) -> [f64; 2] {
        self.interpolated(triangle, weights, |i| self.emission_coordinate(i)).to_array()
    }

    /// Texture coordinates of metallic and roughness at the point with barycentric `weights`; 0 where the file has none.
    pub(crate) fn gloss_coordinates(&self, triangle: u32, weights: [f64; 3]) -> [f64; 2] {
        self.placed(&self.gloss_coordinates, triangle, weights)
    }

    /// Those of the share (0) or the color (1) of scattered light there; 0 where the file has none.
    pub(crate) fn scatter_coordinates(&self, which: usize, triangle: u32, weights: [f64; 3]) -> [f64; 2] {
        self.placed(&self.scatter_coordinates[which], triangle, weights)
    }

    /// Color of the vertices at the point with barycentric `weights`.
    pub fn color(&self, triangle: u32, weights: [f64; 3]) -> DVec4 {
        if self.colors.is_empty() {
            return DVec4::ONE;
        }
        self.interpolated(triangle, weights, |i| DVec4::from_array(self.vertex_color(i).map(f64::from)))
    }

    /// The color of a vertex; 1 where the file has none.
    pub(crate) fn vertex_color(&self, vertex: u32) -> [f32; 4] {
        self.colors.get(vertex as usize).copied().unwrap_or([1.0; 4])
    }

    pub(crate) fn interpolated<T>(&self, triangle: u32, weights: [f64; 3], of: impl Fn(u32) -> T) -> T
    where
        T: Add<Output = T> + Mul<f64, Output = T>,
    {
        let [a, b, c] = self.triangles[triangle as usize].vertices.map(of);
        a * weights[0] + b * weights[1] + c * weights[2]
    }

    /// Smallest and largest coordinates of the triangles, m.
    pub fn bounds(&self) -> (DVec3, DVec3) {
        bounds((0..self.triangles.len()).flat_map(|k| self.corners(k)))
    }

    /// Length of the diagonal of the bounding box, m.
    pub fn diagonal(&self) -> f64 {
        let (low, high) = self.bounds();
        (high - low).length()
    }
}

/// Smallest and largest coordinates of points.
pub(crate) fn bounds(points: impl Iterator<Item = DVec3>) -> (DVec3, DVec3) {
    points.fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(low, high), p| (low.min(p), high.max(p)))
}

/// `A_j = ½ ‖(v₁−v₀) × (v₂−v₀)‖`.
// note: [area]
pub(crate) fn area([a, b, c]: [DVec3; 3]) -> f64 {
    0.5 * (b - a).cross(c - a).length()
}

/// `v/‖v‖`; division by the largest component first avoids underflow where the cross product of a tiny triangle is
/// squared.
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
            ..Mesh::default()
        };
        assert_eq!(mesh.area(0), 6.0);
        let point = mesh.point(0, [0.2, 0.3, 0.5], NormalKind::Shading);
        assert_eq!(point.normal, DVec3::Z);
        assert!((point.position - DVec3::new(0.9, 2.0, 0.0)).length() < 1e-15);
    }
}

//! A sphere, whose area and normals are known, with the terminator in view.

use std::collections::BTreeMap;
use std::f64::consts::PI;

use glam::DVec3;

use crate::mesh::Mesh;
use crate::scene::{Indices, Light, LightKind, Part, Scene, Shot, Surface, View};

const RADIUS_M: f64 = 0.02;
/// 20 * 4^5 = 20480 triangles.
const SUBDIVISIONS: usize = 5;

pub fn scene() -> Scene {
    let front =
        Shot { name: "Front", eye: DVec3::new(0.0, 0.0, 0.12), target: DVec3::ZERO, up: DVec3::Y, yfov_degrees: 24.0 };
    let to_sun = DVec3::new(1.0, 0.3, 0.4);
    Scene {
        name: "sphere",
        parts: vec![Part { name: "Sphere", mesh: mesh(), surface: Surface::TRANSLUCENT }],
        lights: vec![Light {
            name: "Sun",
            kind: LightKind::Directional,
            // A white Lambertian surface that faces the sun would have radiance 1.
            intensity: PI,
            color: [1.0; 3],
            position: 0.2 * to_sun,
            direction: -to_sun,
        }],
        indices: Indices::Long,
        cameras: vec![front],
        views: vec![View { name: "front", shot: front, side_pixels: 256, lens: None }],
    }
}

fn mesh() -> Mesh {
    let mut normals = icosahedron_vertices();
    let mut triangles = ICOSAHEDRON.to_vec();
    for _ in 0..SUBDIVISIONS {
        triangles = subdivide(&triangles, &mut normals);
    }
    Mesh {
        positions: normals.iter().map(|&n| (RADIUS_M * n).as_vec3()).collect(),
        normals: normals.iter().map(|n| n.as_vec3()).collect(),
        triangles,
    }
}

/// Corners of three golden rectangles, one in each coordinate plane.
fn icosahedron_vertices() -> Vec<DVec3> {
    let golden = (1.0 + 5.0_f64.sqrt()) / 2.0;
    let mut vertices = Vec::new();
    for (short, long) in [(1.0, golden), (-1.0, golden), (1.0, -golden), (-1.0, -golden)] {
        vertices.push(DVec3::new(short, long, 0.0));
        vertices.push(DVec3::new(0.0, short, long));
        vertices.push(DVec3::new(long, 0.0, short));
    }
    vertices.iter().map(|v| v.normalize()).collect()
}

#[rustfmt::skip]
const ICOSAHEDRON: [[u32; 3]; 20] = [
    [0, 1, 2], [0, 3, 1], [0, 2, 5], [0, 7, 3], [0, 5, 7],
    [1, 4, 2], [1, 3, 8], [1, 8, 4], [2, 4, 6], [2, 6, 5],
    [3, 7, 11], [3, 11, 8], [4, 9, 6], [4, 8, 9], [5, 6, 10],
    [5, 10, 7], [6, 9, 10], [7, 10, 11], [8, 11, 9], [9, 11, 10],
];

/// Splits each triangle in four, the new vertices pushed out to the unit sphere.
fn subdivide(triangles: &[[u32; 3]], unit: &mut Vec<DVec3>) -> Vec<[u32; 3]> {
    let mut middles = BTreeMap::new();
    let mut middle = |a: u32, b: u32| {
        *middles.entry((a.min(b), a.max(b))).or_insert_with(|| {
            unit.push((unit[a as usize] + unit[b as usize]).normalize());
            unit.len() as u32 - 1
        })
    };
    let split = |&[a, b, c]: &[u32; 3]| {
        let [ab, bc, ca] = [middle(a, b), middle(b, c), middle(c, a)];
        [[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]
    };
    triangles.iter().flat_map(split).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn area_is_within_one_percent_of_the_sphere() {
        let mesh = mesh();
        assert_eq!(mesh.triangles.len(), 20480);
        let area_m2: f64 = mesh.triangles.iter().map(|&t| mesh.triangle_area(t)).sum();
        let exact_m2 = 4.0 * PI * RADIUS_M * RADIUS_M;
        assert!((area_m2 / exact_m2 - 1.0).abs() < 0.01, "{area_m2} m², exactly {exact_m2} m²");
    }
}

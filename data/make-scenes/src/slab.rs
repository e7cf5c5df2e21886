//! A slab so wide and deep that its middle reflects like a half-space, whose reflectance is known in closed form
//! (Jensen et al. 2001).

use glam::DVec3;

use crate::lattice::{Lattice, even_cuts};
use crate::mesh::Mesh;
use crate::scene::{Indices, Light, LightKind, Part, Scene, Shot, Surface, View};

const HALF_WIDTH_M: f64 = 0.1;
const DEPTH_M: f64 = 0.05;

pub fn scene() -> Scene {
    // The field of view covers 2 cm, far from every edge.
    let top =
        Shot { name: "Top", eye: DVec3::new(0.0, 0.5, 0.0), target: DVec3::ZERO, up: DVec3::NEG_Z, yfov_degrees: 2.3 };
    Scene {
        name: "slab",
        parts: vec![Part { name: "Slab", mesh: mesh(), surface: Surface::TRANSLUCENT }],
        lights: vec![Light {
            name: "Sun",
            kind: LightKind::Directional,
            intensity: 1.0,
            color: [1.0; 3],
            position: DVec3::new(0.0, 0.3, 0.0),
            direction: DVec3::NEG_Y,
        }],
        indices: Indices::Long,
        cameras: vec![top],
        views: vec![View { name: "top", shot: top, side_pixels: 128, lens: None }],
    }
}

/// Flat, hence without vertex normals: the edges stay sharp although vertices are shared.
fn mesh() -> Mesh {
    let across = even_cuts(-HALF_WIDTH_M, HALF_WIDTH_M, 32);
    let down = even_cuts(-DEPTH_M, 0.0, 8);
    let surface = Lattice { cuts_m: [across.clone(), down, across] }.surface();
    Mesh {
        positions: surface.positions_m.iter().map(|p| p.as_vec3()).collect(),
        normals: Vec::new(),
        triangles: surface.triangles,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn area_is_that_of_the_box() {
        let mesh = mesh();
        let area_m2: f64 = mesh.triangles.iter().map(|&t| mesh.triangle_area(t)).sum();
        assert!((area_m2 - (2.0 * 0.2 * 0.2 + 4.0 * 0.2 * 0.05)).abs() < 1e-7, "{area_m2} m²");
    }
}

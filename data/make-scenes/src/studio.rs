//! The surroundings of the objects of the gallery: floors, backgrounds and lamps.

use glam::{DVec2, DVec3, Vec3};

use crate::mesh::Mesh;
use crate::scene::{Lens, Part, Shot, Surface, View};
use crate::turned;

/// Gap between an object and the surface below it: of surfaces that coincide, rounding would decide which one a ray
/// meets.
pub const GAP_M: f64 = 1e-4;
const SIDE_PIXELS: u32 = 512;

/// An emitting rectangle at `center` that faces `target`, m, with a radiance in W/(m² sr).
pub fn lamp(name: &'static str, center: [f64; 3], target: [f64; 3], half_size: [f64; 2], radiance: [f64; 3]) -> Part {
    let [center, target] = [center, target].map(DVec3::from_array);
    let mesh = Mesh::lamp(center, target, half_size[0], half_size[1]);
    Part { name, mesh, surface: Surface::Emitting { radiance } }
}

/// A floor that bends up into a wall behind, so that no edge shows: half as wide as `half_width` to each side of the
/// origin, with the wall at `-depth`, m.
pub fn backdrop(half_width: f64, depth: f64, base_color: [f64; 3]) -> Part {
    let bend = 0.5 * depth;
    // A quarter of a circle from straight down to straight back.
    let around = turned::circle();
    let quarter = around.len() / 4;
    let mut profile = vec![(DVec2::new(half_width, -GAP_M), DVec2::Y)];
    for &d in around[..=quarter].iter().rev() {
        let center = DVec2::new(bend - depth, bend - GAP_M);
        profile.push((center - bend * d, d));
    }
    profile.push((DVec2::new(-depth, half_width), DVec2::X));
    let mut mesh = Mesh::default();
    for (k, (p, n)) in profile.iter().enumerate() {
        for x in [-half_width, half_width] {
            mesh.positions.push(Vec3::new(x as f32, p.y as f32, p.x as f32));
            mesh.normals.push(Vec3::new(0.0, n.y as f32, n.x as f32));
        }
        let at = 2 * k as u32;
        if k > 0 {
            mesh.triangles.extend([[at - 2, at - 1, at + 1], [at - 2, at + 1, at]]);
        }
    }
    Part { name: "Backdrop", mesh, surface: Surface::Opaque { base_color } }
}

pub fn view(name: &'static str, eye: [f64; 3], target: [f64; 3], yfov_degrees: f64) -> View {
    let [eye, target] = [eye, target].map(DVec3::from_array);
    View { name, shot: Shot { name, eye, target, up: DVec3::Y, yfov_degrees }, side_pixels: SIDE_PIXELS, lens: None }
}

/// A view through a lens.
pub fn focused(name: &'static str, eye: [f64; 3], target: [f64; 3], yfov_degrees: f64, lens: Lens) -> View {
    View { lens: Some(lens), ..view(name, eye, target, yfov_degrees) }
}

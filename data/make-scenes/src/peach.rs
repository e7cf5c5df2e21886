//! A peach, a slice of one and a pot of copper on a table, seen through a lens: pictures for colors and pores,
//! roughness, metal and depth of field.

use glam::{DMat3, DVec2, DVec3};

use crate::fruit::{self, Pose};
use crate::mesh::Mesh;
use crate::peel;
use crate::scene::{Bumps, Finish, Indices, Lens, Part, Pictures, Scene, Surface};
use crate::studio::{GAP_M, focused, lamp};
use crate::surface_nets::{Grid, polygonise};
use crate::turned::turn;

const METRES_PER_MM: f64 = 1e-3;
/// Of the peach, and of the slice, which has edges.
const CELLS_MM: [f64; 2] = [2.0, 1.5];
const EYE: [f64; 3] = [0.03, 0.125, 0.3];
/// Where the middle of the peach is, and how its picture is turned.
const PEACH_MM: DVec3 = DVec3::new(22.0, 31.7, 0.0);
const PEACH_UP: DVec3 = DVec3::new(0.1, 0.9, 0.42);
const PEACH_FRONT: DVec3 = DVec3::new(-0.75, -0.4, 0.66);
const SLICE_MM: DVec3 = DVec3::new(-25.0, 0.3, 56.0);
/// One repetition of the picture of the table, m.
const TABLE_TILE_M: f64 = 0.3;

pub fn scene() -> Scene {
    let views = vec![
        focused("table", EYE, [-0.004, 0.026, 0.0], 27.0, Lens { aperture: 0.0035, focus: 0.29 }),
        focused("side", [-0.2, 0.16, 0.22], [-0.004, 0.026, 0.004], 27.0, Lens { aperture: 0.0035, focus: 0.31 }),
    ];
    let translucent =
        |name, mesh, finish| Part { name, mesh, surface: Surface::Translucent { index_of_refraction: 1.4, finish } };
    let glossy = |name, mesh, finish| Part { name, mesh, surface: Surface::Glossy { finish } };
    let table = Mesh::panel(DVec3::new(0.0, -GAP_M, 0.0), 3.0 * DVec3::Z, 3.0 * DVec3::X);
    Scene {
        name: "peach",
        parts: vec![
            translucent("Peach", peach(), Finish { roughness: 0.45, pictures: Some(SKIN), ..Finish::SMOOTH }),
            translucent("Slice", slice(), Finish { roughness: 0.25, pictures: Some(FLESH), ..Finish::SMOOTH }),
            glossy("Pot", pot(), Finish { base_color: COPPER, metallic: 1.0, roughness: 0.18, pictures: None }),
            Part { name: "Table", mesh: table, surface: Surface::Pictured { pictures: WOOD } },
            lamp("Back", [0.22, 0.3, -0.31], [0.01, 0.03, 0.0], [0.11, 0.11], [36.0, 32.0, 26.5]),
        ],
        lights: Vec::new(),
        indices: Indices::Short,
        cameras: views.iter().map(|v| v.shot).collect(),
        views,
    }
}

const COPPER: [f64; 3] = [0.93, 0.58, 0.42];
const SKIN: Pictures = Pictures {
    coordinates: skin_coordinates,
    base_color: peel::skin,
    bumps: Some(Bumps { picture: peel::pores, repeats: 7.0 }),
};
const FLESH: Pictures = Pictures { coordinates: flesh_coordinates, base_color: peel::flesh, bumps: None };
const WOOD: Pictures = Pictures { coordinates: table_coordinates, base_color: peel::wood, bumps: None };

fn peach_pose() -> Pose {
    Pose::new(PEACH_MM, PEACH_UP, PEACH_FRONT)
}

/// The slice lies on one of its cuts.
fn slice_pose() -> Pose {
    // The normal of the lower cut, (-1, 0, -HALF_ANGLE) in the axes of the slice, is down.
    let cos = 1.0 / (1.0 + fruit::HALF_ANGLE * fruit::HALF_ANGLE).sqrt();
    let sin = fruit::HALF_ANGLE * cos;
    // Where its skin faces on the table, away from the camera, and its stem.
    let out = DVec3::new(-0.3, 0.0, -0.95).normalize();
    let stem = out.cross(DVec3::Y);
    let front = cos * out + sin * DVec3::Y;
    let x = stem.cross(front);
    Pose { center: SLICE_MM, axes: DMat3::from_cols(x, stem, front) }
}

fn skin_coordinates(p: DVec3) -> DVec2 {
    // Towards the camera, level at its right.
    let middle = METRES_PER_MM * PEACH_MM;
    let front = (DVec3::from_array(EYE) - middle).normalize();
    let right = DVec3::Y.cross(front).normalize();
    let d = p - middle;
    fruit::disc(DVec3::new(d.dot(right), d.dot(front.cross(right)), d.dot(front)))
}

fn flesh_coordinates(p: DVec3) -> DVec2 {
    fruit::section(slice_pose().inside(p / METRES_PER_MM))
}

fn table_coordinates(p: DVec3) -> DVec2 {
    // The boards lead away to the left.
    DVec2::new(0.94 * p.x + 0.35 * p.z, 0.94 * p.z - 0.35 * p.x) / TABLE_TILE_M
}

fn peach() -> Mesh {
    let pose = peach_pose();
    around(PEACH_MM, DVec3::splat(37.0), CELLS_MM[0], &|p| fruit::whole(pose.inside(p)))
}

fn slice() -> Mesh {
    let pose = slice_pose();
    around(SLICE_MM + DVec3::new(0.0, 15.0, 0.0), DVec3::new(40.0, 32.0, 40.0), CELLS_MM[1], &|p| {
        fruit::slice(pose.inside(p))
    })
}

/// The zero surface in a box, mm, as a mesh in metres.
fn around(center: DVec3, half: DVec3, cell: f64, field: &impl Fn(DVec3) -> f64) -> Mesh {
    let cells = (2.0 * half / cell).to_array().map(|n| n as usize + 1);
    let grid = Grid { low: center - half - DVec3::splat(0.03), cell, cells };
    polygonise(field, &grid).lowered(0.0, METRES_PER_MM)
}

fn pot() -> Mesh {
    turn(&POT.map(|p| p.map(|x| METRES_PER_MM * x))).moved(METRES_PER_MM * DVec3::new(-42.0, 0.0, -48.0))
}

/// Radius and height, mm: a round pot, and its lid with a knob.
const POT: [[f64; 2]; 23] = [
    [0.0, 1.5],
    [15.0, 1.5],
    [16.0, 0.0],
    [19.0, 0.0],
    [20.0, 0.6],
    [22.0, 2.6],
    [31.0, 10.0],
    [35.5, 24.0],
    [33.0, 38.0],
    [28.5, 44.0],
    [28.2, 45.4],
    [29.6, 45.6],
    [30.6, 46.0],
    [30.6, 47.6],
    [29.8, 48.0],
    [26.0, 53.0],
    [14.0, 57.5],
    [4.0, 58.4],
    [3.0, 60.0],
    [3.4, 62.0],
    [7.4, 66.0],
    [5.0, 71.0],
    [0.0, 71.0],
];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_fruits_lie_on_the_table() {
        for mesh in [peach(), slice()] {
            let lowest = f64::from(mesh.bounds().0.y) / METRES_PER_MM;
            assert!((0.0..0.5).contains(&lowest), "{lowest} mm");
        }
    }
}

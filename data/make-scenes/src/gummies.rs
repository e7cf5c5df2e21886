//! Three gummy bears in front of the light, each of its own medium, and all of them translucent throughout.

use glam::DVec3;

use crate::figure;
use crate::mesh::Mesh;
use crate::scene::{Indices, Part, Scene, Surface};
use crate::studio::{backdrop, lamp, view};
use crate::surface_nets::{Grid, polygonise};

/// Scale of the figure, which makes bears of 24 mm.
const METRES_PER_UNIT: f64 = 0.42e-3;
const CELL: f64 = 1.3;

pub fn scene() -> Scene {
    let bear = |name, x: f64, z: f64| Part { name, mesh: mesh(DVec3::new(x, 0.0, z)), surface: Surface::TRANSLUCENT };
    let views = vec![
        view("all", [0.014, 0.045, 0.15], [0.0005, 0.0098, 0.0], 24.0),
        view("close", [0.035, 0.026, 0.078], [0.004, 0.0115, -0.002], 23.0),
    ];
    Scene {
        name: "gummies",
        parts: vec![
            bear("Cherry", -0.0195, 0.002),
            bear("Orange", 0.0, -0.003),
            bear("Lime", 0.0195, 0.002),
            backdrop(1.0, 0.2, [0.36, 0.46, 0.56]),
            lamp("Back", [0.02, 0.11, -0.085], [0.0, 0.01, 0.0], [0.02, 0.02], [85.0, 82.0, 77.0]),
            lamp("Front", [-0.08, 0.14, 0.12], [0.0, 0.0, 0.0], [0.03, 0.03], [4.6, 4.9, 5.4]),
        ],
        lights: Vec::new(),
        indices: Indices::Short,
        cameras: views.iter().map(|v| v.shot).collect(),
        views,
    }
}

fn mesh(offset: DVec3) -> Mesh {
    let grid = Grid { low: DVec3::new(-23.1, -1.1, -20.1), cell: CELL, cells: [41, 49, 38] };
    polygonise(&figure::field_mm, &grid).seated(METRES_PER_UNIT).moved(offset)
}

//! The crown of a drop that has fallen into a bowl of milk, as thin as light travels in milk, under a sky.

use glam::{DVec2, DVec3};

use crate::field::smooth_min;
use crate::field::{Shape, smooth_max};
use crate::mesh::Mesh;
use crate::scene::{Indices, Part, Scene, Surface};
use crate::studio::{GAP_M, view};
use crate::surface_nets::{Grid, polygonise};
use crate::turned::{circle, turn};

const METRES_PER_MM: f64 = 1e-3;
const CELL_MM: f64 = 0.78;
/// Where the surface of the milk lies above the table, its radius there, and how deep it is modeled.
const LEVEL_MM: f64 = 20.0;
const RADIUS_MM: f64 = 27.0;
const DEPTH_MM: f64 = 6.0;

pub fn scene() -> Scene {
    let views = vec![
        view("bowl", [0.02, 0.1, 0.15], [0.0, 0.0175, 0.0], 26.0),
        view("crown", [0.04, 0.062, 0.085], [0.0, 0.025, 0.0], 23.0),
    ];
    let opaque = |name, mesh, base_color| Part { name, mesh, surface: Surface::Opaque { base_color } };
    let table = Mesh::panel(DVec3::new(0.0, -GAP_M, 0.0), 3.0 * DVec3::Z, 3.0 * DVec3::X);
    Scene {
        name: "milk",
        parts: vec![
            Part { name: "Milk", mesh: milk(), surface: Surface::TRANSLUCENT },
            Part { name: "Bowl", mesh: bowl(), surface: Surface::glossy([0.05, 0.14, 0.3], 0.12) },
            opaque("Table", table, [0.1, 0.085, 0.075]),
        ],
        lights: Vec::new(),
        indices: Indices::Short,
        cameras: views.iter().map(|v| v.shot).collect(),
        views,
    }
}

fn bowl() -> Mesh {
    turn(&BOWL.map(|p| p.map(|x| METRES_PER_MM * x)))
}

/// Radius and height, mm: up on the outside, over the rim, and down again inside.
const BOWL: [[f64; 2]; 13] = [
    [0.0, 1.5],
    [10.0, 1.5],
    [11.0, 0.0],
    [13.5, 0.0],
    [14.0, 2.0],
    [22.0, 5.0],
    [29.5, 14.0],
    [32.0, 25.0],
    [31.4, 27.0],
    [30.2, 26.6],
    [28.0, 15.0],
    [20.0, 6.0],
    [0.0, 4.0],
];

fn milk() -> Mesh {
    let half = RADIUS_MM + 2.03;
    let across = (2.0 * half / CELL_MM) as usize + 1;
    let low = DVec3::new(-half, LEVEL_MM - DEPTH_MM - 2.03, -half);
    let grid = Grid { low, cell: CELL_MM, cells: [across, 58, across] };
    polygonise(&field_mm, &grid).lowered(0.0, METRES_PER_MM)
}

fn field_mm(p: DVec3) -> f64 {
    let flat = DVec2::new((p.x * p.x + p.z * p.z).sqrt(), p.y - LEVEL_MM);
    let side = flat.x - (RADIUS_MM + 0.35 * flat.y.min(0.0));
    let pool = smooth_max(smooth_max(side, ripples(flat), 1.5), -(flat.y + DEPTH_MM), 1.5);
    let wall = segment(flat, DVec2::new(9.0, -1.0), DVec2::new(12.4, 8.0), 1.25, 0.85);
    let crown = smooth_min(pool, wall, 4.0);
    let around = circle();
    SPIKES.iter().fold(crown, |field, spike| {
        let out = around[spike.index];
        let at = |radius: f64, height: f64| DVec3::new(radius * out.x, LEVEL_MM + height, radius * out.y);
        let top = at(12.6 + 0.45 * spike.height, 7.6 + spike.height);
        let arm = Shape::Limb { ends: [at(12.3, 7.2), top], radii: [1.3, 0.8] }.distance(p);
        let bead = p.distance(top) - spike.bead;
        let drop = p.distance(at(14.6 + 0.6 * spike.height, 11.2 + 1.35 * spike.height)) - 0.9 * spike.bead;
        let joined = smooth_min(smooth_min(field, arm, 1.6), bead, 1.2);
        if spike.sheds { joined.min(drop) } else { joined }
    })
}

/// Height above the pool at a distance from its axis: decaying rings, and a bulge in the middle.
fn ripples(flat: DVec2) -> f64 {
    let ring = |radius: f64, height: f64, width: f64| {
        let x = (flat.x - radius) / width;
        height / (1.0 + x * x) / (1.0 + x * x)
    };
    flat.y - ring(0.0, -2.2, 6.0) - ring(15.8, 0.9, 2.0) - ring(20.0, -0.5, 2.0) - ring(24.0, 0.4, 2.0)
}

/// Distance to a rounded segment in the plane of radius and height.
fn segment(p: DVec2, from: DVec2, to: DVec2, from_radius: f64, to_radius: f64) -> f64 {
    let along = ((p - from).dot(to - from) / (to - from).length_squared()).clamp(0.0, 1.0);
    p.distance(from.lerp(to, along)) - (from_radius + along * (to_radius - from_radius))
}

/// A jet of the crown: its index around the crown, its height above the wall, and the radius of its bead, mm.
struct Spike {
    index: usize,
    height: f64,
    bead: f64,
    /// Whether a drop has separated from it.
    sheds: bool,
}

const fn spike(index: usize, height: f64, bead: f64, sheds: bool) -> Spike {
    Spike { index, height, bead, sheds }
}

const SPIKES: &[Spike] = &[
    spike(1, 4.2, 1.4, false),
    spike(6, 5.6, 1.5, true),
    spike(11, 3.6, 1.3, false),
    spike(16, 5.0, 1.5, false),
    spike(21, 4.4, 1.3, true),
    spike(25, 6.0, 1.5, false),
    spike(31, 4.0, 1.4, false),
    spike(36, 5.2, 1.4, true),
    spike(41, 4.6, 1.5, false),
    spike(46, 3.4, 1.3, false),
    spike(51, 5.8, 1.5, true),
    spike(55, 4.0, 1.3, false),
    spike(60, 5.0, 1.4, false),
];

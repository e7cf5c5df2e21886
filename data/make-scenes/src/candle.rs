//! A candle with a hollow around its flame, which is the only light: most of it comes through the wax.

use glam::DVec3;

use crate::field::{Shape, smooth_max, smooth_min};
use crate::mesh::Mesh;
use crate::scene::{Indices, Light, LightKind, Part, Scene, Surface};
use crate::sculpture::{Stroke, blob, join, limb, sculpt};
use crate::studio::{backdrop, lamp, view};
use crate::surface_nets::{Grid, polygonise};
use crate::turned::turn;

const METRES_PER_MM: f64 = 1e-3;
const CELL_MM: f64 = 1.05;
const RADIUS_MM: f64 = 21.0;
const HEIGHT_MM: f64 = 56.0;

pub fn scene() -> Scene {
    let views = vec![
        view("side", [0.05, 0.1, 0.22], [0.0, 0.034, 0.0], 23.5),
        view("top", [-0.08, 0.13, 0.15], [0.0, 0.043, 0.0], 19.0),
    ];
    let opaque = |name, mesh, base_color| Part { name, mesh, surface: Surface::Opaque { base_color } };
    Scene {
        name: "candle",
        parts: vec![
            Part { name: "Wax", mesh: wax(), surface: Surface::rough(0.35) },
            opaque("Wick", turned(WICK), [0.05, 0.04, 0.035]),
            Part { name: "Flame", mesh: turned(FLAME), surface: Surface::Emitting { radiance: [66.0, 29.0, 8.0] } },
            backdrop(1.0, 0.3, [0.34, 0.25, 0.19]),
            lamp("Moon", [0.16, 0.22, -0.18], [0.0, 0.03, 0.0], [0.03, 0.03], [4.0, 6.5, 13.0]),
        ],
        lights: vec![Light {
            name: "Lamp",
            kind: LightKind::Spot { inner_cone_radians: 0.0, outer_cone_radians: 0.5 },
            intensity: 0.05,
            color: [1.0, 0.6, 0.28],
            position: DVec3::new(-0.12, 0.35, 0.16),
            direction: DVec3::new(0.12, -0.35, -0.16),
        }],
        indices: Indices::Short,
        cameras: views.iter().map(|v| v.shot).collect(),
        views,
    }
}

fn wax() -> Mesh {
    let grid = Grid { low: DVec3::new(-28.1, -2.35, -28.1), cell: CELL_MM, cells: [54, 64, 54] };
    polygonise(&field_mm, &grid).seated(METRES_PER_MM)
}

fn turned(profile: &[[f64; 2]]) -> Mesh {
    turn(&profile.iter().map(|p| p.map(|x| METRES_PER_MM * x)).collect::<Vec<_>>())
}

fn field_mm(p: DVec3) -> f64 {
    let side = (p.x * p.x + p.z * p.z).sqrt() - RADIUS_MM;
    // The rim is lower where the wax ran over it.
    let rim = HEIGHT_MM - 0.12 * p.z + 0.06 * p.x;
    let body = smooth_max(smooth_max(side, p.y - rim, 4.0), -p.y, 2.0);
    let with_drips = smooth_min(body, sculpt(DRIPS, p), 3.0);
    smooth_max(with_drips, -sculpt(HOLLOW, p), 3.0).max(-Shape::Below { height: 0.0 }.distance(p))
}

/// The wax that ran down, and the pool at the foot of the candle.
const DRIPS: &[Stroke] = &[
    join(limb([7.0, 50.5, 20.0], [7.6, 24.0, 21.0], [2.0, 2.6]), 1.0),
    join(limb([-9.0, 49.5, 18.6], [-9.2, 38.0, 19.2], [1.8, 2.3]), 1.0),
    join(limb([-19.0, 54.0, 8.0], [-19.6, 12.0, 8.4], [1.8, 2.8]), 1.0),
    join(limb([19.6, 54.0, 6.0], [20.0, 33.0, 6.4], [1.7, 2.4]), 1.0),
    join(blob([-19.8, 1.0, 9.6], [6.0, 2.4, 5.4]), 3.0),
];

/// The hollow that the flame has left.
const HOLLOW: &[Stroke] = &[join(blob([0.0, 60.0, 0.0], [16.8, 24.0, 16.8]), 1.0)];

/// Profiles as pairs of radius and height, mm.
const WICK: &[[f64; 2]] = &[[0.0, 34.5], [0.7, 34.5], [0.7, 35.5], [0.6, 44.0], [0.5, 45.6], [0.0, 45.6]];
const FLAME: &[[f64; 2]] =
    &[[0.0, 46.0], [1.6, 46.0], [3.4, 49.0], [4.0, 53.0], [3.0, 59.0], [1.4, 65.0], [0.5, 70.0], [0.0, 71.0]];

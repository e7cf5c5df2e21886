//! A seated bear that waves, lit from behind: light travels far in its thick body and shines through its thin ears.

use glam::{DVec3, Vec3};

use crate::field::{Shape, smooth_max, smooth_min};
use crate::mesh::Mesh;
use crate::scene::{Indices, Light, LightKind, Part, Scene, Shot, Surface, View};
use crate::sculpture::{Stroke, blob, carve, join, limb, mirrored, sculpt};
use crate::surface_nets::{Grid, polygonise};

const METRES_PER_MM: f64 = 1e-3;
/// Grid of the mesh: finer than the eyes, coarse enough for a small file.
const CELL_MM: f64 = 0.72;
/// Gap between figure and floor: of surfaces that coincide, rounding would decide which one a ray meets.
const FLOOR_GAP_M: f64 = 2e-4;
const FLOOR_HALF_WIDTH_M: f64 = 2.0;
const FLOOR_COLOR: [f64; 3] = [0.55, 0.5, 0.45];
/// Tangent of the angle by which the head leans toward the waving arm.
const HEAD_LEAN: f64 = 0.12;
/// Height at which the underside is cut flat, as if by its weight.
const SEAT_MM: f64 = 1.0;
const NECK_MM: DVec3 = DVec3::new(0.0, 30.0, 0.0);

pub fn scene() -> Scene {
    let front = shot("Front", [0.002, 0.08, 0.178]);
    let three_quarter = shot("ThreeQuarter", [0.114, 0.08, 0.142]);
    let back_left = shot("BackLeft", [0.118, 0.08, -0.143]);
    Scene {
        name: "figure",
        parts: vec![
            Part { name: "Figure", mesh: figure_mesh(), surface: Surface::TRANSLUCENT },
            Part { name: "Floor", mesh: floor_mesh(), surface: Surface::Opaque { base_color: FLOOR_COLOR } },
        ],
        lights: lights(),
        indices: Indices::Long,
        cameras: vec![front, three_quarter],
        views: vec![
            View { name: "front", shot: front, side_pixels: 320, lens: None },
            View { name: "back-left", shot: back_left, side_pixels: 320, lens: None },
        ],
    }
}

fn shot(name: &'static str, eye_m: [f64; 3]) -> Shot {
    Shot {
        name,
        eye: DVec3::from_array(eye_m),
        target: DVec3::new(0.002, 0.028, 0.002),
        up: DVec3::Y,
        yfov_degrees: 25.0,
    }
}

/// Irradiance at the figure: about 8 W/m² from behind, 2 from the front, 1 from the side.
fn lights() -> Vec<Light> {
    let middle = DVec3::new(0.0, 0.03, 0.0);
    let back = DVec3::new(0.10, 0.22, -0.26);
    let key = DVec3::new(-0.24, 0.26, 0.24);
    // The inner cone holds the whole figure; from there the light fades, so that the floor ends in the dark.
    let spot = LightKind::Spot { inner_cone_radians: 0.14, outer_cone_radians: 0.42 };
    vec![
        Light {
            name: "Back",
            kind: spot,
            intensity: 0.9,
            color: [1.0, 0.95, 0.88],
            position: back,
            direction: middle - back,
        },
        Light {
            name: "Key",
            kind: spot,
            intensity: 0.35,
            color: [1.0, 0.98, 0.95],
            position: key,
            direction: middle - key,
        },
        Light {
            name: "Rim",
            kind: LightKind::Point,
            intensity: 0.05,
            color: [0.85, 0.92, 1.0],
            position: DVec3::new(-0.18, 0.16, -0.1),
            direction: DVec3::NEG_Z,
        },
    ]
}

fn floor_mesh() -> Mesh {
    let height = -FLOOR_GAP_M as f32;
    let half = FLOOR_HALF_WIDTH_M as f32;
    let corners = [(-half, half), (half, half), (half, -half), (-half, -half)];
    Mesh {
        positions: corners.map(|(x, z)| Vec3::new(x, height, z)).to_vec(),
        normals: Vec::new(),
        triangles: vec![[0, 1, 2], [0, 2, 3]],
    }
}

fn figure_mesh() -> Mesh {
    let grid = Grid { low: DVec3::new(-23.1, -1.1, -20.1), cell: CELL_MM, cells: [72, 88, 68] };
    polygonise(&field_mm, &grid).seated(METRES_PER_MM)
}

/// The whole figure, looking along +z; mm.
pub fn field_mm(p: DVec3) -> f64 {
    let torso = sculpt(TORSO, mirrored(p));
    let arms = sculpt(ARMS, p);
    let head = sculpt(HEAD, mirrored(into_head(p)));
    let all = smooth_min(smooth_min(torso, arms, 5.0), head, 6.0);
    smooth_max(all, -Shape::Below { height: SEAT_MM }.distance(p), 1.5)
}

/// The transform from the figure's axes to those of its head, which leans about the neck.
fn into_head(p: DVec3) -> DVec3 {
    let cos = 1.0 / (1.0 + HEAD_LEAN * HEAD_LEAN).sqrt();
    let sin = HEAD_LEAN * cos;
    let q = p - NECK_MM;
    NECK_MM + DVec3::new(cos * q.x - sin * q.y, sin * q.x + cos * q.y, q.z)
}

/// The right half of the body; the left one is its mirror image.
const TORSO: &[Stroke] = &[
    join(blob([0.0, 16.5, 0.0], [13.0, 16.5, 11.5]), 1.0),
    // Belly and tail.
    join(blob([0.0, 14.5, 4.0], [11.0, 10.5, 10.0]), 4.0),
    join(blob([0.0, 6.5, -12.0], [4.0, 4.0, 4.0]), 4.0),
    // Leg and upturned foot, with a pad on its sole.
    join(limb([8.0, 6.5, 3.0], [12.0, 6.0, 15.0], [6.5, 5.4]), 5.0),
    join(blob([12.8, 7.5, 18.5], [5.9, 7.4, 3.8]), 3.0),
    join(blob([13.2, 6.5, 21.4], [3.4, 3.6, 1.6]), 1.5),
];

const ARMS: &[Stroke] = &[
    // One arm waves, the other rests on the knee.
    join(limb([10.0, 26.0, 0.5], [22.5, 35.5, 4.0], [4.6, 4.6]), 1.0),
    join(limb([-10.0, 26.0, 1.0], [-16.0, 15.0, 8.5], [4.6, 4.7]), 1.0),
];

/// The right half of the head, before it leans.
const HEAD: &[Stroke] = &[
    join(blob([0.0, 42.0, 1.0], [13.5, 12.0, 12.0]), 1.0),
    // Ears: thin cups, about 1.5 mm thick.
    join(blob([11.0, 52.0, 0.0], [6.2, 6.2, 2.8]), 4.0),
    carve(blob([11.4, 52.4, 3.6], [4.4, 4.4, 3.0]), 2.0),
    // Snout with nose and smile, then the eye.
    join(blob([0.0, 38.5, 11.0], [6.2, 4.8, 5.2]), 3.5),
    join(blob([0.0, 41.0, 15.6], [2.4, 1.7, 1.6]), 1.2),
    carve(limb([0.0, 36.2, 16.0], [3.0, 37.4, 15.2], [0.8, 0.6]), 1.0),
    carve(blob([5.3, 44.8, 12.2], [1.9, 2.3, 2.8]), 1.2),
];

//! A piglet that sits with the light behind its thin ears: a thick body with the scattering of skin.

use glam::DVec3;

use crate::field::{Shape, smooth_max, smooth_min};
use crate::mesh::Mesh;
use crate::scene::{Indices, Part, Scene, Surface};
use crate::sculpture::{Stroke, blob, carve, join, limb, mirrored, sculpt};
use crate::studio::{backdrop, lamp, view};
use crate::surface_nets::{Grid, polygonise};

const METRES_PER_MM: f64 = 1e-3;
const CELL_MM: f64 = 1.3;
/// Height at which its underside is cut flat, as if by its weight.
const SEAT_MM: f64 = -58.0;
/// Half the thickness of an ear, and how deep it is.
const EAR_MM: [f64; 2] = [1.7, 2.4];
/// Half its length and width, and of its middle how far it is from the root.
const EAR_OUTLINE_MM: DVec3 = DVec3::new(18.5, 11.5, 12.5);
/// Offset of the ear's root on the head, and the ear's axes there: outwards along the ear, across, front.
const EAR_ROOT_MM: DVec3 = DVec3::new(15.0, 13.0, -3.0);
const EAR_AXES: [DVec3; 3] =
    [DVec3::new(0.64, 0.768, 0.0), DVec3::new(-0.6144, 0.512, 0.6), DVec3::new(0.4608, -0.384, 0.8)];

pub fn scene() -> Scene {
    let views = vec![
        view("face", [0.07, 0.1, 0.3], [0.001, 0.045, 0.0], 23.0),
        view("profile", [-0.18, 0.115, 0.2], [0.002, 0.051, 0.0], 24.0),
    ];
    Scene {
        name: "piglet",
        parts: vec![
            Part { name: "Skin", mesh: skin(), surface: Surface::rough(0.4) },
            Part { name: "Eyes", mesh: eyes(), surface: Surface::glossy([0.02, 0.015, 0.012], 0.08) },
            backdrop(2.0, 0.4, [0.24, 0.42, 0.46]),
            lamp("Back", [0.07, 0.24, -0.16], [0.0, 0.08, 0.0], [0.03, 0.03], [130.0, 120.0, 104.0]),
            lamp("Front", [-0.2, 0.22, 0.24], [0.0, 0.05, 0.0], [0.05, 0.05], [17.0, 16.0, 14.6]),
        ],
        lights: Vec::new(),
        indices: Indices::Short,
        cameras: views.iter().map(|v| v.shot).collect(),
        views,
    }
}

fn skin() -> Mesh {
    let grid = Grid { low: DVec3::new(-46.1, -60.1, -46.1), cell: CELL_MM, cells: [73, 80, 66] };
    polygonise(&field_mm, &grid).lowered(SEAT_MM, METRES_PER_MM)
}

fn eyes() -> Mesh {
    let eye = |x: f64| {
        let center = DVec3::new(x, 5.5, 17.6);
        let ball = move |p: DVec3| (p - center).length() - 2.9;
        let grid = Grid { low: center - DVec3::splat(4.07), cell: 0.6, cells: [14; 3] };
        polygonise(&ball, &grid).lowered(SEAT_MM, METRES_PER_MM)
    };
    eye(-10.0).and(eye(10.0))
}

/// The piglet looks along +z, its head around the origin; mm.
fn field_mm(p: DVec3) -> f64 {
    let half = mirrored(p);
    let all = smooth_min(sculpt(HEAD, half), ear(half), 4.0);
    smooth_max(all, -Shape::Below { height: SEAT_MM }.distance(p), 2.0)
}

/// A cup with an edge rounded by half its thickness.
fn ear(p: DVec3) -> f64 {
    let [thickness, depth] = EAR_MM;
    let [along, across, front] = EAR_AXES.map(|axis| axis.dot(p - EAR_ROOT_MM));
    let flat = DVec3::new(along - EAR_OUTLINE_MM.z, across, 0.0);
    let radii = EAR_OUTLINE_MM.with_z(1.0);
    let beyond = Shape::Ellipsoid { center: DVec3::ZERO, radii }.distance(flat).max(0.0);
    let sheet = front + depth * (1.0 - (flat / radii).length_squared().min(2.0));
    (beyond * beyond + sheet * sheet).sqrt() - thickness
}

/// The right half of the body; the left one is its mirror image.
const HEAD: &[Stroke] = &[
    join(blob([0.0, 0.0, 0.0], [24.0, 22.0, 22.0]), 1.0),
    // Body, front leg and hind foot.
    join(blob([0.0, -36.0, -10.0], [23.5, 25.0, 22.0]), 8.0),
    join(limb([9.0, -32.0, 6.0], [9.5, -55.0, 13.5], [7.5, 5.8]), 4.0),
    join(limb([18.0, -50.0, -4.0], [20.0, -54.0, 15.0], [9.5, 6.0]), 4.0),
    // Cheek and snout, its disc and nostril.
    join(blob([11.0, -8.0, 8.0], [12.5, 11.0, 11.5]), 6.0),
    join(limb([0.0, -4.0, 15.0], [0.0, -5.0, 27.0], [11.5, 9.0]), 6.0),
    join(blob([0.0, -4.5, 30.5], [10.0, 8.2, 2.8]), 2.0),
    carve(blob([3.5, -4.0, 34.0], [1.8, 2.6, 3.4]), 2.2),
    // Smile and eye socket.
    carve(limb([0.0, -15.5, 26.0], [9.0, -13.0, 21.5], [0.9, 0.7]), 1.5),
    carve(blob([10.0, 5.5, 18.5], [3.4, 3.6, 3.0]), 1.6),
];

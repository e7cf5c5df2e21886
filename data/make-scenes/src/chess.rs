//! Chess pieces of marble and of jade, side by side on a board: two media under one light.

use glam::DVec3;

use crate::mesh::Mesh;
use crate::scene::{Indices, Part, Scene, Surface};
use crate::studio::{GAP_M, lamp, view};
use crate::turned::turn;

const METRES_PER_MM: f64 = 1e-3;
const SQUARE_MM: f64 = 20.0;
/// Number of squares to each side of the middle of the board.
const SQUARES: i32 = 10;

pub fn scene() -> Scene {
    let views = vec![
        view("board", [-0.05, 0.115, 0.185], [0.0, 0.0135, -0.001], 20.0),
        view("close", [0.07, 0.08, 0.115], [-0.001, 0.0165, -0.002], 21.0),
    ];
    let stone = |name, mesh| Part { name, mesh, surface: Surface::rough(0.12) };
    let lacquered = |name, mesh, base_color| Part { name, mesh, surface: Surface::glossy(base_color, 0.35) };
    Scene {
        name: "chess",
        parts: vec![
            stone("Marble", piece(QUEEN, -0.5, -0.5).and(piece(PAWN, -1.5, 0.5))),
            stone("Jade", piece(BISHOP, 0.5, 0.5).and(piece(PAWN, 1.5, -0.5))),
            lacquered("Light squares", squares(0), [0.62, 0.5, 0.36]),
            lacquered("Dark squares", squares(1), [0.13, 0.075, 0.045]),
            lamp("Window", [0.16, 0.14, -0.2], [0.0, 0.015, 0.0], [0.035, 0.035], [76.0, 70.0, 60.0]),
            lamp("Room", [-0.25, 0.25, 0.15], [0.0, 0.0, 0.0], [0.05, 0.05], [7.5, 8.2, 9.5]),
        ],
        lights: Vec::new(),
        indices: Indices::Short,
        cameras: views.iter().map(|v| v.shot).collect(),
        views,
    }
}

/// A piece on the square of this column and row, counted from the middle of the board.
fn piece(profile: &[[f64; 2]], column: f64, row: f64) -> Mesh {
    let metres: Vec<[f64; 2]> = profile.iter().map(|p| p.map(|x| METRES_PER_MM * x)).collect();
    turn(&metres).moved(METRES_PER_MM * SQUARE_MM * DVec3::new(column, 0.0, row))
}

fn squares(color: i32) -> Mesh {
    let half = 0.5 * METRES_PER_MM * SQUARE_MM;
    let all = (-SQUARES..SQUARES).flat_map(|x| (-SQUARES..SQUARES).map(move |z| (x, z)));
    all.filter(|(x, z)| (x + z).rem_euclid(2) == color).fold(Mesh::default(), |mesh, (x, z)| {
        let center = DVec3::new(half * f64::from(2 * x + 1), -GAP_M, half * f64::from(2 * z + 1));
        mesh.and(Mesh::panel(center, half * DVec3::Z, half * DVec3::X))
    })
}

/// Profiles as pairs of radius and height, mm.
const PAWN: &[[f64; 2]] = &[
    [0.0, 0.0],
    [6.4, 0.0],
    [6.9, 0.2],
    [6.9, 1.8],
    [6.2, 2.6],
    [5.4, 3.2],
    [5.2, 4.2],
    [3.2, 5.4],
    [2.6, 8.0],
    [2.3, 11.2],
    [4.2, 11.7],
    [4.2, 12.6],
    [2.4, 13.0],
    [4.4, 14.6],
    [4.7, 18.0],
    [3.0, 20.6],
    [0.0, 20.6],
];
const BISHOP: &[[f64; 2]] = &[
    [0.0, 0.0],
    [7.4, 0.0],
    [7.9, 0.2],
    [7.9, 2.0],
    [7.2, 2.9],
    [6.2, 3.6],
    [6.0, 4.8],
    [3.8, 6.4],
    [3.0, 10.0],
    [2.5, 17.0],
    [4.9, 17.6],
    [4.9, 18.6],
    [2.9, 19.0],
    [4.2, 20.4],
    [5.4, 24.0],
    [3.6, 28.6],
    [1.0, 30.4],
    [0.9, 31.0],
    [1.9, 31.6],
    [1.9, 33.6],
    [0.0, 33.8],
];
const QUEEN: &[[f64; 2]] = &[
    [0.0, 0.0],
    [8.2, 0.0],
    [8.8, 0.2],
    [8.8, 2.2],
    [8.0, 3.2],
    [7.0, 4.0],
    [6.8, 5.4],
    [4.2, 7.4],
    [3.3, 12.0],
    [2.8, 22.0],
    [5.4, 22.7],
    [5.4, 23.8],
    [3.2, 24.3],
    [3.4, 27.0],
    [5.6, 33.0],
    [5.9, 34.2],
    [5.0, 34.2],
    [3.2, 32.8],
    [2.2, 34.4],
    [1.0, 35.2],
    [1.0, 35.6],
    [2.3, 36.2],
    [2.3, 38.8],
    [0.0, 39.0],
];

//! A rounded cube whose triangles span eight decades of area and whose slivers are ten thousand times as long as
//! wide. Each of its faces is cut into one huge cell, thousands of tiny ones and the strips between. The shape itself
//! is smooth, so that any trace of the cuts in an image is an error of the method.

use glam::DVec3;

use crate::lattice::{Lattice, even_cuts};
use crate::mesh::Mesh;
use crate::scene::{Indices, Light, LightKind, Part, Scene, Shot, Surface, View};

const HALF_WIDTH_M: f64 = 0.025;
const ROUNDING_M: f64 = 0.006;
/// Cells across the rounding of one edge, from the flat face to the diagonal.
const ROUNDING_CELLS: usize = 6;
/// Width of the finest cells: f32 still resolves it to 1 in 1000 at this distance from the origin.
const FINEST_M: f64 = 2.5e-6;
const FINEST_CELLS: usize = 16;
/// Growth of the cells beside the finest ones.
const GROWTH: f64 = 3.0;

pub fn scene() -> Scene {
    let front = Shot {
        name: "Front",
        eye: DVec3::new(0.10, 0.09, 0.16),
        target: DVec3::ZERO,
        up: DVec3::Y,
        yfov_degrees: 26.0,
    };
    Scene {
        name: "slivers",
        parts: vec![Part { name: "Slivers", mesh: mesh(), surface: Surface::TRANSLUCENT }],
        lights: lights(),
        indices: Indices::Long,
        cameras: vec![front],
        views: vec![View { name: "front", shot: front, side_pixels: 256, lens: None }],
    }
}

fn lights() -> Vec<Light> {
    vec![
        Light {
            name: "Sun",
            kind: LightKind::Directional,
            intensity: 2.0,
            color: [1.0, 0.96, 0.9],
            position: DVec3::new(-0.1, 0.3, 0.15),
            direction: DVec3::new(0.1, -0.3, -0.15),
        },
        Light {
            name: "Lamp",
            kind: LightKind::Point,
            intensity: 0.04,
            color: [0.8, 0.9, 1.0],
            position: DVec3::new(0.13, 0.02, -0.03),
            direction: DVec3::NEG_Z,
        },
    ]
}

fn mesh() -> Mesh {
    // The cluster of tiny cells lies elsewhere on each axis, so that no symmetry hides an error.
    let cuts_m = [0.009, 0.011, 0.007].map(cuts);
    let surface = Lattice { cuts_m }.surface();
    let core = DVec3::splat(HALF_WIDTH_M - ROUNDING_M);
    let (mut positions, mut normals) = (Vec::new(), Vec::new());
    for p in surface.positions_m {
        // The rounded cube is every point at one distance from a smaller cube.
        let nearest = p.clamp(-core, core);
        let normal = (p - nearest).normalize();
        positions.push((nearest + ROUNDING_M * normal).as_vec3());
        normals.push(normal.as_vec3());
    }
    Mesh { positions, normals, triangles: surface.triangles }
}

/// Cuts of one axis: rounding, one huge cell, the cluster at `cluster_m`, cells that grow, rounding.
fn cuts(cluster_m: f64) -> Vec<f64> {
    let flat = HALF_WIDTH_M - ROUNDING_M;
    let mut cuts = even_cuts(-HALF_WIDTH_M, -flat, ROUNDING_CELLS);
    let cluster_end_m = cluster_m + FINEST_M * FINEST_CELLS as f64;
    cuts.extend(even_cuts(cluster_m, cluster_end_m, FINEST_CELLS));
    let mut width = GROWTH * FINEST_M;
    let mut at = cluster_end_m + width;
    // The last growing cell keeps at least its own width from the rounding.
    while at + width < flat {
        cuts.push(at);
        width *= GROWTH;
        at += width;
    }
    cuts.extend(even_cuts(flat, HALF_WIDTH_M, ROUNDING_CELLS));
    cuts
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn areas_span_more_than_six_decades() {
        let mesh = mesh();
        let areas_m2: Vec<_> = mesh.triangles.iter().map(|&t| mesh.triangle_area(t)).collect();
        let largest_m2 = areas_m2.iter().copied().fold(0.0, f64::max);
        let smallest_m2 = areas_m2.iter().copied().fold(f64::INFINITY, f64::min);
        assert!(largest_m2 / smallest_m2 > 1e6, "{largest_m2} m² over {smallest_m2} m²");
        let tiny = areas_m2.iter().filter(|&&area| area < 1e-6 * largest_m2).count();
        assert!(tiny > 2000, "only {tiny} tiny triangles");
    }

    #[test]
    fn slivers_are_ten_thousand_times_as_long_as_wide() {
        let mesh = mesh();
        let aspect = |&triangle: &[u32; 3]| {
            let [a, b, c] = mesh.corners(triangle);
            let longest_m = a.distance(b).max(b.distance(c)).max(c.distance(a));
            longest_m * longest_m / (2.0 * mesh.triangle_area(triangle))
        };
        let worst = mesh.triangles.iter().map(aspect).fold(0.0, f64::max);
        assert!((8e3..2e4).contains(&worst), "worst aspect {worst}");
    }
}

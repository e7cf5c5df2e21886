//! The tree finds what a loop over all triangles finds, and is the same for any number of threads.

#[path = "support/meshes.rs"]
mod meshes;

use meshes::{bumpy, cube, direction, random};
use scene::{DVec3, Hit, Mesh, Rays};

/// The nearest triangle in front of `origin` by solving for distance and weights (Cramer's rule), nothing shared with
/// the code under test.
fn brute_force(mesh: &Mesh, origin: DVec3, direction: DVec3) -> Option<(f64, u32)> {
    let mut nearest: Option<(f64, u32)> = None;
    for k in 0..mesh.triangles.len() {
        let [a, b, c] = mesh.corners(k);
        let (ab, ac, ao) = (b - a, c - a, origin - a);
        let determinant = -direction.dot(ab.cross(ac));
        let v = direction.dot(ac.cross(ao)) / determinant;
        let w = direction.dot(ao.cross(ab)) / determinant;
        let distance = ao.dot(ab.cross(ac)) / determinant;
        let inside = v >= 0.0 && w >= 0.0 && v + w <= 1.0 && distance >= 0.0;
        if inside && nearest.is_none_or(|(d, _)| distance < d) {
            nearest = Some((distance, k as u32));
        }
    }
    nearest
}

fn assert_same(mesh: &Mesh, found: Option<Hit>, origin: DVec3, direction: DVec3) {
    let (Some(found), Some((distance, triangle))) = (found, brute_force(mesh, origin, direction)) else {
        panic!("one of the two missed the ray {origin} {direction}");
    };
    // Either loses digits where the ray is flat on the triangle.
    let [a, b, c] = mesh.corners(triangle as usize);
    let cosine = (b - a).cross(c - a).normalize().dot(direction).abs();
    let error = (found.distance - distance).abs() / (distance + mesh.diagonal());
    assert!(error < 1e-12 || error * cosine < 1e-15, "{} instead of {distance}, cosine {cosine}", found.distance);
    // The same triangle, or another at the same distance.
    assert!(found.triangle == triangle || error * cosine < 1e-15, "{} instead of {triangle}", found.triangle);
}

#[test]
fn closest_hits_are_those_of_a_loop_over_all_triangles() {
    for radius in [1e-3, 1.0, 1e3] {
        let mesh = bumpy(4, radius);
        let rays = Rays::new(&mesh);
        for k in 0..4000 {
            let item = random(k);
            let from = direction(item, 0) * (radius * [0.7, 1.5, 40.0][(k % 3) as usize]);
            let to = direction(item, 2) * (radius * 0.7);
            let direction = (to - from).normalize();
            assert_same(&mesh, rays.closest(from, direction, None), from, direction);
        }
    }
}

#[test]
fn coarse_triangles_too() {
    let mesh = cube(1.0);
    let rays = Rays::new(&mesh);
    for k in 0..4000 {
        let item = random(k);
        let (from, direction) = (direction(item, 0) * 0.9, direction(item, 2));
        assert_same(&mesh, rays.closest(from, direction, None), from, direction);
    }
}

#[test]
fn any_number_of_threads_builds_the_same_tree() {
    let mesh = bumpy(7, 1.0);
    let hits = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads start");
        let rays = pool.install(|| Rays::new(&mesh));
        // Through a vertex, which triangle is named depends on the order in which the tree is walked.
        let at_vertex = |k: usize| {
            let hit = rays.closest(DVec3::ZERO, mesh.positions[k].as_dvec3().normalize(), None);
            hit.map(|h| (h.triangle, h.distance.to_bits(), h.weights.map(f64::to_bits)))
        };
        (0..mesh.positions.len()).map(at_vertex).collect::<Vec<_>>()
    };
    let one = hits(1);
    assert!(one == hits(2), "2 threads");
    assert!(one == hits(4), "4 threads");
}

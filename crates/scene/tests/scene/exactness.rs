//! The tree finds what a loop over all triangles finds, and is the same for any number of threads.

use crate::meshes::{bumpy, cube, direction, mesh, random};
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

/// Large triangles through each other: the boxes do not tell which is first.
#[test]
fn a_tangle_of_triangles() {
    let points: Vec<DVec3> = (0..3000).map(|k| direction(random(k), 0) * random(k).uniform(4).cbrt()).collect();
    let triangles: Vec<[u32; 3]> = (0..1000).map(|k| [3 * k, 3 * k + 1, 3 * k + 2]).collect();
    let tangle = mesh(&points, &triangles);
    let rays = Rays::new(&tangle);
    for k in 0..4000 {
        let item = random(k);
        let (from, direction) = (direction(item, 10) * (0.5 * item.uniform(12)), direction(item, 13));
        let hit = rays.closest(from, direction, None);
        match brute_force(&tangle, from, direction) {
            Some((distance, _)) => {
                assert_same(&tangle, hit, from, direction);
                assert!(!rays.visible(from, direction, distance * (1.0 + 1e-6) + 1e-8, None));
                assert!(rays.visible(from, direction, distance * (1.0 - 1e-6), None));
            }
            None => assert!(hit.is_none() && rays.visible(from, direction, f64::INFINITY, None)),
        }
    }
}

fn bits(hit: Option<Hit>) -> Option<(u32, u64, [u64; 3])> {
    hit.map(|h| (h.triangle, h.distance.to_bits(), h.weights.map(f64::to_bits)))
}

/// At the distance of the hit itself too, to the last bit, and from outside the scene's box.
#[test]
fn a_limit_only_decides_whether_the_closest_hit_counts() {
    for radius in [1e-3, 1.0, 1e3] {
        let mesh = bumpy(4, radius);
        let rays = Rays::new(&mesh);
        for k in 0..4000 {
            let item = random(k);
            let from = direction(item, 0) * (radius * [0.7, 1.5, 40.0, 1e9][(k % 4) as usize]);
            let direction = (direction(item, 2) * (radius * 0.7) - from).normalize();
            let hit = rays.closest(from, direction, None).expect("aimed inside");
            let within = |limit: f64| bits(rays.closest_within(from, direction, limit, None));
            for limit in [hit.distance, hit.distance.next_up(), 1.1 * hit.distance, f64::INFINITY] {
                assert_eq!(within(limit), bits(Some(hit)), "limit {limit}, hit at {}", hit.distance);
            }
            for limit in [hit.distance.next_down(), 0.9 * hit.distance, 0.0, -1.0, f64::NEG_INFINITY, f64::NAN] {
                assert_eq!(within(limit), None, "limit {limit}, hit at {}", hit.distance);
            }
        }
    }
}

/// Leaves that are not full, and trees of one leaf.
#[test]
fn each_of_a_few_triangles_is_found_and_nothing_else() {
    for count in 1..=20 {
        let points: Vec<DVec3> = (0..count).flat_map(|k| [[0, 0], [1, 0], [0, 1]].map(|at| stair(k, at))).collect();
        let triangles: Vec<[u32; 3]> = (0..count).map(|k| [3 * k, 3 * k + 1, 3 * k + 2]).collect();
        let rays = Rays::new(&mesh(&points, &triangles));
        for k in 0..count {
            let over = (stair(k, [1, 0]) + stair(k, [0, 1])) / 2.0;
            for (shift, found) in [(-1e-6, Some(k)), (1e-6, None)] {
                let origin = over + DVec3::new(shift, shift, 1.0);
                let hit = rays.closest(origin, DVec3::NEG_Z, None);
                assert_eq!(hit.map(|h| h.triangle), found, "triangle {k} of {count}, {shift}");
                assert_eq!(rays.visible(origin, DVec3::NEG_Z, f64::INFINITY, None), found.is_none());
                let from = rays.closest(origin, DVec3::NEG_Z, Some(k));
                assert!(from.is_none(), "a ray does not meet the triangle that it starts on");
            }
        }
    }
}

/// Corner of the k-th of some triangles beside each other.
fn stair(k: u32, [x, y]: [u32; 2]) -> DVec3 {
    DVec3::new(f64::from(2 * k + x), f64::from(y), f64::from(k % 3))
}

/// However the tree was walked.
#[test]
fn of_triangles_equally_near_the_first_is_named() {
    let wheel: Vec<DVec3> = (0..12).map(|k| DVec3::new(f64::from(k).cos(), f64::from(k).sin(), 1.0)).collect();
    let points = [vec![DVec3::Z * 0.5], wheel].concat();
    let triangles: Vec<[u32; 3]> = (0..24).map(|k| [0, 1 + k * 5 % 12, 1 + (k * 5 + 5) % 12]).collect();
    let rays = Rays::new(&mesh(&points, &triangles));
    for from_below in [0.0, 0.25, 0.4999] {
        let hit = rays.closest(DVec3::Z * from_below, DVec3::Z, None).expect("the hub is hit");
        assert_eq!((hit.triangle, hit.distance), (0, 0.5 - from_below));
    }
}

/// Sheets so near to each other and to the ray's start that their boxes are one.
#[test]
fn layers_much_thinner_than_the_boxes() {
    for spacing in [1e-8, 1e-6] {
        let layer = |k: u32| [[-1.0, -1.0], [1.0, -1.0], [0.0, 1.0]].map(|[x, y]| DVec3::new(x, y, height(k, spacing)));
        let points: Vec<DVec3> = (0..64).flat_map(layer).collect();
        let triangles: Vec<[u32; 3]> = (0..64).map(|k| [3 * k, 3 * k + 1, 3 * k + 2]).collect();
        let rays = Rays::new(&mesh(&points, &triangles));
        for below in 0..63 {
            let origin = DVec3::new(0.0, 0.0, (f64::from(below) - 31.5) * spacing);
            let hit = rays.closest(origin, DVec3::Z, None).expect("there is a layer above");
            let next = (0..64).find(|k| height(*k, 1.0) == f64::from(below) - 31.0);
            assert_eq!(Some(hit.triangle), next, "spacing {spacing}, from below layer {below}");
            assert!((hit.distance / spacing - 0.5).abs() < 1e-5);
            assert!(rays.visible(origin, DVec3::Z, 0.4 * spacing, None));
            assert!(!rays.visible(origin, DVec3::Z, 1.4 * spacing, None));
        }
    }
}

/// Height of the k-th layer, in an order that no tree follows.
fn height(k: u32, spacing: f64) -> f64 {
    (f64::from(k * 29 % 64) - 32.0) * spacing
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

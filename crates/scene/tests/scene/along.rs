//! All triangles along a ray, against a loop over the mesh.

use crate::meshes::{bumpy, cube, direction, mesh, random};
use scene::{DVec3, Hit, Mesh, Rays};

/// A crossing by the loop: its distance, and how far inside the triangle it is (its smallest weight).
struct Crossing {
    triangle: u32,
    distance: f64,
    margin: f64,
}

/// All crossings of the line of a ray with triangles, by solving for distance and weights (Cramer's rule); those that
/// only rounding puts inside their triangles, or outside, have a margin near 0.
fn crossings(mesh: &Mesh, origin: DVec3, direction: DVec3) -> Vec<Crossing> {
    let crossing = |k: usize| {
        let [a, b, c] = mesh.corners(k);
        let (ab, ac, ao) = (b - a, c - a, origin - a);
        let determinant = -direction.dot(ab.cross(ac));
        let v = direction.dot(ac.cross(ao)) / determinant;
        let w = direction.dot(ao.cross(ab)) / determinant;
        let distance = ao.dot(ab.cross(ac)) / determinant;
        Crossing { triangle: k as u32, distance, margin: v.min(w).min(1.0 - v - w) }
    };
    (0..mesh.triangles.len()).map(crossing).filter(|c| c.margin > -1e-9).collect()
}

/// The sum over rays of the number of hits. Fails unless they are those of the loop, apart from crossings within
/// rounding of an edge or of an end of the segment.
fn assert_same(mesh: &Mesh, rays: &Rays, origin: DVec3, direction: DVec3, limit: f64) -> usize {
    let mut found = vec![Hit { distance: -1.0, triangle: 0, weights: [0.0; 3] }];
    rays.all_within(origin, direction, limit, &mut found);
    assert!(found.is_sorted_by(|a, b| a.triangle < b.triangle), "the order is that of the mesh, each once");
    let size = mesh.diagonal() + origin.length();
    let expected = crossings(mesh, origin, direction);
    for hit in &found {
        assert!((0.0..=limit).contains(&hit.distance), "{} beyond {limit}", hit.distance);
        let crossing = expected.iter().find(|c| c.triangle == hit.triangle).expect("the loop crosses it as well");
        assert!((crossing.distance - hit.distance).abs() < 1e-11 * size, "{} {}", crossing.distance, hit.distance);
        let [a, b, c] = mesh.corners(hit.triangle as usize);
        let at = a * hit.weights[0] + b * hit.weights[1] + c * hit.weights[2];
        assert!(at.distance(origin + direction * hit.distance) < 1e-11 * size, "{at}");
    }
    let rounding = 1e-11 * size;
    let certain = |c: &&Crossing| c.margin > 1e-9 && c.distance > rounding && c.distance < limit - rounding;
    for crossing in expected.iter().filter(certain) {
        assert!(found.iter().any(|h| h.triangle == crossing.triangle), "{} is missing", crossing.triangle);
    }
    let nearest = found.iter().min_by(|a, b| a.distance.total_cmp(&b.distance).then(a.triangle.cmp(&b.triangle)));
    let closest = rays.closest_within(origin, direction, limit, None);
    let facts = |hit: &Hit| (hit.triangle, hit.distance.to_bits(), hit.weights.map(f64::to_bits));
    assert_eq!(nearest.map(facts), closest.as_ref().map(facts), "the nearest of all is the closest");
    found.len()
}

/// Large triangles through each other, so that rays cross hundreds; from inside and from outside the box, with limits
/// that cut most of them off.
///
/// Seen to catch: a walk that ends at the first hit; the limit shortened at each hit; hits beyond the limit kept.
#[test]
fn a_tangle_is_found_whole() {
    let points: Vec<DVec3> = (0..1500).map(|k| direction(random(k), 0) * random(k).uniform(4).cbrt()).collect();
    let triangles: Vec<[u32; 3]> = (0..500).map(|k| [3 * k, 3 * k + 1, 3 * k + 2]).collect();
    let tangle = mesh(&points, &triangles);
    let rays = Rays::new(&tangle);
    let mut hits = 0;
    for k in 0..3000 {
        let item = random(k);
        let origin = direction(item, 10) * ([0.5, 3.0][k as usize % 2] * item.uniform(12));
        let direction = (direction(item, 13) * 0.5 - origin).normalize();
        let limit = [0.1, 0.7, 3.0, f64::INFINITY][k as usize / 2 % 4];
        hits += assert_same(&tangle, &rays, origin, direction, limit);
    }
    assert!(hits > 60_000, "{hits}");
}

/// Seen to catch: the limit not scaled with the mesh; distances not scaled back; the distance outside of the box not
/// taken from the limit.
#[test]
fn closed_meshes_of_all_sizes() {
    for radius in [1e-3, 1.0, 1e3] {
        for mesh in [bumpy(4, radius), cube(radius)] {
            let rays = Rays::new(&mesh);
            let mut hits = 0;
            for k in 0..2000 {
                let item = random(k);
                let from = direction(item, 0) * (radius * [0.7, 1.5, 40.0][(k % 3) as usize]);
                let to = direction(item, 2) * (radius * 0.7);
                let limit = [0.3 * radius, f64::INFINITY, 1.02 * from.distance(to)][(k / 3 % 3) as usize];
                hits += assert_same(&mesh, &rays, from, (to - from).normalize(), limit);
            }
            assert!((1000..6000).contains(&hits), "{hits}");
        }
    }
}

/// Nothing is left of what the list held before, and no limit that is none finds anything.
///
/// Seen to catch: a list that is not cleared; a limit that is not a number taken for infinite.
#[test]
fn without_a_length_nothing_is_found() {
    let mesh = cube(1.0);
    let rays = Rays::new(&mesh);
    let mut found = Vec::new();
    for limit in [0.0, -1.0, f64::NEG_INFINITY, f64::NAN, 0.5] {
        rays.all_within(DVec3::new(0.1, 0.2, 0.0), DVec3::Z, f64::INFINITY, &mut found);
        assert_eq!(found.len(), 1);
        rays.all_within(DVec3::new(0.1, 0.2, 0.0), DVec3::Z, limit, &mut found);
        assert!(found.is_empty(), "limit {limit}");
    }
    rays.all_within(DVec3::new(3.0, 0.0, 0.0), DVec3::Z, f64::INFINITY, &mut found);
    assert!(found.is_empty(), "the ray misses the box");
}

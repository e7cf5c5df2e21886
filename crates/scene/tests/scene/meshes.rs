//! Closed meshes whose shape is known.

use scene::{
    DVec3, Mesh, Triangle, Vec3,
    random::{Item, Purpose, Stream},
};
use std::collections::HashMap;

/// Triangles wound counter-clockwise seen from outside, without normals.
pub fn mesh(positions: &[DVec3], triangles: &[[u32; 3]]) -> Mesh {
    Mesh {
        positions: positions.iter().map(|p| p.as_vec3()).collect(),
        normals: vec![Vec3::ZERO; positions.len()],
        triangles: triangles.iter().map(|t| Triangle { vertices: *t, material: 0 }).collect(),
        ..Mesh::default()
    }
}

/// A convex sphere: the octahedron with each triangle split into four, `levels` times.
pub fn sphere(levels: u32, radius: f64) -> Mesh {
    star(levels, |_| radius)
}

/// A closed mesh around the origin that every ray from there leaves once.
pub fn star(levels: u32, radius: impl Fn(DVec3) -> f64) -> Mesh {
    let axes = [DVec3::X, DVec3::NEG_X, DVec3::Y, DVec3::NEG_Y, DVec3::Z, DVec3::NEG_Z];
    let mut points = axes.to_vec();
    let mut triangles: Vec<[u32; 3]> =
        vec![[0, 2, 4], [2, 1, 4], [1, 3, 4], [3, 0, 4], [2, 0, 5], [1, 2, 5], [3, 1, 5], [0, 3, 5]];
    for _ in 0..levels {
        let mut middles = HashMap::new();
        let mut middle = |a: u32, b: u32| {
            *middles.entry((a.min(b), a.max(b))).or_insert_with(|| {
                points.push((points[a as usize] + points[b as usize]).normalize());
                points.len() as u32 - 1
            })
        };
        let split = |[a, b, c]: [u32; 3]| {
            let [ab, bc, ca] = [middle(a, b), middle(b, c), middle(c, a)];
            [[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]
        };
        triangles = triangles.into_iter().flat_map(split).collect();
    }
    let placed: Vec<DVec3> = points.iter().map(|p| *p * radius(*p)).collect();
    mesh(&placed, &triangles)
}

/// Bumps of a tenth of the radius and ripples of a hundredth.
pub fn bumpy(levels: u32, radius: f64) -> Mesh {
    let wave = |p: DVec3, f: f64| (f * p.x).sin() * (f * p.y + 1.0).sin() * (f * p.z + 2.0).sin();
    star(levels, |p| radius * (1.0 + 0.1 * wave(p, 7.0) + 0.01 * wave(p, 61.0)))
}

/// The cube of this half edge; two triangles a side.
pub fn cube(half: f64) -> Mesh {
    let corner = |k: u32| DVec3::new((k & 1) as f64, (k >> 1 & 1) as f64, (k >> 2 & 1) as f64) * 2.0 - DVec3::ONE;
    let points: Vec<DVec3> = (0..8).map(|k| corner(k) * half).collect();
    let sides = [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];
    let triangles: Vec<[u32; 3]> = sides.iter().flat_map(|[a, b, c, d]| [[*a, *b, *c], [*a, *c, *d]]).collect();
    mesh(&points, &triangles)
}

/// Random numbers of item `k`; the same in every run.
pub fn random(k: u64) -> Item {
    Stream::new(2024, Purpose::Surface).item(k)
}

/// A uniform direction.
pub fn direction(item: Item, dimension: u64) -> DVec3 {
    let z = 2.0 * item.uniform(dimension) - 1.0;
    let (sine, cosine) = (std::f64::consts::TAU * item.uniform(dimension + 1)).sin_cos();
    let radius = (1.0 - z * z).sqrt();
    DVec3::new(radius * cosine, radius * sine, z)
}

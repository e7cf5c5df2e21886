//! The same surface in other triangles: split, listed from another corner, in another order.
//!
//! Normals are geometric: interpolated ones change inside a triangle that is split.

use crate::{
    figure::Figure,
    picture::{SUBSURFACE, Shot, assert_multiple, assert_paired, sum},
};
use sample_surface::{Choice, Pattern};
use std::collections::HashMap;
use test_support::{
    meshes::{Mesh, World},
    pipeline::Sampling,
    random::Random,
};

const RULES: [Choice; 2] = [Choice::Area, Choice::Uniform];

/// Splits every triangle in four at the middles of its edges, in its place in the list.
fn split(mesh: &Mesh) -> Mesh {
    let mut positions = mesh.positions.clone();
    let mut middles = HashMap::new();
    let mut triangles = Vec::new();
    for [a, b, c] in &mesh.triangles {
        let mut middle = |i: u32, j: u32| {
            *middles.entry((i.min(j), i.max(j))).or_insert_with(|| {
                let [p, q] = [i, j].map(|k| mesh.positions[k as usize].as_dvec3());
                positions.push((0.5 * (p + q)).as_vec3());
                positions.len() as u32 - 1
            })
        };
        let (ab, bc, ca) = (middle(*a, *b), middle(*b, *c), middle(*c, *a));
        triangles.extend([[*a, ab, ca], [*b, bc, ab], [*c, ca, bc], [ab, bc, ca]]);
    }
    Mesh { positions, triangles }
}

/// Splits the triangles of one side in four: the uniform choice then puts its samples there.
fn half_split(mesh: &Mesh) -> Mesh {
    let left = |t: &[u32; 3]| t.iter().map(|i| mesh.positions[*i as usize].x).sum::<f32>() < 0.0;
    let (split_ones, kept): (Vec<_>, Vec<_>) = mesh.triangles.iter().partition(|t| left(t));
    let mut half = split(&Mesh { positions: mesh.positions.clone(), triangles: split_ones });
    half.triangles.extend(kept);
    half
}

/// Lists the triangles from their second corner.
fn turned(mesh: &Mesh) -> Mesh {
    Mesh { triangles: mesh.triangles.iter().map(|[a, b, c]| [*b, *c, *a]).collect(), ..mesh.clone() }
}

/// Puts the triangles in random order.
fn shuffled(mesh: &Mesh) -> Mesh {
    let mut random = Random(11);
    let mut triangles = mesh.triangles.clone();
    for k in (1..triangles.len()).rev() {
        triangles.swap(k, (random.uniform() * (k + 1) as f64) as usize);
    }
    Mesh { triangles, ..mesh.clone() }
}

/// The figure and the same figure in other triangles.
fn pair(change: impl Fn(&Mesh) -> Mesh) -> [World; 2] {
    let figure = Figure::read();
    let mesh = figure.mesh();
    [figure.clone().remeshed(&mesh).world(), figure.remeshed(&change(&mesh)).world()]
}

fn assert_same_mean(what: &str, first: u64, roughest: f64, worlds: &[World; 2]) {
    for (k, choice) in RULES.into_iter().enumerate() {
        let shot = |seed| Shot::smooth(seed).faceted().choosing(choice);
        let sums = |seed: u64| [0, 1].map(|k| sum(&shot(seed).of(&worlds[k]), SUBSURFACE));
        assert_paired(&format!("{what}, {}", choice.name()), first + 100 * k as u64, roughest, sums);
    }
}

/// The same random number chooses the same triangle, or a quarter of it.
///
/// Seen to catch: the uniform density without N.
#[test]
fn every_triangle_split_in_four() {
    let worlds = pair(split);
    assert!(worlds.iter().all(|world| world.scene.degenerate_triangles.is_empty()));
    assert_same_mean("split", 1000, 5e-3, &worlds);
}

/// Seen to catch: the density of the area rule with the uniform choice; the uniform density without N; division by the
/// number of stored samples; flux limited to a largest value.
#[test]
fn triangles_of_one_side_split_in_four() {
    assert_same_mean("half split", 1200, 2e-2, &pair(half_split));
}

/// The same triangles are chosen, with other points on them.
///
/// Seen to catch: the square root of the point's first number left out.
#[test]
fn triangles_listed_from_another_corner() {
    assert_same_mean("turned", 1400, 5e-3, &pair(turned));
}

/// Triangles are chosen in the order of a curve through space, which does not depend on their order in the file: the
/// image of independent samples is the same, and so is the mean of stratified ones.
///
/// Seen to catch: triangles chosen in the order of the list.
#[test]
fn triangles_in_another_order() {
    let worlds = pair(shuffled);
    for choice in RULES {
        let shot = Shot::new(13).faceted().choosing(choice);
        let [a, b] = worlds.each_ref().map(|world| shot.of(world));
        assert_multiple(&format!("shuffled, {}", choice.name()), &a, &b, 1.0);
    }
    assert_paired("shuffled and well spread", 1600, 2e-2, |seed| {
        let shot = Shot::smooth(seed).faceted();
        let shot = Shot { sampling: Sampling { pattern: Pattern::Stratified, ..shot.sampling }, ..shot };
        worlds.each_ref().map(|world| sum(&shot.of(world), SUBSURFACE))
    });
}

#[test]
fn splitting_keeps_the_surface() {
    let mesh = Figure::read().mesh();
    let split = split(&mesh);
    assert_eq!(split.triangles.len(), 4 * mesh.triangles.len());
    let area = |mesh: &Mesh| {
        let corner = |i: u32| mesh.positions[i as usize].as_dvec3();
        let double = |[a, b, c]: &[u32; 3]| (corner(*b) - corner(*a)).cross(corner(*c) - corner(*a)).length();
        mesh.triangles.iter().map(double).sum::<f64>()
    };
    assert!((area(&split) / area(&mesh) - 1.0).abs() < 1e-7);
}

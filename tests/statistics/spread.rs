//! Stratified samples are uniform all the same: over many seeds, counts of one sample of each cloud follow the
//! density, and the two halves of a cloud are independent.

use glam::{DVec3, Vec3};
use rayon::prelude::*;
use sample_surface::{Choice, Numbers, Pattern, SamplePoint, TriangleChoice};
use scene::NormalKind;
use test_support::{
    EFFORT,
    chi_square::assert_fits,
    meshes::{Mesh, Part, World, graded_disc, repository_scene, slab, world},
    random::Random,
    significance,
    z_test::Estimate,
};

/// Number of seeds; each has a scramble of its own.
const SEEDS: u64 = 60_000 * EFFORT;

/// Position of one sample of each seed's cloud; `index` chooses it.
fn points(world: &World, rule: Choice, samples: u64, index: impl Fn(u64) -> u64 + Sync) -> Vec<SamplePoint> {
    let mesh = &world.scene.mesh;
    let choice = TriangleChoice::new(mesh, rule, |_| true, &[]);
    let point = |seed: u64| {
        let numbers = Numbers::new(Pattern::Stratified, seed, samples);
        let (half, point) = numbers.points(&choice, index(seed)..index(seed) + 1).next().expect("one point");
        assert_eq!(half as u64, index(seed) % 2);
        point
    };
    (0..SEEDS).into_par_iter().map(point).collect()
}

/// Another sample of the cloud for each seed: samples that divide the surface among them need not be uniform one by
/// one.
fn any(samples: u64) -> impl Fn(u64) -> u64 + Sync {
    move |seed| Random(seed).bits() % samples
}

/// Counts of cells that are equally likely.
fn assert_even(what: &str, cells: usize, observed: impl Iterator<Item = usize>) {
    let mut counts = vec![0; cells];
    observed.for_each(|cell| counts[cell] += 1);
    assert_fits(what, &counts, &vec![SEEDS as f64 / cells as f64; cells]);
}

/// Seen to catch: the same scramble of the surface for all seeds.
#[test]
fn samples_choose_triangles_as_the_rule_says() {
    for (name, mesh) in [("disc", graded_disc(0.1, 1.0, 6)), ("slab", slab(DVec3::new(1.0, 2.0, 0.3), 2))] {
        let world = world(&[Part::translucent(mesh)], &[], DVec3::ONE);
        let mesh = &world.scene.mesh;
        let areas: Vec<f64> = (0..mesh.triangles.len()).map(|k| mesh.area(k)).collect();
        let total: f64 = areas.iter().sum();
        for (rule, samples) in [Choice::Area, Choice::Uniform].into_iter().flat_map(|r| [1, 2, 7, 5000].map(|n| (r, n)))
        {
            let mut observed = vec![0; areas.len()];
            points(&world, rule, samples, any(samples)).iter().for_each(|p| observed[p.triangle as usize] += 1);
            let share = |area: &f64| if rule == Choice::Area { area / total } else { 1.0 / areas.len() as f64 };
            let expected: Vec<f64> = areas.iter().map(|area| share(area) * SEEDS as f64).collect();
            assert_fits(&format!("{name}, {} rule, {samples} samples", rule.name()), &observed, &expected);
        }
    }
}

/// The condition for an unbiased estimate: the mean over clouds of the sum of `1/(K pdf)` over the samples of a part
/// of the surface is the area of that part. The parts are the triangles, one by one.
///
/// Seen to catch: the area rule's density with the uniform choice; a density for one sample more than there is.
#[test]
fn samples_stand_for_the_area_they_are_drawn_from() {
    // The mesh has few triangles, so that none of them is a rare event.
    let world = world(&[Part::translucent(slab(DVec3::new(1.0, 2.0, 0.5), 1))], &[], DVec3::ONE);
    let mesh = &world.scene.mesh;
    for (rule, samples) in [Choice::Area, Choice::Uniform].into_iter().flat_map(|r| [2, 40, 301, 5000].map(|n| (r, n)))
    {
        let choice = TriangleChoice::new(mesh, rule, |_| true, &[]);
        let seeds = 400_000 * EFFORT / (samples + 100);
        let mut shares = vec![vec![0.0; seeds as usize]; mesh.triangles.len()];
        for seed in 0..seeds {
            let numbers = Numbers::new(Pattern::Stratified, seed, samples);
            for (_, point) in numbers.points(&choice, 0..samples) {
                let triangle = point.triangle as usize;
                shares[triangle][seed as usize] += 1.0 / (samples as f64 * point.pdf_area * mesh.area(triangle));
            }
        }
        // One decision covers all triangles; where nothing is random the sum is exact.
        let p_value = |runs: &Vec<f64>| {
            let exact = runs.iter().all(|x| (x - 1.0).abs() < 1e-9);
            if exact { 1.0 } else { Estimate::of(runs).p_value(1.0) }
        };
        let least = shares.iter().map(p_value).fold(1.0, f64::min) * shares.len() as f64;
        println!("{} rule, {samples} samples: p = {least:.2e}", rule.name());
        assert!(least >= significance(), "{} rule, {samples} samples: p = {least:.2e}", rule.name());
    }
}

/// The lattice of the samples is continuous along ribbons: except at the ends of ribbons, a small step along them is
/// a small step on the surface.
///
/// Seen to catch: a ribbon that does not note from which side it enters a cell; a second half with two corners
/// exchanged.
#[test]
fn ribbons_are_continuous() {
    let world = repository_scene("figure");
    let mesh = &world.scene.mesh;
    let choice = TriangleChoice::new(mesh, Choice::Uniform, |_| true, &[]);
    let steps = 40 * mesh.triangles.len();
    let longest = |triangle: u32| {
        let [a, b, c] = mesh.corners(triangle as usize);
        (b - a).length().max((c - b).length()).max((a - c).length())
    };
    for across in [0.1, 0.5, 0.9] {
        let point = |k: usize| {
            let (chosen, weights) = choice.on_ribbon((k as f64 + 0.5) / steps as f64, across);
            (chosen.triangle, mesh.point(chosen.triangle, weights, NormalKind::Geometric).position)
        };
        let points: Vec<(u32, DVec3)> = (0..steps).map(point).collect();
        // A cell is 80 steps: one step crosses less than a quarter of an edge, also near the corner of a half cell.
        let jumps = points.windows(2).filter(|p| p[0].1.distance(p[1].1) > 0.25 * longest(p[0].0)).count();
        println!("{jumps} jumps among {} triangles", mesh.triangles.len());
        // Ribbons have a mean length of eight triangles.
        assert!(jumps < mesh.triangles.len() / 6, "across at {across}: {jumps} jumps");
    }
}

/// Counts in a grid of congruent small triangles, for triangles that form one piece, a few, and many, and for each of
/// the three edges as the longest.
///
/// Seen to catch: points that leave a piece out.
#[test]
fn samples_cover_a_triangle_evenly() {
    const SIDE: usize = 16;
    let corners = [Vec3::ZERO, Vec3::new(2.0, 0.0, 0.0), Vec3::new(0.5, 1.0, 0.0)];
    for (turn, samples) in [(0, 1), (1, 4), (2, 5000)] {
        let positions = (0..3).map(|k| corners[(k + turn) % 3]).collect();
        let world = world(&[Part::translucent(Mesh { positions, triangles: vec![[0, 1, 2]] })], &[], DVec3::ONE);
        let cell = |point: SamplePoint| {
            let [_, b, c] = point.weights.map(|w| w * SIDE as f64);
            let (i, j) = (b as usize, c as usize);
            let upper = usize::from(b.fract() + c.fract() > 1.0);
            (i * (2 * SIDE - i) + 2 * j + upper).min(SIDE * SIDE - 1)
        };
        let cells = points(&world, Choice::Area, samples, any(samples)).into_iter().map(cell);
        assert_even(&format!("any of {samples} samples"), SIDE * SIDE, cells);
    }
}

/// Each random number for the light of a sample, each pair of them, and each of them together with the position.
///
/// Seen to catch: one scramble for two dimensions.
#[test]
fn samples_have_uniform_numbers_for_their_light() {
    const SIDE: usize = 12;
    let world = world(&[Part::translucent(slab(DVec3::ONE, 1))], &[], DVec3::ONE);
    for index in [0, 1, 37, 4999] {
        let points = points(&world, Choice::Area, 5000, |_| index);
        for (a, b) in [(0, 1), (1, 2), (2, 0)] {
            let cell = |p: &SamplePoint| [a, b].map(|d| (p.light[d] * SIDE as f64) as usize);
            let cells = points.iter().map(cell).map(|[x, y]| SIDE * x + y);
            assert_even(&format!("light {a} and {b} of sample {index}"), SIDE * SIDE, cells);
        }
    }
    for samples in [1, 100] {
        // All sides of the cube are equivalent.
        let points = points(&world, Choice::Area, samples, any(samples));
        let cells = points.iter().map(|p| SIDE * p.triangle as usize + (p.light[0] * SIDE as f64) as usize);
        assert_even(&format!("triangle and light of any of {samples} samples"), SIDE * SIDE, cells);
    }
}

/// Samples of different halves are independent: the difference between the halves estimates the error of both.
///
/// Seen to catch: one scramble for both halves.
#[test]
fn the_halves_are_independent() {
    const SIDE: usize = 12;
    let world = world(&[Part::translucent(slab(DVec3::ONE, 1))], &[], DVec3::ONE);
    // Each half has one sample, which may lie anywhere.
    let [even, odd] = [0, 1].map(|k| points(&world, Choice::Area, 2, |_| k));
    let pairs = || even.iter().zip(&odd);
    let cells = pairs().map(|(a, b)| SIDE * a.triangle as usize + b.triangle as usize);
    assert_even("triangles of both halves", SIDE * SIDE, cells);
    for d in 0..3 {
        let cell = |p: &SamplePoint| (p.light[d] * SIDE as f64) as usize;
        let cells = pairs().map(|(a, b)| SIDE * cell(a) + cell(b));
        assert_even(&format!("light {d} of both halves"), SIDE * SIDE, cells);
        let cells =
            pairs().map(|(a, b)| SIDE * (a.weights[d] * SIDE as f64) as usize + (b.weights[d] * SIDE as f64) as usize);
        let mut counts = vec![0; SIDE * SIDE];
        cells.for_each(|c| counts[c.min(SIDE * SIDE - 1)] += 1);
        // A barycentric weight of a uniform point has the density 2(1 − w).
        let share = |k: usize| (2.0 * (SIDE - k) as f64 - 1.0) / (SIDE * SIDE) as f64;
        let expected: Vec<f64> = (0..SIDE * SIDE).map(|c| SEEDS as f64 * share(c / SIDE) * share(c % SIDE)).collect();
        assert_fits(&format!("weight {d} of both halves"), &counts, &expected);
    }
}

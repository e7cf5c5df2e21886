//! Well-spread samples are uniform all the same: counts over many seeds, of one sample of each, follow the density, and
//! each half of a cloud knows nothing of the other.

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

/// Seeds, each with a scramble of its own.
const SEEDS: u64 = 60_000 * EFFORT;

/// The place of the sample of each seed's cloud that `index` says.
fn places(world: &World, rule: Choice, samples: u64, index: impl Fn(u64) -> u64 + Sync) -> Vec<SamplePoint> {
    let mesh = &world.scene.mesh;
    let choice = TriangleChoice::new(mesh, rule, |_| true);
    let place = |seed: u64| {
        let numbers = Numbers::new(Pattern::Stratified, seed, samples);
        let (half, place) = numbers.points(&choice, index(seed)..index(seed) + 1).next().expect("one place");
        assert_eq!(half as u64, index(seed) % 2);
        place
    };
    (0..SEEDS).into_par_iter().map(place).collect()
}

/// Any sample of a cloud, another one for each seed: no single one need be uniform where they divide the surface up.
fn any(samples: u64) -> impl Fn(u64) -> u64 + Sync {
    move |seed| Random(seed).bits() % samples
}

/// Counts of some cells that are equally likely.
fn assert_even(what: &str, cells: usize, observed: impl Iterator<Item = usize>) {
    let mut counts = vec![0; cells];
    observed.for_each(|cell| counts[cell] += 1);
    assert_fits(what, &counts, &vec![SEEDS as f64 / cells as f64; cells]);
}

/// Seen to catch: one scramble of the surface for all seeds.
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
            places(&world, rule, samples, any(samples)).iter().for_each(|p| observed[p.triangle as usize] += 1);
            let share = |area: &f64| if rule == Choice::Area { area / total } else { 1.0 / areas.len() as f64 };
            let expected: Vec<f64> = areas.iter().map(|area| share(area) * SEEDS as f64).collect();
            assert_fits(&format!("{name}, {} rule, {samples} samples", rule.name()), &observed, &expected);
        }
    }
}

/// What makes the estimate unbiased: the sum of `1/(K pdf)` over the samples of a part of the surface is its area, in the
/// mean over clouds. The parts are all triangles, one by one.
///
/// Seen to catch: the area rule's density with the uniform choice; a density for one sample more than there is.
#[test]
fn samples_stand_for_the_area_they_are_drawn_from() {
    // Few triangles, so that none of them is a rare event.
    let world = world(&[Part::translucent(slab(DVec3::new(1.0, 2.0, 0.5), 1))], &[], DVec3::ONE);
    let mesh = &world.scene.mesh;
    for (rule, samples) in [Choice::Area, Choice::Uniform].into_iter().flat_map(|r| [2, 40, 301, 5000].map(|n| (r, n)))
    {
        let choice = TriangleChoice::new(mesh, rule, |_| true);
        let seeds = 400_000 * EFFORT / (samples + 100);
        let mut shares = vec![vec![0.0; seeds as usize]; mesh.triangles.len()];
        for seed in 0..seeds {
            let numbers = Numbers::new(Pattern::Stratified, seed, samples);
            for (_, place) in numbers.points(&choice, 0..samples) {
                let triangle = place.triangle as usize;
                shares[triangle][seed as usize] += 1.0 / (samples as f64 * place.pdf_area * mesh.area(triangle));
            }
        }
        // One decision for all triangles; where chance has no part the sum is exact.
        let p_value = |runs: &Vec<f64>| {
            let exact = runs.iter().all(|x| (x - 1.0).abs() < 1e-9);
            if exact { 1.0 } else { Estimate::of(runs).p_value(1.0) }
        };
        let least = shares.iter().map(p_value).fold(1.0, f64::min) * shares.len() as f64;
        println!("{} rule, {samples} samples: p = {least:.2e}", rule.name());
        assert!(least >= significance(), "{} rule, {samples} samples: p = {least:.2e}", rule.name());
    }
}

/// The lattice of the samples is whole where ribbons are: a small step along them is a small step on the surface, but for
/// the ends of ribbons.
///
/// Seen to catch: a ribbon that forgets that it sees a cell from its other side; a second half with two corners exchanged.
#[test]
fn ribbons_are_continuous() {
    let world = repository_scene("figure");
    let mesh = &world.scene.mesh;
    let choice = TriangleChoice::new(mesh, Choice::Uniform, |_| true);
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
        // A cell is 80 steps: one step crosses less than a quarter of an edge, even near the corner of a half alone.
        let jumps = points.windows(2).filter(|p| p[0].1.distance(p[1].1) > 0.25 * longest(p[0].0)).count();
        println!("{jumps} jumps among {} triangles", mesh.triangles.len());
        // A ribbon is eight triangles long in the mean.
        assert!(jumps < mesh.triangles.len() / 6, "across at {across}: {jumps} jumps");
    }
}

/// Counts in a grid of congruent small triangles, where the triangle is one piece, a few, and many; its longest edge is any
/// of its three.
///
/// Seen to catch: points that leave a piece out.
#[test]
fn samples_cover_a_triangle_evenly() {
    const SIDE: usize = 16;
    let corners = [Vec3::ZERO, Vec3::new(2.0, 0.0, 0.0), Vec3::new(0.5, 1.0, 0.0)];
    for (turn, samples) in [(0, 1), (1, 4), (2, 5000)] {
        let positions = (0..3).map(|k| corners[(k + turn) % 3]).collect();
        let world = world(&[Part::translucent(Mesh { positions, triangles: vec![[0, 1, 2]] })], &[], DVec3::ONE);
        let cell = |place: SamplePoint| {
            let [_, b, c] = place.weights.map(|w| w * SIDE as f64);
            let (i, j) = (b as usize, c as usize);
            let upper = usize::from(b.fract() + c.fract() > 1.0);
            (i * (2 * SIDE - i) + 2 * j + upper).min(SIDE * SIDE - 1)
        };
        let cells = places(&world, Choice::Area, samples, any(samples)).into_iter().map(cell);
        assert_even(&format!("any of {samples} samples"), SIDE * SIDE, cells);
    }
}

/// Each number for the light, and each pair of them, of a sample taken alone; and together with its place.
///
/// Seen to catch: one scramble for two dimensions.
#[test]
fn samples_have_uniform_numbers_for_their_light() {
    const SIDE: usize = 12;
    let world = world(&[Part::translucent(slab(DVec3::ONE, 1))], &[], DVec3::ONE);
    for index in [0, 1, 37, 4999] {
        let places = places(&world, Choice::Area, 5000, |_| index);
        for (a, b) in [(0, 1), (1, 2), (2, 0)] {
            let cell = |p: &SamplePoint| [a, b].map(|d| (p.light[d] * SIDE as f64) as usize);
            let cells = places.iter().map(cell).map(|[x, y]| SIDE * x + y);
            assert_even(&format!("light {a} and {b} of sample {index}"), SIDE * SIDE, cells);
        }
    }
    for samples in [1, 100] {
        // All sides of the cube are alike.
        let places = places(&world, Choice::Area, samples, any(samples));
        let cells = places.iter().map(|p| SIDE * p.triangle as usize + (p.light[0] * SIDE as f64) as usize);
        assert_even(&format!("triangle and light of any of {samples} samples"), SIDE * SIDE, cells);
    }
}

/// Samples of different halves know nothing of each other: what the two differ by is the error of both.
///
/// Seen to catch: one scramble for both halves.
#[test]
fn the_halves_are_independent() {
    const SIDE: usize = 12;
    let world = world(&[Part::translucent(slab(DVec3::ONE, 1))], &[], DVec3::ONE);
    // One sample in each half, which may be anywhere.
    let [even, odd] = [0, 1].map(|k| places(&world, Choice::Area, 2, |_| k));
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
        // A weight of a uniform point has the density 2(1 − w).
        let share = |k: usize| (2.0 * (SIDE - k) as f64 - 1.0) / (SIDE * SIDE) as f64;
        let expected: Vec<f64> = (0..SIDE * SIDE).map(|c| SEEDS as f64 * share(c / SIDE) * share(c % SIDE)).collect();
        assert_fits(&format!("weight {d} of both halves"), &counts, &expected);
    }
}

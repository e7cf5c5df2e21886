//! Means over independent clouds: what must not change with the choice of triangles, the number of samples, or how the
//! light is divided.

use bssrdf::{Medium, Model};
use glam::DVec3;
use rayon::prelude::*;
use sample_surface::Choice;
use support::{
    EFFORT,
    meshes::{Light, Part, World, quad, rectangle, slab, world},
    pipeline::{Lit, Point, Sampling, by_area, cloud, grey, sampled},
    z_test::{Estimate, assert_equal, assert_mean},
};

const SEEDS: u64 = 64;
const SAMPLES: u64 = 4096 * EFFORT;
/// m.
const HALF_SIZE: DVec3 = DVec3::new(3e-3, 2e-3, 1e-3);

/// Scatters within a third of a millimetre and absorbs within one: the far side of the slab is dark, not black.
fn jelly() -> Medium {
    grey(300.0, 2000.0, 0.0, 1.3)
}

fn sun(irradiance: DVec3) -> Light {
    Light::Directional { towards: DVec3::new(0.48, 0.6, 0.64), irradiance }
}

fn lamp() -> Light {
    Light::Point { position: DVec3::new(-6e-3, 1e-3, 4e-3), intensity: DVec3::new(4e-5, 2e-5, 1e-5) }
}

/// The slab under some lights.
fn lit_by(lights: &[Light]) -> World {
    world(&[Part::translucent(slab(HALF_SIZE, 6))], lights, DVec3::ZERO)
}

/// Points on the upper side and on those that face +X and +Y.
fn points() -> Vec<Point> {
    let spread = [-0.7, -0.2, 0.3, 0.8];
    let side = |axis: usize| {
        let at = move |u: f64, v: f64| {
            let (mut normal, mut position) = (DVec3::ZERO, DVec3::ZERO);
            normal[axis] = 1.0;
            position[axis] = 1.0;
            position[(axis + 1) % 3] = u;
            position[(axis + 2) % 3] = v;
            Point { position: position * HALF_SIZE, normal }
        };
        spread.into_iter().flat_map(move |u| spread.map(|v| at(u, v)))
    };
    (0..3).flat_map(side).collect()
}

/// The mean of `L_r` over the points, each channel, over clouds with seeds from `first` on.
fn estimate(world: &World, points: &[Point], first: u64, sampling: impl Fn(u64) -> Sampling + Sync) -> [Estimate; 3] {
    let run =
        |seed| Lit::new(&cloud(world, &sampling(seed)), &jelly(), Model::StandardDipole).mean(points);
    let runs: Vec<DVec3> = (first..first + SEEDS).into_par_iter().map(run).collect();
    [0, 1, 2].map(|c| Estimate::of(&runs.iter().map(|r| r[c]).collect::<Vec<_>>()))
}

/// Seen to catch: the uniform density without N; the area rule's density with the uniform choice.
#[test]
fn uniform_and_area_choice_have_one_mean() {
    let world = lit_by(&[sun(DVec3::ONE), lamp()]);
    let uniform =
        estimate(&world, &points(), 100, |seed| Sampling { samples: SAMPLES, choice: Choice::Uniform, seed });
    let area = estimate(&world, &points(), 200, |seed| by_area(SAMPLES, seed));
    for c in 0..3 {
        assert_equal(&format!("uniform and area, channel {c}"), uniform[c], area[c]);
    }
}

/// Seen to catch: a lost 1/K, 1/(K + 100) for 1/K.
#[test]
fn more_samples_do_not_move_the_mean() {
    let world = lit_by(&[sun(DVec3::ONE), lamp()]);
    let few = estimate(&world, &points(), 300, |seed| by_area(SAMPLES, seed));
    let many = estimate(&world, &points(), 400, |seed| by_area(4 * SAMPLES, seed));
    for c in 0..3 {
        assert_equal(&format!("K and 4K, channel {c}"), few[c], many[c]);
    }
}

/// Seen to catch: irradiance not divided by the probability of the light's choice.
#[test]
fn red_green_and_blue_light_make_white() {
    let white = estimate(&lit_by(&[sun(DVec3::ONE)]), &points(), 500, |seed| by_area(SAMPLES, seed));
    let colours = [DVec3::X, DVec3::Y, DVec3::Z].map(sun);
    let coloured = estimate(&lit_by(&colours), &points(), 600, |seed| by_area(SAMPLES, seed));
    for c in 0..3 {
        assert_equal(&format!("three colours and white, channel {c}"), coloured[c], white[c]);
    }
}

/// Seen to catch: irradiance not divided by the probability of the light's choice; a shadowed light taken for all.
#[test]
fn two_lights_add_up() {
    let one = estimate(&lit_by(&[sun(DVec3::ONE)]), &points(), 700, |seed| by_area(SAMPLES, seed));
    let other = estimate(&lit_by(&[lamp()]), &points(), 800, |seed| by_area(SAMPLES, seed));
    let both = estimate(&lit_by(&[sun(DVec3::ONE), lamp()]), &points(), 900, |seed| by_area(SAMPLES, seed));
    for c in 0..3 {
        assert_equal(&format!("both lights, channel {c}"), both[c], one[c].plus(other[c]));
    }
}

/// The same samples, the same light: only the directions' last digits and the stored codes of them differ.
///
/// Seen to catch: a point light without its cosine; one falling off with the distance instead of its square.
#[test]
fn a_far_point_light_is_a_directional_one() {
    const DISTANCE: f64 = 1000.0;
    let irradiance = DVec3::new(1.0, 0.5, 2.0);
    let towards = DVec3::new(0.48, 0.6, 0.64);
    let point = Light::Point { position: towards * DISTANCE, intensity: irradiance * DISTANCE * DISTANCE };
    let [near, far] = [point, sun(irradiance)].map(|light| {
        Lit::new(&cloud(&lit_by(&[light]), &by_area(SAMPLES, 1)), &jelly(), Model::DirectionalDipole).mean(&points())
    });
    assert!((near / far - 1.0).abs().max_element() < 1e-4, "{near} {far}");
}

/// A square lit from straight above with and without an opaque sheet over one half.
///
/// Seen to catch: division by the number of stored samples instead of the drawn ones (twice the radiance); shadow rays
/// that are blocked by nothing.
#[test]
fn blocked_samples_count() {
    const HALF_WIDTH: f64 = 12e-3;
    let square = Part::translucent(quad(HALF_WIDTH, 0.0, 8));
    let sheet = Part::opaque(rectangle([-1.5 * HALF_WIDTH, 0.0], 1.5 * HALF_WIDTH, 5e-3, 1));
    let above = [Light::Directional { towards: DVec3::Z, irradiance: DVec3::ONE }];
    let open = world(std::slice::from_ref(&square), &above, DVec3::ZERO);
    let covered = world(&[square, sheet], &above, DVec3::ZERO);
    let points = |x: f64| -> Vec<Point> {
        let at = |k: i32| DVec3::new(x + 2e-4 * f64::from(k % 6), 1.5e-3 * f64::from(k - 5), 0.0);
        (0..12).map(|k| Point { position: at(k), normal: DVec3::Z }).collect()
    };
    // Eight diffusion lengths from the shadow's edge: e^{−8} of the light of the other half is missing.
    let lit = estimate(&covered, &points(6e-3), 1000, |seed| by_area(SAMPLES, seed));
    let free = estimate(&open, &points(6e-3), 1100, |seed| by_area(SAMPLES, seed));
    let dark = estimate(&covered, &points(-6e-3), 1000, |seed| by_area(SAMPLES, seed));
    assert_equal("lit side with and without the sheet", lit[0], free[0]);
    assert!(dark[0].mean < 1e-3 * lit[0].mean, "{} in the shadow, {} outside", dark[0].mean, lit[0].mean);
    stored_samples_are_half(&covered);
}

fn stored_samples_are_half(covered: &World) {
    let count = |seed| {
        let meta = sampled(covered, &by_area(SAMPLES, seed)).meta;
        let stored: u64 = meta.materials.iter().map(|m| m.count).sum();
        let dropped: u64 = meta.samples_dropped.values().sum();
        assert_eq!((meta.samples_drawn, meta.samples_dropped["shadowed"]), (SAMPLES, dropped));
        assert_eq!(stored + dropped, SAMPLES);
        stored as f64 / SAMPLES as f64
    };
    let shares: Vec<f64> = (0..SEEDS).map(count).collect();
    assert_mean("share of stored samples", Estimate::of(&shares), 0.5);
}

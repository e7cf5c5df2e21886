//! Means over independent clouds, which must not depend on the choice of triangles, the number of samples, or how the
//! light is divided among lights.
//!
//! Both programs' work is done in full. The medium has the index 1: no path is reflected, and each pixel shows the
//! sum over the cloud at one point and nothing else.

use bssrdf::{Medium, Model};
use formats::cloud::Cloud;
use gather::Rendered;
use glam::DVec3;
use rayon::prelude::*;
use sample_surface::Choice;
use scene::Camera;
use std::ops::Range;
use test_support::{
    EFFORT,
    meshes::{Light, Part, World, quad, rectangle, slab, world},
    pipeline::{Sampling, by_area, cloud, gray, input, orthographic, sampled, settings, stratified},
    z_test::{Estimate, assert_equal, assert_mean},
};

const SEEDS: u64 = 64;
const SAMPLES: u64 = 4096 * EFFORT;
/// m.
pub const HALF_SIZE: DVec3 = DVec3::new(3e-3, 2e-3, 1e-3);

/// Scatters within half a millimetre and absorbs within one: the far side of the slab is dark, not black.
pub fn jelly() -> Medium {
    gray(300.0, 2000.0, 0.0, 1.0)
}

pub fn sun(irradiance: DVec3) -> Light {
    Light::Directional { towards: DVec3::new(0.48, 0.6, 0.64), irradiance }
}

pub fn lamp() -> Light {
    Light::Point { position: DVec3::new(-6e-3, 1e-3, 4e-3), intensity: DVec3::new(4e-5, 2e-5, 1e-5) }
}

/// The slab under the given lights.
pub fn lit_by(lights: &[Light]) -> World {
    world(&[Part::translucent(slab(HALF_SIZE, 6))], lights, DVec3::ZERO)
}

/// The slab from a corner: all of the upper side and two others.
pub fn corner() -> Camera {
    orthographic(DVec3::new(1.0, 1.2, 1.5), 2.5e-3)
}

/// The sum of all pixels over one cloud.
pub fn image_sum(world: &World, camera: &Camera, cloud: &Cloud, model: Model) -> DVec3 {
    let rendered = rendered(world, camera, cloud, &[jelly()], model);
    assert!(rendered.counts.gathers > 40, "{:?}", rendered.counts);
    rendered.pixels.iter().map(|p| p.beauty()).sum()
}

/// The same picture, of objects of several media.
pub fn rendered(world: &World, camera: &Camera, cloud: &Cloud, media: &[Medium], model: Model) -> Rendered {
    let input = input(world, std::slice::from_ref(cloud), media, camera);
    gather::render(&input, &settings(model, 12, 8), |_| ())
}

/// The sum of all pixels, each channel, over clouds with seeds from `first` on.
fn estimate(world: &World, camera: &Camera, first: u64, sampling: impl Fn(u64) -> Sampling + Sync) -> [Estimate; 3] {
    over_seeds(first..first + SEEDS, |seed| {
        image_sum(world, camera, &cloud(world, &sampling(seed)), Model::StandardDipole)
    })
}

/// The mean of one color for each seed, each channel.
pub fn over_seeds(seeds: Range<u64>, run: impl Fn(u64) -> DVec3 + Sync + Send) -> [Estimate; 3] {
    let runs: Vec<DVec3> = seeds.into_par_iter().map(run).collect();
    [0, 1, 2].map(|c| Estimate::of(&runs.iter().map(|r| r[c]).collect::<Vec<_>>()))
}

/// Seen to catch: the uniform density without N; the area rule's density with the uniform choice.
#[test]
fn uniform_and_area_choice_have_one_mean() {
    let world = lit_by(&[sun(DVec3::ONE), lamp()]);
    let uniform =
        estimate(&world, &corner(), 100, |seed| Sampling { choice: Choice::Uniform, ..by_area(SAMPLES, seed) });
    let area = estimate(&world, &corner(), 200, |seed| by_area(SAMPLES, seed));
    for c in 0..3 {
        assert_equal(&format!("uniform and area, channel {c}"), uniform[c], area[c]);
    }
}

/// Seen to catch: a lost 1/K, 1/(K + 100) for 1/K.
#[test]
fn more_samples_do_not_move_the_mean() {
    let world = lit_by(&[sun(DVec3::ONE), lamp()]);
    for (first, sampling) in [(300, by_area as fn(u64, u64) -> Sampling), (10_300, stratified)] {
        let few = estimate(&world, &corner(), first, |seed| sampling(SAMPLES, seed));
        let many = estimate(&world, &corner(), first + 100, |seed| sampling(4 * SAMPLES, seed));
        for c in 0..3 {
            assert_equal(&format!("K and 4K, seeds from {first}, channel {c}"), few[c], many[c]);
        }
    }
}

/// Seen to catch: irradiance not divided by the probability of the light's choice.
#[test]
fn red_green_and_blue_light_make_white() {
    let white = estimate(&lit_by(&[sun(DVec3::ONE)]), &corner(), 500, |seed| by_area(SAMPLES, seed));
    let colors = [DVec3::X, DVec3::Y, DVec3::Z].map(sun);
    let colored = estimate(&lit_by(&colors), &corner(), 600, |seed| by_area(SAMPLES, seed));
    for c in 0..3 {
        assert_equal(&format!("three colors and white, channel {c}"), colored[c], white[c]);
    }
}

/// Seen to catch: irradiance not divided by the probability of the light's choice; all lights picked alike; division by
/// the number of stored samples.
#[test]
fn two_lights_add_up() {
    let one = estimate(&lit_by(&[sun(DVec3::ONE)]), &corner(), 700, |seed| by_area(SAMPLES, seed));
    let other = estimate(&lit_by(&[lamp()]), &corner(), 800, |seed| by_area(SAMPLES, seed));
    let both = estimate(&lit_by(&[sun(DVec3::ONE), lamp()]), &corner(), 900, |seed| by_area(SAMPLES, seed));
    for c in 0..3 {
        assert_equal(&format!("both lights, channel {c}"), both[c], one[c].plus(other[c]));
    }
}

/// The same samples under the same light: only the last digits of the directions and their stored codes differ.
///
/// Seen to catch: a point light without its cosine; one falling off with the distance instead of its square.
#[test]
fn a_far_point_light_is_a_directional_one() {
    const DISTANCE: f64 = 1000.0;
    let irradiance = DVec3::new(1.0, 0.5, 2.0);
    let towards = DVec3::new(0.48, 0.6, 0.64);
    let point = Light::Point { position: towards * DISTANCE, intensity: irradiance * DISTANCE * DISTANCE };
    let [near, far] = [point, sun(irradiance)].map(|light| {
        let world = lit_by(&[light]);
        image_sum(&world, &corner(), &cloud(&world, &by_area(SAMPLES, 1)), Model::DirectionalDipole)
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
    // The sheet is black, so that no sample takes reflected light from it instead of direct light.
    let sheet = Part::opaque(rectangle([-1.5 * HALF_WIDTH, 0.0], 1.5 * HALF_WIDTH, 5e-3, 1));
    let sheet = Part { color: DVec3::ZERO, ..sheet };
    let above = [Light::Directional { towards: DVec3::Z, irradiance: DVec3::ONE }];
    let open = world(std::slice::from_ref(&square), &above, DVec3::ZERO);
    let covered = world(&[square, sheet], &above, DVec3::ZERO);
    // The image shows 3 by 2 mm, seen from below the sheet.
    let window = |x: f64| Camera { position: DVec3::new(x, 0.0, 2e-3), ..orthographic(DVec3::Z, 1e-3) };
    // The point is eight attenuation lengths from the shadow's edge: e^{−8} of the light of the other half is
    // missing.
    let lit = estimate(&covered, &window(6e-3), 1000, |seed| by_area(SAMPLES, seed));
    let free = estimate(&open, &window(6e-3), 1100, |seed| by_area(SAMPLES, seed));
    let dark = estimate(&covered, &window(-6e-3), 1000, |seed| by_area(SAMPLES, seed));
    assert_equal("lit side with and without the sheet", lit[0], free[0]);
    assert!(dark[0].mean < 1e-3 * lit[0].mean, "{} in the shadow, {} outside", dark[0].mean, lit[0].mean);
    stored_samples_are_half(&covered);
}

fn stored_samples_are_half(covered: &World) {
    let count = |seed| {
        let meta = sampled(covered, &by_area(SAMPLES, seed)).meta;
        let stored: u64 = meta.materials.iter().map(|m| m.count()).sum();
        let dropped: u64 = meta.samples_dropped.values().sum();
        assert_eq!((meta.samples_drawn, meta.samples_dropped["shadowed"]), (SAMPLES, dropped));
        assert_eq!(stored + dropped, SAMPLES);
        stored as f64 / SAMPLES as f64
    };
    let shares: Vec<f64> = (0..SEEDS).map(count).collect();
    assert_mean("share of stored samples", Estimate::of(&shares), 0.5);
}

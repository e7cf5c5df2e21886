//! Stratified samples have the mean of independent ones and less variance; any number of samples has the mean of
//! many.

use crate::means::{HALF_SIZE, corner, image_sum, jelly, lamp, lit_by, over_seeds, sun};
use bssrdf::Model;
use gather::{Settings, estimator::Estimator};
use glam::{DVec3, Vec3};
use sample_surface::{Choice, Pattern};
use std::slice::from_ref;
use test_support::{
    EFFORT,
    meshes::{Part, World, rectangle, slab, world},
    pipeline::{Sampling, by_area, cloud, input, settings, stratified},
    z_test::{Estimate, assert_equal},
};

/// Number of clouds in each mean.
const SEEDS: u64 = 24;
const SAMPLES: u64 = 4096 * EFFORT;

/// The slab under light of every kind.
fn scenes() -> [(&'static str, World); 5] {
    let body = || Part::translucent(slab(HALF_SIZE, 6));
    let mut panel = rectangle([-4e-3, 0.0], 2e-3, 0.0, 2);
    panel.triangles.iter_mut().for_each(|t| t.swap(1, 2)); // shines down
    panel.positions.iter_mut().for_each(|p| *p += Vec3::new(0.0, 3e-3, 5e-3));
    let panel = Part { emission: DVec3::new(2.0, 1.0, 0.5), ..Part::opaque(panel) };
    [
        ("directional", lit_by(&[sun(DVec3::new(1.0, 0.5, 0.25))])),
        ("point", lit_by(&[lamp()])),
        ("two lights", lit_by(&[sun(DVec3::ONE), lamp()])),
        ("sky", world(&[body()], &[], DVec3::new(0.5, 1.0, 2.0))),
        ("panel", world(&[body(), panel], &[], DVec3::ZERO)),
    ]
}

/// Root mean square over the channels.
fn error(estimate: [Estimate; 3]) -> f64 {
    (estimate.iter().map(|e| e.relative_error().powi(2)).sum::<f64>() / 3.0).sqrt()
}

/// Seen to catch: a density for one sample more than there is in a piece of the surface.
#[test]
fn stratified_and_independent_samples_have_one_mean() {
    for (k, (name, world)) in scenes().into_iter().enumerate() {
        for (j, choice) in [Choice::Area, Choice::Uniform].into_iter().enumerate() {
            let first = 20_000 + 1000 * k as u64 + 200 * j as u64;
            let mean = |first: u64, pattern: Pattern| {
                over_seeds(first..first + SEEDS, |seed| {
                    let sampling = Sampling { choice, pattern, ..by_area(SAMPLES, seed) };
                    image_sum(&world, &corner(), &cloud(&world, &sampling), Model::StandardDipole)
                })
            };
            let (spread, free) = (mean(first, Pattern::Stratified), mean(first + 100, Pattern::Independent));
            for c in 0..3 {
                assert_equal(&format!("{name}, {}, channel {c}", choice.name()), spread[c], free[c]);
            }
            // The purpose of the pattern, which is lost with one sequence for both halves, or with a scrambled index.
            let gain = error(free) / error(spread);
            assert!(gain > 1.5, "{name}, {}: errors {} and {}", choice.name(), error(free), error(spread));
        }
    }
}

/// From one sample on: with an odd number the halves are unequal, and with one sample the second half is empty.
///
/// Seen to catch: K/2 for the number of samples of the larger half; half the light of one sample; a list that is
/// reused from gather to gather and not cleared.
#[test]
fn few_samples_have_the_mean_of_many() {
    let world = lit_by(&[sun(DVec3::ONE), lamp()]);
    let (media, camera) = ([jelly()], corner());
    let mean = |samples: u64, seeds: std::ops::Range<u64>, estimator: Estimator| {
        over_seeds(seeds, |seed| {
            let cloud = cloud(&world, &stratified(samples, seed));
            let input = input(&world, from_ref(&cloud), &media, &camera);
            let settings = Settings { paths_per_pixel: 2, estimator, seed, ..settings(Model::BetterDipole, 4, 3) };
            gather::render(&input, &settings, |_| ()).pixels.iter().map(|p| p.beauty()).sum()
        })
    };
    let many = mean(SAMPLES, 30_000..30_000 + SEEDS, Estimator::Exhaustive);
    for samples in [1, 2, 3, 5] {
        for (k, estimator) in [Estimator::Exhaustive, Estimator::Cut { accuracy: 0.1 }].into_iter().enumerate() {
            let first = 31_000 + 10_000 * k as u64 + 1000 * samples;
            let few = mean(samples, first..first + 500 * EFFORT, estimator);
            assert_equal(&format!("K = {samples}, {estimator:?}"), few[1], many[1]);
        }
    }
}

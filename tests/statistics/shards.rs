//! Several clouds that are gathered as one have the mean of one cloud, whatever their sizes.

use crate::error_bars::{Scene, edge, of_paths};
use bssrdf::built_in;
use formats::cloud::{Cloud, Shard};
use gather::{
    Settings,
    estimator::{Estimator, Rule},
};
use glam::DVec3;
use rayon::prelude::*;
use test_support::{
    EFFORT,
    pipeline::{Sampling, cloud, input, orthographic},
    z_test::{Estimate, assert_equal},
};

/// Shards of uneven sizes, one of them with an empty half.
const SIZES: [u64; 4] = [60, 240, 1, 11];
/// Number of images; each has clouds of its own.
const RUNS: u64 = 128 * EFFORT;

/// Mean of an image, all channels.
fn brightness(scene: &Scene, clouds: &[Cloud], settings: &Settings) -> f64 {
    let (media, camera) = ([scene.medium.clone()], orthographic(DVec3::new(1.0, 1.2, 1.5), scene.half_height));
    let input = input(&scene.world, clouds, &media, &camera);
    let pixels = gather::render(&input, settings, |_| ()).pixels;
    pixels.iter().map(|p| p.beauty().element_sum()).sum::<f64>() / pixels.len() as f64
}

/// With 4 paths one of the clouds is used by a path for certain, with 18 two are.
///
/// Seen to catch: sums over the samples of one cloud divided by the number in all; round-robin sums divided by the
/// number in the first cloud; the exhaustive sum divided by the number in the first; weights of the round-robin given
/// to clouds that no path may use.
#[test]
fn the_mean_of_uneven_shards_is_that_of_one_cloud() {
    let scene = edge(built_in("marble").expect("a built-in medium"));
    let kinds = [
        (Estimator::Cut { accuracy: 0.1 }, 4),
        (Estimator::Cut { accuracy: 0.1 }, 1),
        (Estimator::Cut { accuracy: 0.1 }, 18),
        (Estimator::Exhaustive, 2),
        (Estimator::Roulette(Rule::Mixture), 2),
    ];
    for (k, (estimator, paths)) in kinds.into_iter().enumerate() {
        let settings = |seed| Settings { seed, ..of_paths(estimator, paths) };
        let shard = |seed, index: usize| Sampling {
            shard: Shard { index: index as u32, count: SIZES.len() as u32 },
            ..(scene.sampling)(SIZES[index], seed)
        };
        let means = |seeds: u64, clouds: &(dyn Fn(u64) -> Vec<Cloud> + Sync)| {
            let run = |seed: u64| brightness(&scene, &clouds(seed), &settings(seed));
            Estimate::of(&(seeds..seeds + RUNS).into_par_iter().map(run).collect::<Vec<_>>())
        };
        let first = 200_000 + 10_000 * k as u64;
        let apart = means(first, &|seed| (0..SIZES.len()).map(|i| cloud(&scene.world, &shard(seed, i))).collect());
        let one = means(first + 5000, &|seed| vec![cloud(&scene.world, &(scene.sampling)(SIZES.iter().sum(), seed))]);
        assert_equal(&format!("shards, {estimator:?}, {paths} paths"), apart, one);
        assert!(apart.relative_error() < 0.03, "{apart:?} is too rough to tell");
    }
}

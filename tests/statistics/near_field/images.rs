//! Near parts of the programs' own widths: in images of sparse clouds.

use super::{
    Farthest,
    scenes::{jelly, pair},
};
use ::near_field::NearField;
use bssrdf::Model;
use formats::cloud::Cloud;
use gather::{Filter, estimator::Estimator};
use glam::DVec3;
use rayon::prelude::*;
use test_support::{
    EFFORT,
    meshes::World,
    pipeline::{cloud, gray, input, orthographic, settings, stratified},
    z_test::Estimate,
};

const SEEDS: u64 = 128 * EFFORT;

/// The sum of an image's pixels by the cut, which has near parts, less that by the whole sum over the same cloud, which
/// has none, and the latter.
fn sums(world: &World, cloud: &Cloud, paths: u32, seed: u64) -> [DVec3; 2] {
    let (camera, media) =
        (orthographic(DVec3::new(-0.4, -0.7, 1.0), 1.6e-3), [jelly(1.0), gray(200.0, 1000.0, 0.0, 1.3)]);
    let filter = if paths == 1 { Filter::Point } else { Filter::Box };
    let [cut, whole] = [Estimator::Cut { accuracy: 0.1 }, Estimator::Exhaustive].map(|estimator| {
        let settings = settings(Model::HalfSpace, 8, 6);
        let near_field = estimator.is_hierarchical();
        let settings = gather::Settings { estimator, near_field, paths_per_pixel: paths, filter, seed, ..settings };
        let rendered = gather::render(&input(world, std::slice::from_ref(cloud), &media, &camera), &settings, |_| ());
        rendered.pixels.iter().map(|p| p.beauty()).sum::<DVec3>()
    });
    [cut - whole, whole]
}

/// Two bodies of different media whose samples are a quarter of a millimetre apart, in images of one path and of four.
///
/// Seen to catch: samples that carry the whole model beside the near part; the near part of the first material for all;
/// light that the floor reflects left out; `w` applied twice.
#[test]
fn images_of_sparse_clouds_have_the_mean_of_the_whole_sum() {
    let world = pair();
    let mut farthest = Farthest::new();
    for paths in [1, 4] {
        let seeds = 7000 * u64::from(paths)..7000 * u64::from(paths) + SEEDS;
        let run = |seed| sums(&world, &cloud(&world, &stratified(1000, seed)), paths, seed);
        let runs: Vec<[DVec3; 2]> = seeds.into_par_iter().map(run).collect();
        let whole = runs.iter().map(|r| r[1]).sum::<DVec3>() / SEEDS as f64;
        for channel in 0..3 {
            let values: Vec<f64> = runs.iter().map(|r| r[0][channel] / whole[channel]).collect();
            farthest.add(|| format!("{paths} paths, channel {channel}"), Estimate::of(&values));
        }
    }
    farthest.assert_none("images");
}

/// The step lies between one and three distances between samples, and there is none where samples lie closer than five
/// hundredths of the shortest mean free path, or nothing is scattered.
///
/// Seen to catch: a step that ends a tenth too early; six hundredths for five; the area of one material for all.
#[test]
fn the_step_goes_with_the_distance_between_samples() {
    let world = pair();
    let clouds = [cloud(&world, &stratified(1000, 1))];
    let area: f64 = clouds[0].meta().materials.iter().map(|m| m.area_m2).sum();
    let spacing = (area / 1000.0).sqrt();
    let medium = |path: f64| gray(0.1 / path, 0.9 / path, 0.0, 1.3);
    let of = |medium| NearField::of_clouds(Model::HalfSpace, &medium, &clouds, 1);
    let partition = of(medium(spacing)).expect("the samples do not resolve it").partition();
    for (distance, far) in [(0.999, 0.0), (5f64.sqrt(), 0.5), (3.001, 1.0)] {
        let found = partition.far((distance * spacing).powi(2));
        assert!((found - far).abs() < 1e-9, "{found} at {distance} distances");
    }
    assert!(of(medium(spacing / 0.051)).is_some() && of(medium(spacing / 0.049)).is_none());
    assert!(of(gray(0.0, 0.0, 0.0, 1.3)).is_none() && of(gray(1e5, 0.0, 0.0, 1.3)).is_none());
}

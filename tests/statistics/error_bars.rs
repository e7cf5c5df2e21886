//! The variance that an image states for a pixel is the one that the pixel has, over clouds, gathers and camera
//! paths.

use crate::means::{jelly, lamp, sun};
use bssrdf::{Medium, Model, built_in};
use formats::cloud::{Cloud, Shard};
use gather::{Filter, Input, Settings, estimator::Estimator, film::Pixel};
use glam::DVec3;
use rayon::prelude::*;
use test_support::{
    EFFORT,
    meshes::{Part, World, slab, world},
    pipeline::{Sampling, by_area, cloud, gray, orthographic, settings, stratified},
    z_test::{Estimate, assert_mean},
};

/// Pairs of images; each image has a cloud and camera paths of its own.
const PAIRS: u64 = 80 * EFFORT;
/// The number of samples, so small that the cloud's part of the variance is about as large as that of the paths.
const SAMPLES: u64 = 150;

const CUT: Estimator = Estimator::Cut { accuracy: 0.1 };

/// The usual direction of the camera.
const TOWARDS: DVec3 = DVec3::new(1.0, 1.2, 1.5);

pub struct Scene {
    pub world: World,
    pub medium: Medium,
    /// The direction of the camera.
    pub towards: DVec3,
    /// Half of the width that the image shows, m.
    pub half_height: f64,
    pub sampling: fn(u64, u64) -> Sampling,
    /// Number of clouds that are gathered together.
    shards: u32,
}

/// An object that fills a part of the image, before black.
pub fn edge(medium: Medium) -> Scene {
    edge_under(medium, DVec3::ZERO)
}

/// The same before a sky that its edge pixels and its inside show.
fn edge_under_sky(medium: Medium) -> Scene {
    edge_under(medium, DVec3::splat(0.02))
}

fn edge_under(medium: Medium, environment: DVec3) -> Scene {
    let body = Part::translucent(slab(DVec3::new(3e-3, 2e-3, 1e-3), 4));
    let world = world(&[body], &[sun(DVec3::ONE), lamp()], environment);
    Scene { world, medium, towards: TOWARDS, half_height: 3.5e-3, sampling: stratified, shards: 1 }
}

fn image(scene: &Scene, settings: &Settings, seed: u64) -> Vec<Pixel> {
    let count = scene.shards;
    let shard = |index| Sampling { shard: Shard { index, count }, ..(scene.sampling)(SAMPLES, seed) };
    let clouds: Vec<Cloud> = (0..count).map(|index| cloud(&scene.world, &shard(index))).collect();
    let (media, camera) = ([scene.medium.clone()], orthographic(scene.towards, scene.half_height));
    let (scene_of, rays) = (&scene.world.scene, &scene.world.rays);
    let input =
        Input { scene: scene_of, rays, clouds: &clouds, media: &media, tints: &[], calibration: None, camera: &camera };
    gather::render(&input, &Settings { seed, ..settings.clone() }, |_| ()).pixels
}

/// The ratio of the estimated variance to the actual one, both summed over pixels and channels, over pairs of images:
/// the squared difference between two values of a pixel is, in the mean, twice their variance.
fn assert_error_bars(what: &str, scene: &Scene, settings: &Settings, first: u64) {
    let pair = |k: u64| {
        let [a, b] = [0, 1].map(|j| image(scene, settings, first + 2 * k + j));
        let actual = |(p, q): (&Pixel, &Pixel)| (p.beauty() - q.beauty()).length_squared() / 2.0;
        let estimated = |(p, q): (&Pixel, &Pixel)| (p.variance() + q.variance()).element_sum() / 2.0;
        [a.iter().zip(&b).map(actual).sum::<f64>(), a.iter().zip(&b).map(estimated).sum()]
    };
    let pairs: Vec<[f64; 2]> = (0..PAIRS).into_par_iter().map(pair).collect();
    let actual = pairs.iter().map(|p| p[0]).sum::<f64>() / PAIRS as f64;
    // Error of the ratio to first order, from the scatter of the differences about it.
    let ratio = pairs.iter().map(|p| p[1]).sum::<f64>() / PAIRS as f64 / actual;
    let differences: Vec<f64> = pairs.iter().map(|[a, e]| (e - ratio * a) / actual).collect();
    let estimate = Estimate { mean: ratio, ..Estimate::of(&differences) };
    assert_mean(&format!("variance, {what}"), estimate, 1.0);
    assert!(estimate.error < 0.2, "{what}: {estimate:?} is too rough to tell");
}

pub fn of_paths(estimator: Estimator, paths_per_pixel: u32) -> Settings {
    // The directional dipole has outliers at silhouettes (docs/method.md section 8), which take many images to average.
    let settings = settings(Model::StandardDipole, 10, 8);
    Settings { estimator, paths_per_pixel, filter: Filter::Box, ..settings }
}

/// Seen to catch: half of the squared difference; both halves of the cloud drawn by one scramble; paths of both halves
/// spread by one sequence; all paths gathering from the first half.
#[test]
fn of_the_cut() {
    let scene = edge_under_sky(built_in("marble").expect("a built-in medium"));
    for (k, paths) in [2, 4, 5].into_iter().enumerate() {
        let settings = of_paths(CUT, paths);
        assert_error_bars(&format!("cut, {paths} paths"), &scene, &settings, 50_000 + 1000 * k as u64);
    }
}

/// With three clouds, and fewer paths in each half or as many: which clouds a pixel gathers from is a part of its
/// error.
///
/// Seen to catch: all paths gathering from the first halves.
#[test]
fn of_shards() {
    let scene = Scene { shards: 3, ..edge_under_sky(built_in("marble").expect("a built-in medium")) };
    for (k, paths) in [2, 6].into_iter().enumerate() {
        let settings = of_paths(CUT, paths);
        assert_error_bars(&format!("shards, {paths} paths"), &scene, &settings, 90_000 + 1000 * k as u64);
    }
}

/// Every path gathers from both halves of the cloud, while the error bars take one half for even paths and the other
/// for odd ones. The two agree if the error of the cloud is the same all over a pixel, for which the medium is thin
/// here. Otherwise the paths average over that error, and the error bars, which see half of the paths for each half,
/// are somewhat wide.
///
/// Seen to catch: the same value of the cloud for both halves.
#[test]
fn of_the_whole_sum() {
    // In so thin a medium, independent samples and a view without the silhouette show the part of the cloud.
    let scene = Scene { half_height: 6e-4, sampling: by_area, ..edge_under_sky(gray(30.0, 300.0, 0.0, 1.3)) };
    for (k, paths) in [2, 4].into_iter().enumerate() {
        let settings = of_paths(Estimator::Exhaustive, paths);
        assert_error_bars(&format!("whole sum, {paths} paths"), &scene, &settings, 60_000 + 1000 * k as u64);
    }
}

/// In so thin a medium, with so many samples, the noise is that of the silhouette, which the control variate of cheap
/// rays reduces.
///
/// Seen to catch: halves treated as independent although each takes its factors from the other.
#[test]
fn of_edges() {
    let scene = edge(gray(30.0, 300.0, 0.0, 1.3));
    for (k, paths) in [2, 4, 8].into_iter().enumerate() {
        let settings = of_paths(Estimator::Exhaustive, paths);
        assert_error_bars(&format!("edges, {paths} paths"), &scene, &settings, 80_000 + 1000 * k as u64);
    }
}

/// One path through the center of each pixel of an object of index 1 has no noise of its own: what is left is that of
/// the cloud and the gather, and it is stated.
///
/// Seen to catch: the mean of both halves taken for each.
#[test]
fn of_one_path_a_pixel() {
    let scene = edge(jelly());
    for (k, estimator) in [CUT, Estimator::Exhaustive].into_iter().enumerate() {
        let settings = Settings { filter: Filter::Point, ..of_paths(estimator, 1) };
        assert_error_bars(&format!("{estimator:?}, one path"), &scene, &settings, 70_000 + 1000 * k as u64);
    }
}

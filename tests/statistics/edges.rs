//! The control variate of silhouette pixels removes noise and leaves the mean.

use crate::error_bars::{Scene, edge, of_paths};
use gather::{Settings, estimator::Estimator, film::Pixel};
use glam::DVec3;
use rayon::prelude::*;
use scene::{Camera, Lens};
use std::slice::from_ref;
use test_support::{
    EFFORT,
    pipeline::{cloud, gray, input, orthographic},
    z_test::{Estimate, assert_equal},
};

/// Number of images in each mean.
const IMAGES: u64 = 4000 * EFFORT;

/// Mean radiance of the whole image, for independent random numbers of gathers and camera paths.
fn brightness(scene: &Scene, lens: Option<Lens>, paths_per_pixel: u32) -> Estimate {
    let cloud = cloud(&scene.world, &(scene.sampling)(20, 1));
    let media = [scene.medium.clone()];
    let camera = Camera { lens, ..orthographic(DVec3::new(1.0, 1.2, 1.5), scene.half_height) };
    let input = input(&scene.world, from_ref(&cloud), &media, &camera);
    let settings = of_paths(Estimator::Exhaustive, paths_per_pixel);
    let image = |seed: u64| {
        let rendered = gather::render(&input, &Settings { seed, ..settings.clone() }, |_| ());
        assert_eq!(rendered.counts.edge_pixels > 10, paths_per_pixel > 1);
        rendered.pixels.iter().map(|p: &Pixel| p.beauty().element_sum()).sum()
    };
    let first = 1_000_000 * u64::from(paths_per_pixel);
    Estimate::of(&(first..first + IMAGES).into_par_iter().map(image).collect::<Vec<f64>>())
}

/// With one path a pixel the control variate is off, which gives the mean to compare with.
///
/// Seen to catch: a factor computed from the half's own paths; rays that miss left out of the count.
#[test]
fn the_mean_is_that_of_paths_alone() {
    // The medium is so thin that the light below varies little within a pixel.
    let scene = edge(gray(30.0, 300.0, 0.0, 1.3));
    let alone = brightness(&scene, None, 1);
    // Measured as a share of the variance of one path: 0.50, 0.22 and 0.029 without the control variate.
    for (paths, most) in [(2, 0.43), (3, 0.15), (8, 0.01)] {
        let known = brightness(&scene, None, paths);
        assert_equal(&format!("{paths} paths"), known, alone);
        let variance = (known.error / alone.error).powi(2);
        println!("{paths} paths: variance {variance:.3} of one path's");
        assert!(variance < most, "{paths} paths: variance {variance:.3} of one path's");
    }
}

/// The same through a lens: the silhouette is blurred over a millimetre, the third of the object's width.
///
/// Seen to catch: rays through the middle of the lens in place of the transmittance that paths see; edge pixels found by
/// rays through that middle alone, which leave most of the variance.
#[test]
fn the_mean_through_a_lens_is_that_of_paths_alone() {
    let scene = edge(gray(30.0, 300.0, 0.0, 1.3));
    // The camera is 10 m away.
    let lens = Some(Lens { radius: 1e-3, focus: 5.0 });
    let [alone, known] = [1, 8].map(|paths| brightness(&scene, lens, paths));
    assert_equal("8 paths", known, alone);
    let variance = (known.error / alone.error).powi(2);
    println!("variance {variance:.4} of one path's");
    assert!(variance < 0.02, "variance {variance:.4} of one path's");
}

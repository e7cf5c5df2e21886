//! The control variate of silhouette pixels removes noise and leaves the mean.

use crate::{
    error_bars::{Scene, edge, of_paths},
    means::{lamp, sun},
};
use gather::{Input, Passes, Settings, estimator::Estimator, film::Pixel};
use glam::DVec3;
use rayon::prelude::*;
use scene::{Camera, Lens};
use std::{ops::Range, slice::from_ref};
use test_support::{
    EFFORT,
    meshes::{Part, slab, world},
    pipeline::{cloud, gray, input, orthographic},
    z_test::{Estimate, assert_equal},
};

/// Number of images in each mean.
const IMAGES: u64 = 4000 * EFFORT;

/// Number of images in each mean of images with more paths.
const FEW_IMAGES: u64 = 600 * EFFORT;

/// Mean radiance of the whole image, for independent random numbers of gathers and camera paths.
fn brightness(scene: &Scene, lens: Option<Lens>, paths_per_pixel: u32) -> Estimate {
    let settings = of_paths(Estimator::Exhaustive, paths_per_pixel);
    let first = 1_000_000 * u64::from(paths_per_pixel);
    brightness_of(scene, lens, first..first + IMAGES, |input, seed| {
        let rendered = gather::render(input, &Settings { seed, ..settings.clone() }, |_| ());
        assert_eq!(rendered.counts.edge_pixels > 10, paths_per_pixel > 1);
        rendered.pixels
    })
}

/// The same of images from any source, by their seeds.
fn brightness_of(
    scene: &Scene,
    lens: Option<Lens>,
    seeds: Range<u64>,
    render: impl Fn(&Input, u64) -> Vec<Pixel> + Sync,
) -> Estimate {
    let cloud = cloud(&scene.world, &(scene.sampling)(20, 1));
    let media = [scene.medium.clone()];
    let camera = Camera { lens, ..orthographic(scene.towards, scene.half_height) };
    let input = input(&scene.world, from_ref(&cloud), &media, &camera);
    let image = |seed: u64| render(&input, seed).iter().map(|p| p.beauty().element_sum()).sum();
    Estimate::of(&seeds.into_par_iter().map(image).collect::<Vec<f64>>())
}

/// With one path a pixel the control variate is off, which gives the mean to compare with.
///
/// Seen to catch: what is known of a path left in; one ray of sixteen left out of the count.
#[test]
fn the_mean_is_that_of_paths_alone() {
    // The medium is so thin that the light below varies little within a pixel.
    let scene = edge(gray(30.0, 300.0, 0.0, 1.3));
    let alone = brightness(&scene, None, 1);
    // Measured as a share of the variance of one path: 0.50, 0.22 and 0.029 without the control variate, and 0.015, 0.007
    // and 0.001 with it.
    for (paths, most) in [(2, 0.03), (3, 0.014), (8, 0.003)] {
        let known = brightness(&scene, None, paths);
        assert_equal(&format!("{paths} paths"), known, alone);
        let variance = (known.error / alone.error).powi(2);
        println!("{paths} paths: variance {variance:.3} of one path's");
        assert!(variance < most, "{paths} paths: variance {variance:.3} of one path's");
    }
}

/// An image whose pixels share their paths after the first four.
fn shared(input: &Input, settings: &Settings) -> Vec<Pixel> {
    let mut passes = Passes::new(input, settings);
    passes.pass(4, &|_| ());
    passes.share_out();
    passes.plan(settings.paths_per_pixel - 4);
    passes.pass(settings.paths_per_pixel - 4, &|_| ());
    let rendered = passes.image();
    let [fewest, most] = rendered.fewest_and_most;
    assert!(fewest < settings.paths_per_pixel && settings.paths_per_pixel < most, "{fewest} to {most} paths");
    rendered.pixels
}

/// Pixels that share their paths by the noise of their neighbors have the mean of those that all have as many.
///
/// Seen to catch: shares by the noise of the pixel itself, which make the image 1.5 % darker.
#[test]
fn the_mean_of_shared_paths_is_that_of_paths_alone() {
    let scene = edge(gray(30.0, 300.0, 0.0, 1.3));
    let of = |first: u64, render: fn(&Input, &Settings) -> Vec<Pixel>| {
        let settings = of_paths(Estimator::Cut { accuracy: 0.1 }, 8);
        brightness_of(&scene, None, first..first + FEW_IMAGES, |input, seed| {
            render(input, &Settings { seed, ..settings.clone() })
        })
    };
    let (alone, shared) =
        (of(20_000_000, |input, settings| gather::render(input, settings, |_| ()).pixels), of(30_000_000, shared));
    assert_equal("shared paths", shared, alone);
    assert!(shared.relative_error() < 3e-3, "{shared:?} is too rough to tell");
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

/// A wall on a floor, seen at a low angle: near its far end the floor mirrors the wall, the more the lower the ray.
fn groove() -> Scene {
    let mut mesh = slab(DVec3::new(3e-3, 0.5e-3, 3e-3), 2);
    let (wall, count) = (slab(DVec3::new(0.5e-3, 1e-3, 3e-3), 2), mesh.positions.len() as u32);
    mesh.positions.extend(wall.positions.iter().map(|p| *p + DVec3::new(-2e-3, 1.51e-3, 0.0).as_vec3()));
    mesh.triangles.extend(wall.triangles.iter().map(|corners| corners.map(|corner| corner + count)));
    let world = world(&[Part::translucent(mesh)], &[sun(DVec3::ONE), lamp()], DVec3::ZERO);
    let mut scene = edge(gray(30.0, 300.0, 0.0, 1.5));
    (scene.world, scene.towards) = (world, DVec3::new(1.0, 0.15, 0.2));
    scene
}

/// The same where a surface mirrors another.
///
/// Seen to catch: the share of a mirrored ray without the transmittance of the second surface; what is known of the
/// mirrored light of a path left in.
#[test]
fn the_mean_of_mirrored_light_is_that_of_paths_alone() {
    let scene = groove();
    let [alone, known] = [1, 8].map(|paths| brightness(&scene, None, paths));
    assert_equal("8 paths", known, alone);
    let variance = (known.error / alone.error).powi(2);
    println!("variance {variance:.4} of one path's");
    assert!(variance < 0.045, "variance {variance:.4} of one path's");
}

//! Numbers beyond float32, the range of every file, are found and named, and none is written.

use bssrdf::Model;
use formats::cloud::Sample;
use gather::{Rendered, Settings, render};
use glam::{DVec3, Vec3};
use sample_surface::{Plan, SampleError, Surfaces};
use std::slice::from_ref;
use test_support::{
    meshes::{Light, Part, World, quad, world},
    pipeline::{MODELS, by_area, cloud, filed, gray, input, orthographic, sampled, settings},
    planted::{Halves, planted, stored},
};

fn under_a_sun(irradiance: DVec3) -> World {
    let sun = Light::Directional { towards: DVec3::Z, irradiance };
    world(&[Part::translucent(quad(0.05, 0.0, 1))], &[sun], DVec3::ZERO)
}

/// A square of 10 cm fills the middle of the image; all samples carry `flux`. If the halves of the cloud are `twins`,
/// they hold the same samples, so that the estimated variance is zero.
fn rendered(flux: Vec3, twins: bool, settings: &Settings) -> Rendered {
    let world = under_a_sun(DVec3::ONE);
    let drawn = cloud(&world, &by_area(64, 0));
    let halves = stored(&drawn)[0].clone().map(|half| half.into_iter().map(|s| Sample { flux, ..s }).collect());
    let [one, other]: Halves = halves;
    let halves = if twins { [one.clone(), one] } else { [one, other] };
    let cloud = filed(&planted(drawn.meta(), &[halves]));
    let (media, camera) = ([gray(0.0, 1e3, 0.0, 1.3)], orthographic(DVec3::Z, 0.1));
    let input = input(&world, from_ref(&cloud), &media, &camera);
    render(&input, settings, |_| ())
}

/// Finite flux, but radiance beyond float32: exactly those pixels are counted, and the first of them is named.
#[test]
fn radiance_beyond_float32_is_counted_and_placed() {
    for model in MODELS {
        let settings = settings(model, 12, 12);
        let rendered = rendered(Vec3::new(1.0, 1e38, 1.0), true, &settings);
        let beyond = |(k, p): (usize, &gather::film::Pixel)| (p.beauty().y > f64::from(f32::MAX)).then_some(k);
        let expected: Vec<usize> = rendered.pixels.iter().enumerate().filter_map(beyond).collect();
        assert!(expected.len() > 8 && expected.len() < 40, "{expected:?}");
        assert_eq!(rendered.non_finite_count, expected.len() as u64);
        assert_eq!(rendered.non_finite, expected[..8]);
        assert!(rendered.pixels.iter().all(|p| p.beauty().is_finite()), "float64 holds all of it");
    }
    let harmless = self::rendered(Vec3::splat(1e30), true, &settings(Model::StandardDipole, 12, 12));
    assert_eq!((harmless.non_finite_count, harmless.non_finite.len()), (0, 0));
}

/// A variance is a square: it leaves float32 long before the radiance does, and is stored as the largest float32. The
/// variance of the cloud is part of it: one path a pixel estimates it.
///
/// Seen to catch: an image refused because of the variance of a valid pixel.
#[test]
fn variance_beyond_float32_is_the_largest_number_of_the_file() {
    for paths_per_pixel in [1, 4] {
        let settings = Settings { paths_per_pixel, filter: gather::Filter::Box, ..settings(MODELS[0], 12, 12) };
        let rendered = |flux: f32| rendered(Vec3::splat(flux), false, &settings);
        let (strong, plain) = (rendered(1e25), rendered(1.0));
        let beyond = |p: &gather::film::Pixel| p.variance().x > f64::from(f32::MAX);
        assert!(strong.pixels.iter().any(beyond) && strong.non_finite_count == 0);
        let image = gather::film::image(&strong.pixels, 12, 12);
        for (pixel, stored) in strong.pixels.iter().zip(image.channel("variance.R").expect("it has one")) {
            assert_eq!(*stored, pixel.variance().x.clamp(0.0, f64::from(f32::MAX)) as f32);
        }
        let [one, other] = [&strong, &plain].map(|image| gather::film::relative_error(&image.pixels).expect("light"));
        assert!((one / other - 1.0).abs() < 1e-4, "{one} is not {other}");
    }
}

/// Light whose flux leaves float32, or float64: sampling refuses to make a cloud, and counts the samples.
#[test]
fn flux_beyond_float32_makes_no_cloud() {
    for irradiance in [DVec3::splat(1e41), DVec3::new(0.0, 0.0, 9e76)] {
        let mut world = under_a_sun(DVec3::ONE);
        world.scene.file_lights.clear();
        let light = scene::light::DirectionalLight { direction: DVec3::Z, irradiance };
        world.scene.file_lights.push(Box::new(light));
        let options = sampled(&under_a_sun(DVec3::ONE), &by_area(1, 0)).meta.options;
        let settings = sample_surface::Settings { samples: 100, options };
        let (surfaces, _) = Surfaces::translucent(&world.scene).expect("the scene has a surface");
        let plan = Plan::new(&world.scene, &settings, surfaces).expect("the scene has light");
        match sample_surface::sample(&world.scene, &world.rays, &settings, &plan, |_| ()) {
            Err(SampleError::NotFinite { samples }) => assert_eq!(samples, 100),
            _ => panic!("a cloud with infinite flux"),
        }
    }
}

/// Light whose flux is below float32: the samples are lit but cannot be stored; they are counted.
#[test]
fn flux_below_float32_is_dropped_and_counted() {
    let mut world = under_a_sun(DVec3::ONE);
    world.scene.file_lights.clear();
    let light = scene::light::DirectionalLight { direction: DVec3::Z, irradiance: DVec3::splat(1e-60) };
    world.scene.file_lights.push(Box::new(light));
    let cloud = cloud(&world, &by_area(100, 0));
    assert_eq!((cloud.len(), cloud.meta().samples_dropped["underflow"]), (0, 100));
}

//! Images of objects under an environment map.

use bssrdf::Model;
use gather::{Filter, Rendered, Settings};
use glam::{DVec3, Vec3};
use scene::{
    NormalKind,
    light::{Environment, EnvironmentMap},
};
use std::{
    f64::consts::{PI, TAU},
    slice::from_ref,
};
use test_support::{
    EFFORT,
    meshes::{Part, World, sphere, world},
    pipeline::{cloud, gray, input, orthographic, settings, stratified},
    z_test::{Estimate, assert_equal},
};

/// An environment map of one color.
fn even(color: DVec3) -> Environment {
    let map = EnvironmentMap::new((24, 12), vec![color.as_vec3(); 288], 1.0, 10.0).expect("good pixels");
    Environment::Map(map.into())
}

fn ball(environment: Environment) -> World {
    let mut world = world(&[Part::translucent(sphere(1e-2, 3))], &[], DVec3::ZERO);
    world.scene.environment = environment;
    world
}

/// The ball with an albedo of `sigma_s` over its sum with 20/m, seen under its light.
fn render(environment: Environment, sigma_s: f64, seed: u64) -> Rendered {
    let world = ball(environment);
    let (cloud, media) = (cloud(&world, &stratified(1 << 12, seed)), [gray(20.0, sigma_s, 0.0, 1.3)]);
    let camera = orthographic(DVec3::new(1.0, 2.0, 3.0), 1.1e-2);
    let input = input(&world, from_ref(&cloud), &media, &camera);
    let settings = settings(Model::StandardDipole, 8, 8);
    gather::render(&input, &Settings { filter: Filter::Box, paths_per_pixel: 2, ..settings }, |_| ())
}

/// An environment map of one color acts as that constant color: what rays see agrees to the last bit, and the light
/// on the object agrees in the mean.
///
/// Seen to catch: the probability of a pixel without that of its tile.
#[test]
fn a_picture_of_one_color_is_a_constant_environment() {
    let color = DVec3::new(0.5, 0.25, 2.0);
    let both = || [Environment::Constant(color), even(color)];
    let clear = both().map(|e| render(e, 0.0, 1).pixels.iter().map(|p| p.beauty()).collect::<Vec<_>>());
    assert_eq!(clear[0], clear[1]);
    let seeds = 12 * EFFORT;
    let sums = both().map(|environment| {
        let one = |seed: u64| {
            let image = render(environment.clone(), 2000.0, seed);
            image.pixels.iter().map(|p| p.beauty().z).sum::<f64>()
        };
        Estimate::of(&(0..seeds).map(one).collect::<Vec<f64>>())
    });
    assert!(sums[1].relative_error() < 0.01, "{:?}", sums[1]);
    assert_equal("picture and constant", sums[1], sums[0]);
}

/// The mean flux of the samples is the light that crosses the shadow of the object in every direction, `Φ = ∫L P dω`.
/// For a closed convex object the projected area `P` has the mean `A/4` over any hemisphere; towards the sun, the
/// projected area of the polyhedron is summed over the sun's pixel.
///
/// Seen to catch: the probability of a pixel without that of its tile; one solid angle for all pixels; `A/4` towards
/// the sun (0.08 %); a rotation the other way (0.14 %).
#[test]
fn a_convex_body_gathers_what_its_shadow_would() {
    let size = (64, 32);
    let (column, row, sun, degrees) = (50, 7, 1e5_f32, 33.0);
    let mut pixels: Vec<Vec3> = (0..64 * 32).map(|k| Vec3::splat(if k < 1024 { 1.0 } else { 0.125 })).collect();
    pixels[row * 64 + column] = Vec3::splat(sun);
    let map = EnvironmentMap::new(size, pixels, 1.0, degrees).expect("good pixels");
    let world = ball(Environment::Map(map.into()));
    let mesh = &world.scene.mesh;
    let facets: Vec<DVec3> = (0..mesh.triangles.len())
        .map(|k| mesh.area(k) * mesh.point(k as u32, [1.0, 0.0, 0.0], NormalKind::Geometric).normal)
        .collect();
    let shadow = |direction: DVec3| facets.iter().map(|facet| facet.dot(direction).max(0.0)).sum::<f64>();
    // The middle of the map is +X and its columns proceed to +Z; the map is turned about +Y.
    let cosine = |row: f64| (PI * row / 32.0).cos();
    let offset = |k: u32| (f64::from(k) + 0.5) / 16.0;
    let toward = |x: u32, y: u32| {
        let angle = TAU * ((column as f64 + offset(x)) / 64.0 - 0.5) - f64::to_radians(degrees);
        let height = cosine(row as f64) * (1.0 - offset(y)) + cosine(row as f64 + 1.0) * offset(y);
        let radius = (1.0 - height * height).sqrt();
        DVec3::new(radius * angle.cos(), height, radius * angle.sin())
    };
    let mean_shadow = (0..256).map(|k| shadow(toward(k % 16, k / 16))).sum::<f64>() / 256.0;
    let solid_angle = (cosine(row as f64) - cosine(row as f64 + 1.0)) * TAU / 64.0;
    let area: f64 = facets.iter().map(|facet| facet.length()).sum();
    let expected = area / 4.0 * TAU * 1.125 + (f64::from(sun) - 1.0) * solid_angle * mean_shadow;
    let runs: Vec<f64> = (0..16 * EFFORT)
        .map(|seed| test_support::pipeline::sampled(&world, &stratified(1 << 12, seed)).meta.mean_flux_w[1])
        .collect();
    let flux = Estimate::of(&runs);
    assert!(flux.relative_error() < 0.005, "{flux:?}");
    test_support::z_test::assert_mean("flux", flux, expected);
}

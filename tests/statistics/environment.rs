//! Images of bodies under a picture of light from all around.

use bssrdf::Model;
use gather::{Filter, Input, Rendered, Settings};
use glam::{DVec3, Vec3};
use scene::light::{Environment, EnvironmentMap};
use support::{
    EFFORT,
    meshes::{Part, World, sphere, world},
    pipeline::{cloud, grey, orthographic, settings, stratified},
    z_test::{Estimate, assert_equal},
};

/// A picture of one colour.
fn even(color: DVec3) -> Environment {
    let map = EnvironmentMap::new((24, 12), vec![color.as_vec3(); 288], 1.0, 10.0).expect("good pixels");
    Environment::Map(map.into())
}

fn ball(environment: Environment) -> World {
    let mut world = world(&[Part::translucent(sphere(1e-2, 3))], &[], DVec3::ZERO);
    world.scene.add_environment(environment);
    world
}

/// The ball with an albedo of `sigma_s` over its sum with 20/m, seen under its light.
fn render(environment: Environment, sigma_s: f64, seed: u64) -> Rendered {
    let world = ball(environment.clone());
    let (cloud, media) = (cloud(&world, &stratified(1 << 12, seed)), [grey(20.0, sigma_s, 0.0, 1.3)]);
    let camera = orthographic(DVec3::new(1.0, 2.0, 3.0), 1.1e-2);
    let input = Input {
        scene: &world.scene,
        rays: &world.rays,
        clouds: std::slice::from_ref(&cloud),
        media: &media,
        camera: &camera,
    };
    let settings = settings(Model::StandardDipole, 8, 8);
    gather::render(&input, &Settings { environment, filter: Filter::Box, paths_per_pixel: 2, ..settings }, |_| ())
}

/// A picture of one colour is that colour: what rays see is the same to the last bit, and the light on the body is on
/// average.
///
/// Seen to catch: the probability of a pixel without that of its window.
#[test]
fn a_picture_of_one_colour_is_a_constant_environment() {
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

/// The mean flux of the samples is the area times the mean irradiance: of a closed convex body half of the light that
/// crosses each place, `Φ = A ∫L dω/4`, however bright the sun is.
///
/// Seen to catch: the probability of a pixel without that of its window; one solid angle for all pixels.
#[test]
fn a_convex_body_gathers_a_quarter_of_its_area_from_all_sides() {
    let size = (64, 32);
    let mut pixels: Vec<Vec3> = (0..64 * 32).map(|k| Vec3::splat(if k < 1024 { 1.0 } else { 0.125 })).collect();
    pixels[7 * 64 + 50] = Vec3::splat(1e5);
    let row = |row: f64| (std::f64::consts::PI * row / 32.0).cos();
    let sun = (1e5 - 1.0) * (row(7.0) - row(8.0)) * std::f64::consts::TAU / 64.0;
    let all = std::f64::consts::TAU * 1.125 + sun;
    let map = EnvironmentMap::new(size, pixels, 1.0, 33.0).expect("good pixels");
    let world = ball(Environment::Map(map.into()));
    let mesh = &world.scene.mesh;
    // The facets' own area and light: a convex polyhedron.
    let area: f64 = (0..mesh.triangles.len()).map(|k| mesh.area(k)).sum();
    let runs: Vec<f64> = (0..16 * EFFORT)
        .map(|seed| support::pipeline::sampled(&world, &stratified(1 << 12, seed)).meta.mean_flux_w[1])
        .collect();
    let flux = Estimate::of(&runs);
    assert!(flux.relative_error() < 0.005, "{flux:?}");
    support::z_test::assert_mean("flux", flux, area * all / 4.0);
}

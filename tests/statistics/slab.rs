//! Reflectance of a plane: sampling and the exhaustive sum together against the tabulated integrals.

use bssrdf::{Medium, Model, built_in, fresnel};
use gather::{Settings, estimator::Estimator};
use glam::DVec3;
use rayon::prelude::*;
use sample_surface::Choice;
use serde_json::Value;
use std::{f64::consts::PI, slice::from_ref};
use test_support::{
    EFFORT,
    meshes::{Light, Part, World, graded_disc, world},
    pipeline::{Lit, Point, Sampling, by_area, cloud, input, orthographic, settings},
    quadrature::{Annulus, integrate, plane_integral},
    z_test::{Estimate, assert_mean},
};

/// The medium of these tests; its integrals are tabulated for all channels.
fn skin() -> Medium {
    built_in("skin1").expect("a built-in medium")
}

/// `I(θ) = ∫ S_bare dA` of [`skin`] under the column `key`; the table is in 1/sr, whatever the unit of length.
fn tabulated(model: &str, key: &str) -> DVec3 {
    let file: Value =
        serde_json::from_str(include_str!("../reference/plane_reflectance.json")).expect("the reference file is JSON");
    let entries = file["entries"].as_array().expect("a list");
    let channel = |name: &str| {
        let entry = entries.iter().find(|e| e["material"] == "skin1" && e["channel"] == name).expect("skin1");
        entry[model][key].as_f64().expect("a number")
    };
    DVec3::new(channel("R"), channel("G"), channel("B"))
}

/// A disc 16 diffusion lengths wide. Its triangles shrink towards the center and are chosen uniformly, so that a few
/// thousand samples resolve S at every distance.
fn disc(lights: &[Light], environment: DVec3) -> World {
    world(&[Part::translucent(graded_disc(2e-5, 60e-3, 45))], lights, environment)
}

fn sampling(samples: u64, seed: u64) -> Sampling {
    Sampling { choice: Choice::Uniform, ..by_area(samples * EFFORT, seed) }
}

/// Independent clouds of each test; every test has its own range of seeds.
const SEEDS: u64 = 32;

/// Fails unless the mean over clouds is as expected and its standard error is small enough to tell.
fn assert_radiance(what: &str, runs: &[DVec3], expected: DVec3) {
    for c in 0..3 {
        let estimate = Estimate::of(&runs.iter().map(|r| r[c]).collect::<Vec<_>>());
        assert_mean(&format!("{what}, channel {c}"), estimate, expected[c]);
        assert!(estimate.relative_error() < 0.01, "{estimate:?} is too rough to tell");
        // This level is stricter than the tests' common one; these seeds meet it.
        assert!(estimate.deviation(expected[c]).abs() < 4.0);
    }
}

/// `L_r` at the center by the exhaustive sum over each cloud.
fn radiance_at_center(world: &World, model: Model, first_seed: u64) -> Vec<DVec3> {
    let (medium, center) = (skin(), Point { position: DVec3::ZERO, normal: DVec3::Z });
    let run = |seed: u64| {
        let cloud = cloud(world, &sampling(20_000, seed));
        Lit::new(&cloud, &medium, model).radiance(Estimator::Exhaustive, center, 0)
    };
    (first_seed..first_seed + SEEDS).into_par_iter().map(run).collect()
}

/// `L_r = T12(θ) E⊥ cos θ I(θ)`.
///
/// Seen to catch: the cosine of the light left out of E; T12 left out; the uniform density without N; the density of
/// the area rule with the uniform choice; the square root of the triangle's point left out; α' left out of the standard
/// dipole's strength; the unrefracted direction for ω12 (directional dipole at 60°).
fn plane_reflectance(model: Model, degrees: f64, integral: DVec3) {
    const IRRADIANCE: f64 = 2.0;
    let (sine, cosine) = f64::to_radians(degrees).sin_cos();
    let sun = Light::Directional { towards: DVec3::new(sine, 0.0, cosine), irradiance: DVec3::splat(IRRADIANCE) };
    let first_seed = SEEDS * (2 * model as u64 + u64::from(degrees > 0.0));
    let runs = radiance_at_center(&disc(&[sun], DVec3::ZERO), model, first_seed);
    let expected = fresnel::transmittance(cosine, skin().eta) * IRRADIANCE * cosine * integral;
    assert_radiance(&format!("{} {degrees}°", model.name()), &runs, expected);
}

#[test]
fn directional_dipole_from_above() {
    plane_reflectance(Model::DirectionalDipole, 0.0, tabulated("directional", "I_0deg"));
}

#[test]
fn directional_dipole_at_60_degrees() {
    plane_reflectance(Model::DirectionalDipole, 60.0, tabulated("directional", "I_60deg"));
}

#[test]
fn better_dipole() {
    plane_reflectance(Model::BetterDipole, 0.0, tabulated("better", "I_0deg"));
    plane_reflectance(Model::BetterDipole, 60.0, tabulated("better", "I_0deg"));
}

#[test]
fn standard_dipole() {
    plane_reflectance(Model::StandardDipole, 0.0, tabulated("standard", "I_0deg"));
    plane_reflectance(Model::StandardDipole, 60.0, tabulated("standard", "I_0deg"));
}

/// Light from all sides: `L_r = L I ∫ T12 cos θ dω`.
///
/// Seen to catch: directions uniform over the hemisphere (a lost cosine); the π of the density left out of E.
#[test]
fn a_constant_sky_lights_the_plane() {
    const SKY: f64 = 0.5;
    let runs = radiance_at_center(&disc(&[], DVec3::splat(SKY)), Model::StandardDipole, 2000);
    let enters = 2.0 * PI * integrate(0.0, 1.0, 20, |c| fresnel::transmittance(c, skin().eta) * c);
    assert_radiance("constant sky", &runs, SKY * enters * tabulated("standard", "I_0deg"));
}

/// `I(θ)` of the half-space model, which is not tabulated.
fn integral_of_half_space(sine: f64) -> DVec3 {
    let model = Model::HalfSpace.of(&skin());
    let annulus = Annulus { inner: 1e-9, outer: 0.2 };
    DVec3::from_array([0, 1, 2].map(|c| plane_integral(&*model, c, sine / skin().eta, annulus)))
}

#[test]
fn half_space_model() {
    plane_reflectance(Model::HalfSpace, 0.0, integral_of_half_space(0.0));
    plane_reflectance(Model::HalfSpace, 60.0, integral_of_half_space(60f64.to_radians().sin()));
}

/// The same through `gather::render` and an interface, where the path takes the refracted branch: `T21(θ_o) L_r`.
///
/// Seen to catch: T21 of the chosen refraction applied again (S for `S_gather`); a lost 1/K; the exit lobe of the
/// half-space model left out, or taken at the cosine inside.
#[test]
fn scattered_light_is_seen_through_the_interface() {
    seen_at_75_degrees(Model::BetterDipole, tabulated("better", "I_0deg"));
    seen_at_75_degrees(Model::HalfSpace, integral_of_half_space(0.0));
}

fn seen_at_75_degrees(model: Model, integral: DVec3) {
    let world = disc(&[Light::Directional { towards: DVec3::Z, irradiance: DVec3::ONE }], DVec3::ZERO);
    let (sine, cosine) = f64::to_radians(75.0).sin_cos();
    let camera = orthographic(DVec3::new(sine, 0.0, cosine), 1e-6);
    let media = [skin()];
    let run = |seed: u64| {
        let cloud = cloud(&world, &sampling(10_000, seed));
        let input = input(&world, from_ref(&cloud), &media, &camera);
        let settings = Settings { paths_per_pixel: 256, seed, ..settings(model, 1, 1) };
        gather::render(&input, &settings, |_| ()).pixels[0].beauty()
    };
    let runs: Vec<DVec3> = (1000..1000 + SEEDS).into_par_iter().map(run).collect();
    let interface = fresnel::transmittance(cosine, skin().eta) * fresnel::transmittance(1.0, skin().eta);
    let lobe = DVec3::from_array(model.exit_lobe(&skin()).map(|[a, b]| a + b * cosine));
    assert_radiance("seen at 75°", &runs, interface * lobe * integral);
}

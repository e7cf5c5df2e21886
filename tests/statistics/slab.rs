//! Reflectance of a plane: the whole of phase one and of the sum against the tabulated integrals.

use bssrdf::{Coefficients, Medium, Model, fresnel};
use gather::{Input, Settings, estimator::Estimator};
use glam::DVec3;
use rayon::prelude::*;
use sample_surface::Choice;
use support::{
    EFFORT,
    meshes::{Light, Part, graded_disc, world},
    pipeline::{Lit, Point, Sampling, cloud, medium, orthographic, settings},
    z_test::{Estimate, assert_mean},
};

/// skin1 in 1/m.
fn skin() -> Medium {
    let channel = |sigma_a, sigma_s| Coefficients { sigma_a, sigma_s, asymmetry: 0.0 };
    medium([channel(32.0, 740.0), channel(170.0, 880.0), channel(480.0, 1010.0)], 1.3)
}

/// `I(θ) = ∫ S_bare dA` of skin1, R, G, B: of `reference/plane_reflectance.json`, where `equations` checks them.
const DIRECTIONAL_0: [f64; 3] = [0.21577343954968578, 0.13262733038260685, 0.09628238574668761];
const DIRECTIONAL_60: [f64; 3] = [0.22713426527756994, 0.14854171813154468, 0.11334596641510929];
const BETTER: [f64; 3] = [0.13729653758721413, 0.055238981666256924, 0.023811887243136126];
const STANDARD: [f64; 3] = [0.13876130461294905, 0.07235883312011043, 0.04169728912063075];

/// `L_r = T12(θ) E⊥ cos θ I(θ)` at the centre of a disc 16 diffusion lengths wide, for a mean of independent clouds.
///
/// Triangles shrink towards the centre and are chosen uniformly, so that a few thousand samples find S at every
/// distance.
///
/// Seen to catch: the cosine of the light left out of E; T12 left out; the uniform density without N; the density of
/// the area rule with the uniform choice; α' left out of the standard dipole's strength; μ0 taken of the unrefracted
/// direction.
fn plane_reflectance(model: Model, degrees: f64, integrals: [f64; 3]) {
    const SEEDS: u64 = 32;
    const IRRADIANCE: f64 = 2.0;
    let (sine, cosine) = f64::to_radians(degrees).sin_cos();
    let sun = Light::Directional { towards: DVec3::new(sine, 0.0, cosine), irradiance: DVec3::splat(IRRADIANCE) };
    let world = world(&[Part::translucent(graded_disc(2e-5, 60e-3, 45))], &[sun], DVec3::ZERO);
    let medium = skin();
    let centre = Point { position: DVec3::ZERO, normal: DVec3::Z };
    let run = |seed: u64| {
        let cloud = cloud(&world, &Sampling { samples: 20_000 * EFFORT, choice: Choice::Uniform, seed });
        Lit::new(&cloud, &medium, model).radiance(Estimator::Exhaustive, centre, 0)
    };
    // Seeds of its own for every model and angle.
    let first = SEEDS * (2 * model as u64 + u64::from(degrees > 0.0));
    let runs: Vec<DVec3> = (first..first + SEEDS).into_par_iter().map(run).collect();
    for (c, integral) in integrals.into_iter().enumerate() {
        let values: Vec<f64> = runs.iter().map(|r| r[c]).collect();
        let estimate = Estimate::of(&values);
        let expected = fresnel::transmittance(cosine, medium.eta) * IRRADIANCE * cosine * integral;
        assert_mean(&format!("{} {degrees}° channel {c}", model.name()), estimate, expected);
        assert!(estimate.relative_error() < 0.01, "{estimate:?} is too rough to tell");
        assert!(estimate.deviation(expected).abs() < 4.0);
    }
}

#[test]
fn directional_dipole_from_above() {
    plane_reflectance(Model::DirectionalDipole, 0.0, DIRECTIONAL_0);
}

#[test]
fn directional_dipole_at_60_degrees() {
    plane_reflectance(Model::DirectionalDipole, 60.0, DIRECTIONAL_60);
}

#[test]
fn better_dipole() {
    plane_reflectance(Model::BetterDipole, 0.0, BETTER);
    plane_reflectance(Model::BetterDipole, 60.0, BETTER);
}

#[test]
fn standard_dipole() {
    plane_reflectance(Model::StandardDipole, 0.0, STANDARD);
    plane_reflectance(Model::StandardDipole, 60.0, STANDARD);
}

/// The same through `gather::render` and the interface, of which the chosen refraction is part: `T21(θ_o) L_r`.
///
/// Seen to catch: T21 of the chosen refraction applied again (S for `S_gather`); a lost 1/K.
#[test]
fn scattered_light_is_seen_through_the_interface() {
    let sun = Light::Directional { towards: DVec3::Z, irradiance: DVec3::ONE };
    let world = world(&[Part::translucent(graded_disc(2e-5, 60e-3, 45))], &[sun], DVec3::ZERO);
    let (sine, cosine) = f64::to_radians(75.0).sin_cos();
    let camera = orthographic(DVec3::new(sine, 0.0, cosine), 1e-6);
    let media = [skin()];
    let run = |seed: u64| {
        let cloud = cloud(&world, &Sampling { samples: 10_000 * EFFORT, choice: Choice::Uniform, seed });
        let input = Input { scene: &world.scene, rays: &world.rays, cloud: &cloud, media: &media, camera: &camera };
        let settings = Settings { paths_per_pixel: 256, seed, ..settings(Model::BetterDipole, 1, 1) };
        gather::render(&input, &settings, |_| ()).pixels[0].beauty()
    };
    let runs: Vec<DVec3> = (1000..1032).into_par_iter().map(run).collect();
    let interface = fresnel::transmittance(cosine, 1.3) * fresnel::transmittance(1.0, 1.3);
    for (c, integral) in BETTER.into_iter().enumerate() {
        let estimate = Estimate::of(&runs.iter().map(|r| r[c]).collect::<Vec<_>>());
        assert_mean(&format!("seen at 75°, channel {c}"), estimate, interface * integral);
        assert!(estimate.relative_error() < 0.01, "{estimate:?} is too rough to tell");
    }
}

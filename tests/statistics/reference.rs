//! Images by random walks: light that walks meet where they leave. Light that they are connected to is tested in
//! `crates/walks`.

use bsdf::Stated;
use bssrdf::{Medium, Model};
use gather::{Filter, Input, Settings};
use glam::DVec3;
use scene::{Camera, GlossStated};
use std::{f64::consts::PI, slice::from_ref};
use test_support::{
    EFFORT,
    meshes::{Light, Mesh, Part, World, quad, sphere, world},
    pipeline::{cloud, gray, orthographic, settings, stratified},
    z_test::{Estimate, assert_equal},
};

/// Mean beauty of the green channel of images of an object about the origin, one for each seed.
fn images(world: &World, medium: &Medium, towards: DVec3, seeds: u64) -> Estimate {
    let cloud = cloud(world, &stratified(64, 1));
    let camera = orthographic(towards, 0.6e-2);
    // It stands inside the shells below.
    let camera = Camera { position: -0.3 * camera.forward, ..camera };
    let input = Input {
        scene: &world.scene,
        rays: &world.rays,
        clouds: from_ref(&cloud),
        media: from_ref(medium),
        camera: &camera,
        tints: &[],
        calibration: None,
    };
    let image = |seed: u64| {
        let settings = Settings {
            filter: Filter::Box,
            paths_per_pixel: 16,
            reference: true,
            max_depth: 1000,
            seed,
            ..settings(Model::StandardDipole, 6, 6)
        };
        let rendered = gather::render(&input, &settings, |_| ());
        assert_eq!(rendered.counts.walks_escaped + rendered.counts.walks_trapped, 0);
        rendered.pixels.iter().map(|p| p.beauty().y).sum::<f64>() / 36.0
    };
    Estimate::of(&(0..seeds).map(image).collect::<Vec<f64>>())
}

/// The roughness of a translucent material.
fn rough(roughness: f64) -> Option<GlossStated> {
    let dielectric = Stated::dielectric(1.5, 1.0, DVec3::ONE);
    Some(GlossStated { metallic: 0.0, roughness, texture: None, dielectric })
}

fn ball() -> Part {
    Part::translucent(sphere(1e-2, 3))
}

/// Without absorption and under a constant environment, everything looks like the environment, below a rough boundary too.
///
/// Seen to catch: the factor 1/η² for light that walks meet; walks that count without a collision; the share of met light
/// left out.
#[test]
fn a_furnace() {
    for (scattering, g, eta, roughness) in
        [(200.0, 0.0, 1.3, 0.0), (2000.0, 0.5, 1.5, 0.0), (2000.0, 0.0, 1.3, 0.4), (1000.0, 0.0, 1.5, 0.9)]
    {
        let mut world = world(&[ball()], &[], DVec3::splat(2.0));
        world.scene.materials[0].gloss = rough(roughness);
        let estimate = images(&world, &gray(0.0, scattering, g, eta), DVec3::new(1.0, 2.0, 3.0), 8 * EFFORT);
        assert!(estimate.relative_error() < 0.02, "{estimate:?} is too rough to tell");
        println!("{estimate:?}");
        // Where no light passes unscattered, every walk brings the same light, and there is no error.
        assert!((estimate.mean - 2.0).abs() < 4.5 * estimate.error + 1e-9, "{estimate:?}");
    }
}

/// An emitting shell around the object lights it as an environment does, and so does an opaque shell that is lit.
///
/// Seen to catch: emission not met; the light of opaque surfaces without their albedo.
#[test]
fn shells_that_emit_or_reflect() {
    let medium = gray(20.0, 600.0, 0.0, 1.3);
    let inward = || {
        let shell = sphere(1.0, 2);
        Mesh { triangles: shell.triangles.iter().map(|[a, b, c]| [*a, *c, *b]).collect(), ..shell }
    };
    let emitting = Part { color: DVec3::ZERO, emission: DVec3::ONE, ..Part::opaque(inward()) };
    let seeds = 12 * EFFORT;
    let view = DVec3::new(0.2, 0.3, 1.0);
    for roughness in [0.0, 0.6] {
        let lit = |mut world: World| {
            world.scene.materials[0].gloss = rough(roughness);
            images(&world, &medium, view, seeds)
        };
        let shell = lit(world(&[ball(), emitting.clone()], &[], DVec3::ZERO));
        let sky = lit(world(&[ball()], &[], DVec3::ONE));
        assert_equal(&format!("emitting shell, roughness {roughness}"), shell, sky);
    }

    // A screen behind the object, lit from above, adds what a screen does that emits ρ E/π.
    let screen = |color: f64, emission: f64| Part {
        color: DVec3::splat(color),
        emission: DVec3::splat(emission),
        ..Part::opaque(quad(1.0, -0.5, 1))
    };
    let sun = Light::Directional { towards: DVec3::new(0.6, 0.0, 0.8), irradiance: DVec3::splat(5.0) };
    let image = |screen: Part, lights: &[Light]| {
        images(&world(&[ball(), screen], lights, DVec3::ZERO), &medium, DVec3::new(0.6, 0.3, 0.4), seeds)
    };
    let added = image(screen(0.5, 0.0), &[sun]).minus(image(screen(0.0, 0.0), &[sun]));
    assert_equal("screen", added, image(screen(0.0, 0.5 * 5.0 * 0.8 / PI), &[]));
}

//! Thin walls show the light of both sides, and light what lies behind them: values that are known in closed form.

use glam::DVec3;
use rayon::prelude::*;
use scene::Camera;
use serde_json::json;
use std::f64::consts::PI;
use test_support::{
    EFFORT,
    meshes::{Light, Part, World, asset, imported, quad},
    pipeline::{MODELS, by_area, input, orthographic, sampled, settings},
    z_test::{Estimate, assert_mean},
};

const SEEDS: u64 = 32;
/// Half width of the square below, m.
const HALF_WIDTH: f64 = 5e-4;

const COLOR: DVec3 = DVec3::new(1.0, 0.5, 0.25);
/// What the wall lets through and reflects.
const THROUGH: DVec3 = DVec3::new(0.3, 0.6, 0.6);

/// A small square that is marked as a volume, and one metre above it a wall of 4 km, lit from one side.
fn world(towards: DVec3, irradiance: DVec3) -> World {
    let wall = Part { color: COLOR, ..Part::opaque(quad(2000.0, 1.0, 1)) };
    let light = Light::Directional { towards, irradiance };
    let mut asset = asset(&[Part::translucent(quad(HALF_WIDTH, 0.0, 2)), wall], &[light]);
    asset.json["materials"][1]["extensions"]["KHR_materials_diffuse_transmission"] =
        json!({ "diffuseTransmissionFactor": 0.6, "diffuseTransmissionColorFactor": [0.5, 1, 1] });
    imported(&asset, 1.0, DVec3::ZERO)
}

/// A camera above sees `ρ E/π` by a lamp above, and `τ E/π` by one below.
///
/// Seen to catch: light from behind left out; the shares of the sides exchanged.
#[test]
fn a_wall_has_the_light_of_both_sides() {
    for (towards, expected) in [(DVec3::new(0.6, 0.0, 0.8), 0.4 * COLOR), (DVec3::new(0.6, 0.0, -0.8), THROUGH)] {
        let world = world(towards, DVec3::splat(2.0));
        let camera = Camera { position: DVec3::new(10.0, 10.0, 8.0), ..orthographic(DVec3::Z, 0.5) };
        let rendered = gather::render(&input(&world, &[], &[], &camera), &settings(MODELS[0], 2, 2), |_| ());
        for pixel in &rendered.pixels {
            assert!(pixel.beauty().abs_diff_eq(expected * 1.6 / PI, 1e-6), "{towards}: {}", pixel.beauty());
        }
    }
}

/// A wall without end, lit from above, gives the square below `τ E`.
///
/// Seen to catch: the wall as dark from behind as an opaque surface; what it reflects in place of what it lets through.
#[test]
fn light_through_a_wall_reaches_what_lies_behind() {
    let irradiance = DVec3::new(1.0, 2.0, 3.0);
    let world = world(DVec3::new(0.6, 0.0, 0.8), irradiance);
    let area = (2.0 * HALF_WIDTH).powi(2);
    let power = |seed| sampled(&world, &by_area(2000 * EFFORT, seed)).meta.mean_flux_w;
    let powers: Vec<[f64; 3]> = (0..SEEDS).into_par_iter().map(power).collect();
    for c in 0..3 {
        let runs: Vec<f64> = powers.iter().map(|p| p[c] / area).collect();
        assert_mean(&format!("channel {c}"), Estimate::of(&runs), THROUGH[c] * 0.8 * irradiance[c]);
    }
}

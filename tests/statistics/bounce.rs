//! Light reflected by opaque surfaces: powers on a small square below a ceiling, known in closed form.

use glam::DVec3;
use rayon::prelude::*;
use sample_surface::Pattern;
use test_support::{
    EFFORT,
    meshes::{Light, Part, World, quad, world},
    pipeline::{Sampling, by_area, sampled},
    z_test::{Estimate, assert_mean},
};

const SEEDS: u64 = 32;
/// Half width of the square, m.
const HALF_WIDTH: f64 = 5e-4;

/// The ceiling is white, one metre above the square, wound upwards, and lit from below everywhere but over the
/// square.
fn below(ceiling: f64, more: &[Light]) -> World {
    let parts = [Part::translucent(quad(HALF_WIDTH, 0.0, 2)), Part::opaque(quad(ceiling, 1.0, 1))];
    let from_below = Light::Directional { towards: DVec3::new(0.6, 0.0, -0.8), irradiance: DVec3::new(1.0, 2.0, 3.0) };
    world(&parts, &[&[from_below], more].concat(), DVec3::ZERO)
}

/// Power over the square's area, W/m², by both patterns.
fn assert_irradiance(what: &str, world: &World, expected: DVec3) {
    for pattern in [Pattern::Independent, Pattern::Stratified] {
        let area = (2.0 * HALF_WIDTH).powi(2);
        let power = |seed| sampled(world, &Sampling { pattern, ..by_area(2000 * EFFORT, seed) }).meta.mean_flux_w;
        let powers: Vec<[f64; 3]> = (0..SEEDS).into_par_iter().map(power).collect();
        for c in 0..3 {
            let runs: Vec<f64> = powers.iter().map(|p| p[c] / area).collect();
            if runs.iter().all(|r| (r / expected[c] - 1.0).abs() < 1e-6) {
                continue; // even samples: all of them see the same
            }
            assert_mean(&format!("{what}, {}, channel {c}", pattern.name()), Estimate::of(&runs), expected[c]);
        }
    }
}

/// A ceiling without end reflects all that reaches it, `ρ E`.
///
/// Seen to catch: a fifth more light from the ceiling.
#[test]
fn an_endless_ceiling_gives_what_it_gets() {
    assert_irradiance("ceiling", &below(2000.0, &[]), 0.8 * DVec3::new(1.0, 2.0, 3.0));
}

/// A ceiling as wide as it is high above gives the form factor of a square seen from below its center, 0.55412
/// (`(4/π√2) atan(1/√2)`), beside direct light that passes it.
#[test]
fn a_finite_ceiling_beside_direct_light() {
    let sun = Light::Directional { towards: DVec3::new(0.96, 0.0, 0.28), irradiance: DVec3::splat(2.0) };
    let factor = 4.0 / (std::f64::consts::PI * 2f64.sqrt()) * 0.5f64.sqrt().atan();
    let expected = factor * 0.8 * DVec3::new(1.0, 2.0, 3.0) + 0.28 * 2.0;
    assert_irradiance("ceiling and sun", &below(1.0, &[sun]), expected);
}

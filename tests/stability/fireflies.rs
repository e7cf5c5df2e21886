//! Media whose channels decay at very different rates, on an object of one metre, where the variance of the note's
//! roulette is infinite.

use bssrdf::{Model, built_in};
use gather::{
    Settings,
    estimator::{Estimator, Rule},
    render,
};
use glam::DVec3;
use std::slice::from_ref;
use test_support::{
    meshes::{Light, Part, sphere, world},
    pipeline::{by_area, cloud, input, orthographic, settings},
    z_test::Estimate,
};

/// The default rule against the exhaustive sum, on one cloud and the same camera paths: the mean of the red
/// differences, in standard errors, and the largest red pixel over the 99.9th percentile.
fn deviation_and_firefly(name: &str, rule: Rule) -> (f64, f64) {
    const SIDE: usize = 64;
    let sun = Light::Directional { towards: DVec3::new(0.6, 0.0, 0.8), irradiance: DVec3::ONE };
    let world = world(&[Part::translucent(sphere(0.5, 5))], &[sun], DVec3::ZERO);
    let cloud = cloud(&world, &by_area(20_000, 7));
    let (media, camera) = ([built_in(name).expect("a built-in medium")], orthographic(DVec3::Z, 0.5));
    let input = input(&world, from_ref(&cloud), &media, &camera);
    let red = |estimator: Estimator| -> Vec<f64> {
        let settings = Settings { estimator, ..settings(Model::DirectionalDipole, SIDE, SIDE) };
        let rendered = render(&input, &settings, |_| ());
        assert_eq!(rendered.non_finite_count, 0);
        rendered.pixels.iter().map(|p| p.beauty().x).collect()
    };
    let (whole, mut chosen) = (red(Estimator::Exhaustive), red(Estimator::Roulette(rule)));
    let differences: Vec<f64> = chosen.iter().zip(&whole).map(|(a, b)| a - b).collect();
    let estimate = Estimate::of(&differences);
    let mean = whole.iter().sum::<f64>() / whole.len() as f64;
    chosen.sort_by(f64::total_cmp);
    let firefly = chosen[chosen.len() - 1] / chosen[chosen.len() * 999 / 1000];
    let deviation = estimate.deviation(0.0);
    println!(
        "{name}, {}: red {mean:.3e} ± {:.1e}, z = {deviation:.2}; largest {firefly:.2}",
        rule.name(),
        estimate.error
    );
    assert!(estimate.error < 0.2 * mean, "too rough to tell");
    (deviation, firefly)
}

#[test]
fn ketchup_on_a_metre_has_no_red_fireflies() {
    let (deviation, firefly) = deviation_and_firefly("ketchup", Rule::Mixture);
    assert!(deviation.abs() < 3.0 && firefly < 20.0);
}

#[test]
fn skin_on_a_metre_has_no_red_fireflies() {
    let (deviation, firefly) = deviation_and_firefly("skin1", Rule::Mixture);
    assert!(deviation.abs() < 3.0 && firefly < 20.0);
}

//! A scene of any size: lengths times s, coefficients divided by s, intensities times s², gives the same image.

use crate::{
    figure::{Figure, PANEL},
    picture::{SUBSURFACE, Shot, assert_close, assert_multiple, channel, lit},
};
use gather::estimator::{Estimator, Rule};
use sample_surface::Choice;
use serde_json::json;
use test_support::{meshes::World, pipeline::MODELS};

/// The figure before a panel; radiance does not depend on the scale.
fn figure() -> Figure {
    Figure::read().with_panel(PANEL)
}

/// The figure enlarged by a node above everything.
fn larger(scale: f64) -> World {
    figure().under(json!({ "scale": [scale, scale, scale] })).brighter(scale * scale).world()
}

/// Powers of two change no digit of any length, area, intensity or coefficient: every radiometric number has the same
/// bits, for all models, with and without roulette, in all layers.
///
/// Seen to catch: a ray that must go 1 µm before it hits; triangles below 10⁻¹² m² dropped; a camera not scaled with
/// the unit of the file; irradiance that falls off with the distance instead of its square.
#[test]
fn powers_of_two_give_the_same_bits() {
    let original = figure().world();
    for exponent in [-10, 7] {
        let scale = 2f64.powi(exponent);
        let by_node = larger(scale);
        let by_unit = figure().brighter(scale * scale).world_in(scale);
        for model in MODELS {
            for estimator in [Estimator::Exhaustive, Estimator::Roulette(Rule::Mixture)] {
                let shot = Shot { model, estimator, ..Shot::new(1) };
                let image = shot.of(&original);
                let scaled = shot.scaled(scale);
                let what = format!("2^{exponent}, {}, {estimator:?}", model.name());
                assert_multiple(&what, &image, &scaled.of(&by_node), 1.0);
                assert_multiple(&what, &image, &scaled.of(&by_unit), 1.0);
            }
        }
    }
}

/// Other factors round every coordinate anew to float32, by 3·10⁻⁸ of 0.05 m, which is 10⁻⁶ of a mean free path:
/// light changes by that much where one sample outshines the others, and by less where many add up. The uniform
/// choice picks the same triangles; the choice by area can take a neighbor where the running sum of areas rounds
/// across the number drawn. Pixels that one sample outshines are the few exceptions; with this seed no sum of areas
/// rounds across, which would change many. Samples that the floor lights carry the light of the point where their ray
/// ends, which moves with the rounding of its origin: they are some of the exceptions.
///
/// Seen to catch: the errors of the test above.
#[test]
fn other_factors_give_the_same_image() {
    let original = figure().world();
    for scale in [1e-3, 1e-2, 10.0, 1e3] {
        let worlds = [larger(scale), figure().brighter(scale * scale).world_in(scale)];
        for world in &worlds {
            let shot = Shot::new(20).choosing(Choice::Uniform);
            let images = [shot.of(&original), shot.clone().scaled(scale).of(world)];
            assert_close(&format!("{scale}, uniform"), [&images[0], &images[1]], 1e-5, 8);
            let shot = Shot::new(20);
            let images = [shot.of(&original), shot.clone().scaled(scale).of(world)];
            assert_close(&format!("{scale}, by area"), [&images[0], &images[1]], 1e-5, 8);
        }
    }
}

/// The test above would pass if the image did not depend on the medium's scale at all.
#[test]
fn a_larger_object_of_the_same_medium_looks_different() {
    let shot = Shot::new(4);
    let images = [shot.of(&figure().world()), shot.of(&larger(10.0))];
    let [small, large] = [0, 1].map(|k| channel(&images[k], SUBSURFACE[0]));
    let different = small.iter().zip(large).filter(|(a, b)| (*a - *b).abs() > 0.1 * a.max(**b)).count();
    assert!(different > lit(&images[0]) / 2, "only {different} pixels differ");
}

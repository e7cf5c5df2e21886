//! Light adds up: twice the light is twice the image, and the sum of lights is the sum of their images.

use crate::{
    figure::{Figure, PANEL},
    picture::{DIFFUSE, SUBSURFACE, Shot, assert_multiple, assert_paired, channel, sum},
};
use gather::estimator::{Estimator, Rule};
use glam::DVec3;
use serde_json::json;

const SKY: DVec3 = DVec3::new(0.5, 0.75, 1.0);

/// All lights, the panel and the sky twice as strong: every radiometric number has one bit more in its exponent, in
/// all layers, and nothing else changes: neither the probabilities of the lights nor the random decisions.
///
/// Seen to catch: flux limited to a largest value; the sky's radiance limited to 1 where it is seen.
#[test]
fn twice_the_light_is_twice_the_image() {
    let figure = |panel: f64| {
        let mut figure = Figure::read().with_panel(panel);
        figure.node("Floor")["scale"] = json!([0.03, 1.0, 0.03]); // the floor does not fill the view
        figure
    };
    let once = figure(PANEL).world_under(SKY);
    let twice = figure(2.0 * PANEL).brighter(2.0).world_under(2.0 * SKY);
    for estimator in [Estimator::Exhaustive, Estimator::Roulette(Rule::Mixture)] {
        let shot = Shot { estimator, ..Shot::new(9).scaled(100.0) }; // so thin that the sky is seen through it
        let images = [shot.of(&once), shot.of(&twice)];
        assert_multiple("twice the light", &images[0], &images[1], 2.0);
        for layer in ["emission.G", "transmission.G", "subsurface.G", "specular.G", "diffuse.G"] {
            assert!(channel(&images[0], layer).iter().any(|x| *x > 0.0), "no light in {layer}");
        }
        for guide in ["N.X", "P.Y", "Z"] {
            assert_eq!(channel(&images[0], guide), channel(&images[1], guide));
        }
    }
}

/// A sample picks one light to stand for all, so only means add up. Opaque surfaces sum all lights, so that their
/// layer adds up pixel by pixel, to the rounding of its float32.
///
/// Seen to catch: irradiance not divided by the probability of the light's choice; lights picked alike whatever their
/// importance, but divided by its share; division by the number of stored samples.
#[test]
fn lights_add_up() {
    let all = Figure::read().world();
    let others = [["Back", "Rim"], ["Key", "Rim"], ["Key", "Back"]];
    let each = others.map(|names| Figure::read().unlit_by(&names).world());
    assert_paired("three lights", 300, 1e-2, |seed| {
        let shot = Shot::smooth(seed);
        let [key, back, rim] = [0, 1, 2].map(|k| sum(&shot.of(&each[k]), SUBSURFACE));
        [key + back + rim, sum(&shot.of(&all), SUBSURFACE)]
    });
    let images = [0, 1, 2].map(|k| Shot::new(10).of(&each[k]));
    let together = Shot::new(10).of(&all);
    for name in DIFFUSE {
        let parts = images.each_ref().map(|image| channel(image, name));
        for (k, whole) in channel(&together, name).iter().enumerate() {
            let sum = parts[0][k] + parts[1][k] + parts[2][k];
            assert!((whole - sum).abs() <= 3e-7 * sum, "{name}, pixel {k}: {whole} {sum}");
        }
    }
}

/// A white light, and its three channels as three lights at the same position.
///
/// Seen to catch: irradiance not divided by the probability of the light's choice.
#[test]
fn red_green_and_blue_make_white() {
    let white = Figure::read().with_copy_of("Key", DVec3::ONE).unlit_by(&["Key", "Back", "Rim"]).world();
    let colors = [DVec3::X, DVec3::Y, DVec3::Z];
    let figure = colors.into_iter().fold(Figure::read(), |figure, c| figure.with_copy_of("Key", c));
    let colored = figure.unlit_by(&["Key", "Back", "Rim"]).world();
    assert_eq!((white.scene.lights().count(), colored.scene.lights().count()), (1, 3));
    assert_paired("colors", 400, 1e-2, |seed| {
        [&white, &colored].map(|world| sum(&Shot::smooth(seed).of(world), SUBSURFACE))
    });
}

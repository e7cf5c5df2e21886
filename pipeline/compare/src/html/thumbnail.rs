//! The small pictures of a comparison in the index.

use base64::{Engine, engine::general_purpose::STANDARD};
use picture::Picture;
use serde::{Deserialize, Serialize};

use super::color;
use super::reduce::{Rectangle, means};
use crate::layer::Layer;
use crate::metric::{EPSILON, Pair};

/// The largest side of a small picture in pixels.
const MAX_SIDE: usize = 160;

/// The relative errors at both ends of the scale, which is logarithmic and the same for all images of an index.
pub(super) const HEAT_RANGE: [f64; 2] = [0.001, 1.0];

/// The beginning of the address of a picture in a page.
const PNG: &str = "data:image/png;base64,";

/// PNG images as data addresses, empty if there is nothing to show.
#[derive(Debug, Default, Deserialize, Serialize)]
pub(super) struct Thumbnails {
    /// The test image.
    pub test: String,
    /// The largest error of each block, relative to the reference.
    pub heat: String,
}

impl Thumbnails {
    /// Whether these could be made by [`thumbnails`]. Those of a file may be anything.
    pub fn are_pictures(&self) -> bool {
        let plain = |c: char| c.is_ascii_alphanumeric() || "+/=".contains(c);
        let is_picture = |text: &str| text.strip_prefix(PNG).is_some_and(|rest| rest.chars().all(plain));
        [&self.test, &self.heat].iter().all(|text| text.is_empty() || is_picture(text))
    }
}

/// Makes the small pictures of the first layer.
pub(super) fn thumbnails(layers: &[Layer<'_>], width: usize, height: usize) -> Thumbnails {
    let Some(layer) = layers.first().filter(|_| width > 0 && height > 0) else { return Thumbnails::default() };
    let block = width.max(height).div_ceil(MAX_SIDE);
    let size = [width.div_ceil(block), height.div_ceil(block)];
    let reduced = |samples: &[f32]| means(samples, width, Rectangle { x: 0, y: 0, width, height }, block);
    // The picture shows three channels as colors, or the first one as gray.
    let planes = layer.samples();
    let is_luminance = layer.channels.first().is_some_and(|(name, _)| name == "Y");
    let shown = &planes[..if planes.len() < 3 || is_luminance { 1 } else { 3 }];
    let white = white(&shown.iter().flat_map(|(reference, _)| reduced(reference)).collect::<Vec<f32>>());
    let test: Vec<Vec<f32>> = shown.iter().map(|(_, test)| reduced(test)).collect();
    let shade = |value: f32| ::color::srgb::encode_byte(f64::from(value) / white);
    let colors = (0..size[0] * size[1]).map(|i| [0, 1, 2].map(|c| shade(test[c.min(test.len() - 1)][i])));
    let heat = heat(&planes, [width, height], block).into_iter().map(|error| color::absolute(part(error)));
    Thumbnails { test: address(size, colors.collect()), heat: address(size, heat.collect()) }
}

/// The value that 99 of 100 values do not exceed. It is shown as white, so that dark pictures can be seen.
fn white(values: &[f32]) -> f64 {
    let mut finite: Vec<f32> = values.iter().copied().filter(|value| value.is_finite()).collect();
    finite.sort_unstable_by(f32::total_cmp);
    let value = finite.get((finite.len() * 99).div_ceil(100).saturating_sub(1)).copied();
    value.map(f64::from).filter(|white| *white > 0.0).unwrap_or(1.0)
}

/// The largest error of each block relative to the root of the squared reference plus [`EPSILON`], as in relMSE. It is
/// NaN if any error of the block is.
fn heat(planes: &[Pair<'_>], size: [usize; 2], block: usize) -> Vec<f64> {
    let row = size[0].div_ceil(block);
    let mut errors = vec![0.0_f64; row * size[1].div_ceil(block)];
    for (reference, test) in planes {
        for (i, (r, t)) in reference.iter().zip(*test).enumerate() {
            let (r, t) = (f64::from(*r), f64::from(*t));
            let error = (t - r).abs() / (r * r + EPSILON).sqrt();
            let worst = &mut errors[i / size[0] / block * row + i % size[0] / block];
            *worst = if worst.is_nan() || error.is_nan() { f64::NAN } else { worst.max(error) };
        }
    }
    errors
}

/// The part of the scale at an error: 0 to 1 between its ends.
fn part(error: f64) -> f64 {
    let [low, high] = HEAT_RANGE;
    if error.is_nan() { error } else { (error.max(low) / low).ln() / (high / low).ln() }
}

/// The address of a picture of these colors.
fn address([width, height]: [usize; 2], pixels: Vec<[u8; 3]>) -> String {
    let file = Picture { width, height, pixels }.encode(png::Compression::Balanced, &[]);
    file.map_or_else(|_| String::new(), |file| format!("{PNG}{}", STANDARD.encode(file)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn heat_is_the_worst_of_a_block() {
        let reference = [0.0, 0.0, 2.0, 0.0, 0.0, 0.0_f32];
        let test = [0.05, -0.2, 2.0, 0.0, 0.0, f32::NAN];
        let found = heat(&[(&reference, &test)], [3, 2], 2);
        // Relative to black, an error of 0.2 is 0.2 / sqrt(0.01).
        assert!((found[0] - 2.0).abs() < 1e-6, "{found:?}");
        assert!(found[1].is_nan());
    }

    #[test]
    fn equal_factors_are_equal_steps() {
        let expected = [(0.0, 0.0), (0.001, 0.0), (0.01, 1.0 / 3.0), (1.0, 1.0), (10.0, 4.0 / 3.0)];
        assert!(expected.iter().all(|(error, expected)| (part(*error) - expected).abs() < 1e-12));
        assert!(part(f64::NAN).is_nan());
    }

    #[test]
    fn white_is_the_percentile_of_the_finite_values() {
        let values: Vec<f32> = (1..=200).map(|i| i as f32).chain([f32::NAN, f32::INFINITY]).collect();
        assert_eq!(white(&values), 198.0);
        assert_eq!(white(&[f32::NAN]), 1.0);
        assert_eq!(white(&[-1.0, 0.0]), 1.0);
    }

    #[test]
    fn only_pictures_are_taken() {
        let with = |test: &str| Thumbnails { test: test.to_owned(), heat: String::new() }.are_pictures();
        assert!(with("") && with("data:image/png;base64,AB+/="));
        assert!(!with("https://example.org/a.png") && !with("data:image/png;base64,A\"B"));
    }
}

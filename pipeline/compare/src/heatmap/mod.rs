//! The absolute error as a picture. Its scale does not depend on the images, so that two pictures can be compared.

use formats::image::Image;
use picture::Picture;

use crate::layer::{Choice, Layer, layers};
use crate::metric::Pair;
use crate::structure::Mismatch;

mod color;
mod legend;

use color::Counts;

/// The default end of the scale in units of the channel: a tenth of a white surface under unit light.
pub const DEFAULT_MAX: f64 = 0.1;

/// The largest number of pixels of a picture with its legend, which take 768 MiB.
const MAX_PIXELS: usize = 1 << 28;
/// The largest factor by which an image is enlarged.
const MAX_ZOOM: usize = 16;

/// Why there is no heatmap.
#[derive(Debug, thiserror::Error)]
pub enum HeatmapError {
    /// The layer does not exist.
    #[error(transparent)]
    Layer(#[from] Mismatch),
    /// The picture of this many columns and rows would need too much memory.
    #[error(
        "a heatmap of {width} x {height} pixels with its legend is too large; at most {MAX_PIXELS} pixels are drawn"
    )]
    TooLarge { width: usize, height: usize },
    /// The PNG library failed.
    #[error("the heatmap cannot be packed: {0}")]
    Png(#[from] png::EncodingError),
}

/// Draws the absolute error of the chosen layer, the largest of its channels, as color from 0 to `max`, and returns a
/// PNG file with a legend below the picture. Small images are enlarged by a whole factor. If all layers are chosen, the
/// first is drawn, which is `beauty` if that exists.
pub fn heatmap(reference: &Image, test: &Image, choice: &Choice, max: f64) -> Result<Vec<u8>, HeatmapError> {
    let layers = layers(reference, test);
    let layer = choose(&layers, choice)?;
    let zoom = (legend::WIDTH / reference.width.max(1)).clamp(1, MAX_ZOOM);
    let width = reference.width.saturating_mul(zoom).max(legend::WIDTH);
    let height = reference.height.saturating_mul(zoom).saturating_add(legend::HEIGHT);
    if width.saturating_mul(height) > MAX_PIXELS {
        return Err(HeatmapError::TooLarge { width, height });
    }
    let mut picture = Picture::new(width, height, legend::PAPER);
    let (scale, planes, mut counts) = (color::scale(), layer.samples(), Counts::default());
    for pixel in 0..reference.width * reference.height {
        let (left, top) = (pixel % reference.width * zoom, pixel / reference.width * zoom);
        let color = counts.shade(&scale, error(&planes, pixel), max);
        picture.fill(left..left + zoom, top..top + zoom, color);
    }
    legend::draw(&mut picture, reference.height * zoom, &layer.name, counts, max);
    let description = legend::description(&layer.name, max, zoom);
    Ok(picture.encode(png::Compression::Balanced, &[("Description", description.as_str())])?)
}

fn choose<'a, 'b>(layers: &'b [Layer<'a>], choice: &Choice) -> Result<&'b Layer<'a>, Mismatch> {
    let wanted = choice.layer().or(layers.first().map(|layer| layer.name.as_str())).unwrap_or_default();
    layers.iter().find(|layer| layer.name == wanted).ok_or_else(|| Mismatch::no_layer(wanted, layers))
}

/// The largest absolute error of a pixel among the channels, or `None` where an image is not finite.
fn error(planes: &[Pair<'_>], pixel: usize) -> Option<f64> {
    planes.iter().try_fold(0.0_f64, |worst, (reference, test)| {
        let error = (f64::from(test[pixel]) - f64::from(reference[pixel])).abs();
        error.is_finite().then_some(worst.max(error))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Seen to catch: the sum of the channels, errors with their sign, NaN lost in `max`.
    #[test]
    fn the_largest_channel_counts_and_nan_is_none() {
        let planes: [Pair<'_>; 2] = [
            (&[0.0, 1.0, 0.0, f32::INFINITY], &[0.5, 1.0, f32::NAN, f32::INFINITY]),
            (&[2.0, 1.0, 0.0, 0.0], &[1.0, 1.0, 9.0, 0.0]),
        ];
        assert_eq!([0, 1, 2, 3].map(|pixel| error(&planes, pixel)), [Some(1.0), Some(0.0), None, None]);
    }

    #[test]
    fn the_end_of_the_scale_belongs_to_it() {
        let (scale, mut counts) = (color::scale(), Counts::default());
        let mut shade = |error, max| counts.shade(&scale, error, max);
        assert_eq!(shade(Some(0.25), 0.25), scale[255]);
        assert_eq!(shade(Some(0.125), 0.25), scale[128]);
        assert_eq!(shade(Some(0.250_001), 0.25), color::ABOVE);
        assert_eq!(shade(Some(0.0), f64::MIN_POSITIVE), scale[0]);
        assert_eq!(shade(None, 0.25), color::NOT_FINITE);
        assert_eq!(counts, Counts { above: 1, not_finite: 1 });
    }

    #[test]
    fn a_picture_that_no_machine_holds_is_refused() {
        let image = Image { width: 1, height: usize::MAX, channels: Vec::new(), ..Image::default() };
        let channel = formats::image::Channel { name: "R".to_owned(), samples: Vec::new() };
        let image = Image { channels: vec![channel], ..image };
        let result = heatmap(&image, &image, &Choice::Default, 1.0);
        assert!(matches!(result, Err(HeatmapError::TooLarge { .. })), "{result:?}");
    }
}

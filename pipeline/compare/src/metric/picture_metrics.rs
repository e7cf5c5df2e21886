//! All metrics of the picture, with the reason for each that is missing.

use formats::image::Image;
use serde::Serialize;

use super::channel::as_map;
use super::displayed::{self, DisplayedMetric};
use super::flip::{self, Exposures, Flip, HdrFlip};
use super::picture::Picture;

/// The metrics of the picture. The names are the keys of the JSON report. Every value is NaN, `null` in JSON, if the
/// picture is not finite.
#[derive(Clone, Debug, Default, Serialize)]
pub struct PictureMetrics {
    /// The metrics of display values with their keys, in the order of their table. The PSNR of equal pictures is
    /// infinite, `null` in JSON.
    #[serde(flatten, serialize_with = "as_map")]
    pub values: Vec<(&'static str, Option<f64>)>,
    /// LDR-FLIP of display values.
    pub flip_ldr: Option<Flip>,
    /// HDR-FLIP over a range of exposures.
    pub flip_hdr: Option<HdrFlip>,
    /// Why metrics are missing.
    pub missing: Vec<String>,
    /// The metrics of display values in words.
    #[serde(skip)]
    words: Vec<String>,
}

impl PictureMetrics {
    /// A metric by its key in the report; of FLIP it is the mean.
    pub fn get(&self, key: &str) -> Option<f64> {
        match key {
            "flip_ldr" => self.flip_ldr.as_ref().map(|flip| flip.mean),
            "flip_hdr" => self.flip_hdr.as_ref().map(|hdr| hdr.flip.mean),
            key => self.values.iter().find(|(known, _)| *known == key)?.1,
        }
    }

    /// The metrics as lines for people.
    pub(crate) fn lines(&self) -> String {
        let mut lines: Vec<String> = Vec::new();
        if !self.words.is_empty() {
            lines.push(format!("R, G, B as displayed (exposure 0, clamped to 0..1, sRGB): {}", self.words.join(", ")));
        }
        lines.extend(self.flip_ldr.iter().map(|flip| format!("LDR-FLIP {}", flip.words())));
        lines.extend(self.flip_hdr.iter().map(|HdrFlip { flip, exposures: Exposures { start, stop, count } }| {
            format!("HDR-FLIP {} ({count} exposures from {start:+.2} to {stop:+.2} stops)", flip.words())
        }));
        lines.extend(self.missing.iter().map(|reason| format!("not measured: {reason}")));
        lines.join("\n") + "\n"
    }
}

/// Measures the picture of two images of one size, with FLIP if it is asked for.
pub(super) fn measure(
    metrics: &'static [DisplayedMetric],
    reference: &Image,
    test: &Image,
    with_flip: bool,
) -> PictureMetrics {
    let picture = Picture::new(reference, test);
    let values = match &picture {
        Some(picture) => displayed::measure(metrics, picture),
        None => metrics.iter().map(|_| Err(NO_COLORS.to_owned())).collect(),
    };
    let (mut missing, mut words) = (Vec::new(), Vec::new());
    for (metric, value) in metrics.iter().zip(&values) {
        match value {
            Ok(value) => words.push((metric.words)(*value)),
            Err(reason) => missing.push(format!("{}: {reason}", metric.key)),
        }
    }
    if picture.is_none() || !with_flip {
        missing.push(format!("flip: {}", if picture.is_none() { NO_COLORS } else { "not asked for" }));
    }
    let seen = picture.filter(|_| with_flip);
    PictureMetrics {
        values: metrics.iter().map(|metric| metric.key).zip(values.into_iter().map(Result::ok)).collect(),
        flip_ldr: seen.as_ref().map(flip::ldr),
        flip_hdr: seen.as_ref().map(flip::hdr),
        missing,
        words,
    }
}

/// Why an image has no picture.
const NO_COLORS: &str = "there is no R, G and B";

#[cfg(test)]
mod tests {
    use formats::image::Channel;

    use super::super::measure_picture as measure;
    use super::*;

    /// A picture with the same light in every sample.
    fn uniform(width: usize, height: usize, light: f32) -> Image {
        let channel = |name: &str| Channel { name: name.to_owned(), samples: vec![light; width * height] };
        Image { width, height, channels: ["B", "G", "R"].map(channel).to_vec(), ..Image::default() }
    }

    /// The linear value that is displayed as this value above 0.04.
    fn linear(shown: f64) -> f32 {
        ((shown + 0.055) / 1.055).powf(2.4) as f32
    }

    #[test]
    fn uniform_pictures_on_paper() {
        let (reference, test) = (uniform(140, 13, linear(0.5)), uniform(140, 13, linear(0.6)));
        let metrics = measure(&reference, &test, true);
        // An error of a tenth everywhere is 20 dB.
        assert!((metrics.get("psnr").unwrap() - 20.0).abs() < 1e-4, "{metrics:?}");
        // Without variance only the luminance term is left, (2 * 0.5 * 0.6 + 0.0001) / (0.25 + 0.36 + 0.0001).
        assert!((metrics.get("ssim").unwrap() - 0.6001 / 0.6101).abs() < 1e-5, "{metrics:?}");
        assert!(metrics.flip_ldr.is_some() && metrics.flip_hdr.is_some() && metrics.missing.is_empty());
    }

    #[test]
    fn equal_pictures() {
        let mut picture = uniform(140, 150, 0.0);
        picture.channels[1].samples.iter_mut().enumerate().for_each(|(i, light)| *light = (i % 31) as f32 / 20.0);
        let metrics = measure(&picture, &picture, false);
        assert_eq!((metrics.get("psnr"), metrics.get("ssim")), (Some(f64::INFINITY), Some(1.0)));
        assert_eq!((metrics.flip_ldr, metrics.flip_hdr), (None, None));
        assert_eq!(metrics.missing, ["flip: not asked for"]);
    }

    /// The similarity lost by all windows that see one black pixel in a plane of display value `a`. If w is its weight
    /// in a window, the means are a and a (1 - w), and the variances 0 and a^2 w (1 - w).
    fn lost_by_a_black_pixel(a: f64) -> f64 {
        let weight = |x: i32| (-f64::from(x * x) / 4.5).exp();
        let sum: f64 = (-5..=5).map(weight).sum();
        let similarity = |i: i32| {
            let w = weight(i % 11 - 5) * weight(i / 11 - 5) / (sum * sum);
            let (mean, variance) = (a * (1.0 - w), a * a * w * (1.0 - w));
            (2.0 * a * mean + 1e-4) / (a * a + mean * mean + 1e-4) * 9e-4 / (variance + 9e-4)
        };
        (0..121).map(|i| 1.0 - similarity(i)).sum()
    }

    #[test]
    fn a_black_pixel_among_the_tiles_on_paper() {
        let reference = uniform(300, 150, linear(0.7));
        let expected = lost_by_a_black_pixel(0.7);
        for (x, y) in [(10, 10), (128, 128), (127, 60), (289, 139)] {
            let mut test = reference.clone();
            test.channels[0].samples[y * 300 + x] = 0.0;
            let lost = (1.0 - measure(&reference, &test, false).get("ssim").unwrap()) * 3.0 * f64::from(290 * 140);
            // The tolerance is the rounding of float32 in 120000 windows without variance.
            assert!((lost - expected).abs() < 0.05, "{x} {y}: {lost} {expected}");
        }
    }

    #[test]
    fn missing_metrics_have_a_reason() {
        let small = measure(&uniform(10, 40, 0.2), &uniform(10, 40, 0.3), true);
        assert!(small.get("ssim").is_none() && small.get("psnr").is_some() && small.flip_hdr.is_some());
        assert!(small.missing[0].contains("11 x 11"));
        let mut gray = uniform(20, 20, 0.2);
        gray.channels.retain(|channel| channel.name == "G");
        let metrics = measure(&gray, &gray, true);
        assert!(
            metrics.get("psnr").is_none() && metrics.flip_ldr.is_none() && metrics.missing[0].contains("no R, G and B")
        );
        assert!(metrics.lines().contains("not measured: ssim: there is no R, G and B"));
    }

    #[test]
    fn one_value_that_is_not_finite_shows() {
        let reference = uniform(20, 20, 0.5);
        for fault in [f32::NAN, f32::INFINITY] {
            let mut test = reference.clone();
            test.channels[2].samples[399] = fault;
            for metrics in [measure(&reference, &test, true), measure(&test, &test, true)] {
                assert!(metrics.get("psnr").unwrap().is_nan() && metrics.get("ssim").unwrap().is_nan());
                assert!(metrics.flip_ldr.unwrap().mean.is_nan() && metrics.flip_hdr.unwrap().flip.mean.is_nan());
            }
        }
    }
}

//! What the eye sees: metrics of the beauty layer as a picture of three colors.

use formats::image::Image;
use rayon::prelude::*;
use serde::Serialize;

use super::flip::{self, Exposures, Flip, HdrFlip};
use super::tile::{SIDE, Tile};
use super::{psnr, ssim};

/// R, G and B of both images, each `width * height` samples of linear light.
#[derive(Clone, Copy, Debug)]
pub struct Picture<'a> {
    /// Width and height, pixels; neither is zero.
    pub(super) size: [usize; 2],
    pub(super) reference: [&'a [f32]; 3],
    pub(super) test: [&'a [f32]; 3],
}

impl<'a> Picture<'a> {
    /// None if one of the images has no R, G and B, or no pixels; both must be of one size.
    pub fn new(reference: &'a Image, test: &'a Image) -> Option<Picture<'a>> {
        let size = [reference.width, reference.height];
        let pixels = size[0].checked_mul(size[1]).filter(|pixels| *pixels > 0)?;
        let channel = |image: &'a Image, name| image.channel(name).filter(|samples| samples.len() == pixels);
        let colors = |image| Some([channel(image, "R")?, channel(image, "G")?, channel(image, "B")?]);
        Some(Picture { size, reference: colors(reference)?, test: colors(test)? })
    }

    /// Whether all samples of a pixel, by its number, are finite in both images.
    pub(super) fn is_finite(&self, pixel: usize) -> bool {
        self.reference.iter().chain(&self.test).all(|samples| samples[pixel].is_finite())
    }

    fn all_finite(&self) -> bool {
        let mut planes = self.reference.iter().chain(&self.test);
        planes.all(|samples| samples.par_iter().all(|sample| sample.is_finite()))
    }
}

/// The keys of the JSON report. All are NaN, `null` in JSON, where the picture is not finite.
#[derive(Clone, Debug, Default, Serialize)]
pub struct PictureMetrics {
    /// Peak signal to noise ratio of display values, dB; infinite, `null` in JSON, for equal pictures.
    pub psnr: Option<f64>,
    /// Structural similarity of display values: 1 for equal pictures.
    pub ssim: Option<f64>,
    /// Difference as seen on a screen, of display values: 0 to 1.
    pub flip_ldr: Option<Flip>,
    /// Difference as seen on a screen at the worst of a range of exposures: 0 to 1.
    pub flip_hdr: Option<HdrFlip>,
    /// Why metrics are missing.
    pub missing: Vec<String>,
}

impl PictureMetrics {
    /// For people, line by line.
    pub(crate) fn lines(&self) -> String {
        let mut lines: Vec<String> = Vec::new();
        if let Some(psnr) = self.psnr {
            let ssim = self.ssim.map(|ssim| format!(", SSIM {ssim:.6}")).unwrap_or_default();
            lines.push(format!("R, G, B as displayed (exposure 0, clamped to 0..1, sRGB): PSNR {psnr:.3} dB{ssim}"));
        }
        let values = |flip: &Flip| {
            let Flip { mean, median, p99, max } = flip;
            format!("mean {mean:.5}, median {median:.5}, p99 {p99:.5}, max {max:.5}")
        };
        lines.extend(self.flip_ldr.iter().map(|flip| format!("LDR-FLIP {}", values(flip))));
        lines.extend(self.flip_hdr.iter().map(|HdrFlip { flip, exposures }| {
            let Exposures { start, stop, count } = exposures;
            format!("HDR-FLIP {} ({count} exposures from {start:+.2} to {stop:+.2} stops)", values(flip))
        }));
        lines.extend(self.missing.iter().map(|reason| format!("not measured: {reason}")));
        lines.join("\n") + "\n"
    }
}

/// FLIP takes some ten times as long as the rest, and is left out unless asked for.
pub(crate) fn measure(reference: &Image, test: &Image, with_flip: bool) -> PictureMetrics {
    let Some(picture) = Picture::new(reference, test) else {
        let missing = vec!["psnr, ssim, flip: there is no R, G and B".to_owned()];
        return PictureMetrics { missing, ..PictureMetrics::default() };
    };
    let (psnr, ssim) = if picture.all_finite() { of_display_values(&picture) } else { (f64::NAN, Some(f64::NAN)) };
    let mut missing = Vec::new();
    if ssim.is_none() {
        missing.push(format!("ssim: the picture is smaller than its window of {0} x {0} pixels", ssim::WINDOW));
    }
    if !with_flip {
        missing.push("flip: not asked for".to_owned());
    }
    let (flip_ldr, flip_hdr) =
        if with_flip { (Some(flip::ldr(&picture)), Some(flip::hdr(&picture))) } else { (None, None) };
    PictureMetrics { psnr: Some(psnr), ssim, flip_ldr, flip_hdr, missing }
}

/// PSNR, and SSIM unless the picture is smaller than its window.
fn of_display_values(picture: &Picture<'_>) -> (f64, Option<f64>) {
    let taps = ssim::taps();
    let band = |scratch: &mut ssim::Scratch, band| {
        let mut sums = [0.0; 2];
        for tile in Tile::of_band(picture.size, band) {
            for (reference, test) in picture.reference.iter().zip(&picture.test) {
                tile.load(reference, &mut scratch.reference);
                tile.load(test, &mut scratch.test);
                ssim::compute(scratch, &taps);
                sums[0] += psnr::squared_error(tile, &scratch.reference, &scratch.test);
                sums[1] += ssim::sum(tile, &scratch.similarity);
            }
        }
        sums
    };
    let bands = 0..picture.size[1].div_ceil(SIDE);
    let sums: Vec<[f64; 2]> = bands.into_par_iter().map_init(ssim::Scratch::default, band).collect();
    let [squared, similarity] = sums.iter().fold([0.0; 2], |sum, band| [sum[0] + band[0], sum[1] + band[1]]);
    let samples = 3.0 * (picture.size[0] * picture.size[1]) as f64;
    (psnr::decibels(squared / samples), ssim::windows(picture.size).map(|windows| similarity / (3 * windows) as f64))
}

#[cfg(test)]
mod tests {
    use formats::image::Channel;

    use super::*;

    /// A picture of one light everywhere.
    fn even(width: usize, height: usize, light: f32) -> Image {
        let channel = |name: &str| Channel { name: name.to_owned(), samples: vec![light; width * height] };
        Image { width, height, channels: ["B", "G", "R"].map(channel).to_vec(), ..Image::default() }
    }

    /// What is displayed as this value above 0.04.
    fn linear(shown: f64) -> f32 {
        ((shown + 0.055) / 1.055).powf(2.4) as f32
    }

    #[test]
    fn even_pictures_on_paper() {
        let (reference, test) = (even(140, 13, linear(0.5)), even(140, 13, linear(0.6)));
        let metrics = measure(&reference, &test, true);
        // A tenth everywhere is 20 dB.
        assert!((metrics.psnr.unwrap() - 20.0).abs() < 1e-4, "{metrics:?}");
        // No variance: the luminance term alone, (2 * 0.5 * 0.6 + 0.0001) / (0.25 + 0.36 + 0.0001).
        assert!((metrics.ssim.unwrap() - 0.6001 / 0.6101).abs() < 1e-5, "{metrics:?}");
        assert!(metrics.flip_ldr.is_some() && metrics.flip_hdr.is_some() && metrics.missing.is_empty());
    }

    #[test]
    fn equal_pictures() {
        let mut picture = even(140, 150, 0.0);
        picture.channels[1].samples.iter_mut().enumerate().for_each(|(i, light)| *light = (i % 31) as f32 / 20.0);
        let metrics = measure(&picture, &picture, false);
        assert_eq!((metrics.psnr, metrics.ssim), (Some(f64::INFINITY), Some(1.0)));
        assert_eq!((metrics.flip_ldr, metrics.flip_hdr), (None, None));
        assert_eq!(metrics.missing, ["flip: not asked for"]);
    }

    /// What all windows that see one black pixel in an even plane of display value `a` lose. With its weight w in a window,
    /// means are a and a (1 - w), variances 0 and a^2 w (1 - w).
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
        let reference = even(300, 150, linear(0.7));
        let expected = lost_by_a_black_pixel(0.7);
        for (x, y) in [(10, 10), (128, 128), (127, 60), (289, 139)] {
            let mut test = reference.clone();
            test.channels[0].samples[y * 300 + x] = 0.0;
            let lost = (1.0 - measure(&reference, &test, false).ssim.unwrap()) * 3.0 * f64::from(290 * 140);
            // Rounding of float32 in 120000 windows without variance.
            assert!((lost - expected).abs() < 0.05, "{x} {y}: {lost} {expected}");
        }
    }

    #[test]
    fn what_cannot_be_measured_says_why() {
        let small = measure(&even(10, 40, 0.2), &even(10, 40, 0.3), true);
        assert!(small.ssim.is_none() && small.psnr.is_some() && small.flip_hdr.is_some());
        assert!(small.missing[0].contains("11 x 11"));
        let mut grey = even(20, 20, 0.2);
        grey.channels.retain(|channel| channel.name == "G");
        let metrics = measure(&grey, &grey, true);
        assert!(metrics.psnr.is_none() && metrics.flip_ldr.is_none() && metrics.missing[0].contains("no R, G and B"));
        assert!(metrics.lines().contains("not measured: psnr, ssim, flip"));
    }

    #[test]
    fn one_value_that_is_not_finite_shows() {
        let reference = even(20, 20, 0.5);
        for fault in [f32::NAN, f32::INFINITY] {
            let mut test = reference.clone();
            test.channels[2].samples[399] = fault;
            for metrics in [measure(&reference, &test, true), measure(&test, &test, true)] {
                assert!(metrics.psnr.unwrap().is_nan() && metrics.ssim.unwrap().is_nan());
                assert!(metrics.flip_ldr.unwrap().mean.is_nan() && metrics.flip_hdr.unwrap().flip.mean.is_nan());
            }
        }
    }
}

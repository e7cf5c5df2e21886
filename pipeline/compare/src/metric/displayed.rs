//! Metrics of the picture as a screen displays it: tile by tile, of display values. These are linear values at exposure
//! 0, clamped to 0..1, encoded by the curve of sRGB (IEC 61966-2-1).

use color::srgb::{GAMMA, LINE_END, LINE_SLOPE, OFFSET, SCALE};
use rayon::prelude::*;
use simd::Kernel;

use super::elementary::power;
use super::picture::Picture;
use super::tile::{Plane, SIDE, Tile, planes};

/// A metric of display values that is made of a sum over tiles and channels.
#[derive(Debug)]
pub(super) struct DisplayedMetric {
    /// Its key in the JSON report.
    pub key: &'static str,
    /// The contribution of a channel of a tile to the sum. The planes `reference` and `test` must stay as they are.
    pub sum: fn(Tile, &mut Scratch) -> f64,
    /// The metric of a picture of this size in pixels as a function of the sum over all tiles and the three channels,
    /// or why there is none.
    pub value: fn(f64, [usize; 2]) -> Result<f64, String>,
    /// The metric in words.
    pub words: fn(f64) -> String,
}

/// The memory that one thread needs for one channel of a tile.
pub(super) struct Scratch {
    /// Display values of the reference.
    pub reference: Box<Plane>,
    /// Display values of the test image.
    pub test: Box<Plane>,
    /// Intermediate results of a metric.
    pub work: [Box<Plane>; 7],
}

impl Default for Scratch {
    fn default() -> Scratch {
        let [reference, test] = planes();
        Scratch { reference, test, work: planes() }
    }
}

/// Measures each metric, or says why there is none. If the picture is not finite, all metrics are NaN.
pub(super) fn measure(metrics: &[DisplayedMetric], picture: &Picture<'_>) -> Vec<Result<f64, String>> {
    if !picture.all_finite() {
        return vec![Ok(f64::NAN); metrics.len()];
    }
    let band = |scratch: &mut Scratch, band| {
        let mut sums = vec![0.0; metrics.len()];
        for tile in Tile::of_band(picture.size, band) {
            for (reference, test) in picture.reference.iter().zip(&picture.test) {
                tile.load(reference, &mut scratch.reference);
                tile.load(test, &mut scratch.test);
                simd::dispatch(Display([&mut scratch.reference, &mut scratch.test]));
                for (sum, metric) in sums.iter_mut().zip(metrics) {
                    *sum += (metric.sum)(tile, scratch);
                }
            }
        }
        sums
    };
    let bands: Vec<Vec<f64>> =
        (0..picture.size[1].div_ceil(SIDE)).into_par_iter().map_init(Scratch::default, band).collect();
    let sum = |index: usize| bands.iter().map(|sums| sums[index]).sum();
    metrics.iter().enumerate().map(|(index, metric)| (metric.value)(sum(index), picture.size)).collect()
}

struct Display<'a>([&'a mut Plane; 2]);

impl Kernel for Display<'_> {
    type Output = ();

    #[inline(always)]
    fn run(self) {
        for plane in self.0 {
            for value in plane {
                *value = display(*value);
            }
        }
    }
}

/// The display value of a finite linear value.
#[inline(always)]
fn display(linear: f32) -> f32 {
    let x = linear.clamp(0.0, 1.0);
    let line = LINE_SLOPE as f32 * x;
    let curve = SCALE as f32 * power(x, 1.0 / GAMMA as f32) - OFFSET as f32;
    if x <= LINE_END as f32 { line } else { curve }
}

#[cfg(test)]
mod tests {
    use super::display;

    #[test]
    fn known_values() {
        for (linear, shown) in [(-1.0, 0.0), (0.0, 0.0), (0.001, 0.012_92), (0.5, 0.735_357), (1.0, 1.0), (9.0, 1.0)] {
            assert!((display(linear) - shown).abs() < 3e-7, "{linear}");
        }
    }
}

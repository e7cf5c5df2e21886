//! FLIP: the difference that is seen when two pictures are shown in alternation, 0 to 1 for every pixel.
//!
//! LDR-FLIP is Andersson, Nilsson, Akenine-Möller, Oskarsson, Åström and Fairchild, *FLIP: A Difference Evaluator for
//! Alternating Images*, 2020; HDR-FLIP is Andersson, Nilsson, Shirley and Akenine-Möller, *Visualizing Errors in
//! Rendered High Dynamic Range Images*, 2021. All constants are those of the papers. The viewer sits 0.7 m from a
//! screen that is 0.7 m wide and has 3840 columns. Negative light counts as no light. A pixel that is not finite in one
//! of the images is NaN in the map, and so is the mean; the filters of its neighbors take it as black.

use rayon::prelude::*;
use serde::Serialize;

mod color;
mod contrast;
mod exposure;
mod feature;
mod look;

pub use exposure::Exposures;

use super::gate_kind::{GateKind, GateValue};
use super::picture::Picture;
use super::select;
use super::tile::{HALO, MARGIN, PITCH, Plane, SIDE, Tile, planes};
use exposure::Tone;
use look::{Compare, Eye, Look, See, Work};

pub(super) const GATE: GateKind = GateKind {
    name: "max-flip",
    help: "Largest mean of HDR-FLIP of R, G and B, 0 to 1; never the only limit",
    value: GateValue::Picture("flip_hdr"),
};

/// The distribution of the values of a map. The names are the keys of the JSON report.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Flip {
    /// The mean over all pixels.
    pub mean: f64,
    /// The value that half of the pixels do not exceed.
    pub median: f64,
    /// The value that 99 of 100 pixels do not exceed.
    pub p99: f64,
    /// The largest value.
    pub max: f64,
}

impl Flip {
    /// The distribution in words.
    pub(super) fn words(&self) -> String {
        let Flip { mean, median, p99, max } = self;
        format!("mean {mean:.5}, median {median:.5}, p99 {p99:.5}, max {max:.5}")
    }
}

/// HDR-FLIP. The names are the keys of the JSON report.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct HdrFlip {
    /// The distribution of the values of its map.
    #[serde(flatten)]
    pub flip: Flip,
    /// The exposures that the pictures were shown at.
    pub exposures: Exposures,
}

/// Measures LDR-FLIP of display values: exposure 0, clamped to 0..1, sRGB.
pub fn ldr(picture: &Picture<'_>) -> Flip {
    summary(&map(picture, &[Tone::Clamp]))
}

/// Measures HDR-FLIP, of each pixel the largest LDR-FLIP over the exposures.
pub fn hdr(picture: &Picture<'_>) -> HdrFlip {
    let exposures = Exposures::of(picture);
    HdrFlip { flip: summary(&map(picture, &exposures.tones())), exposures }
}

/// The largest difference of each pixel over the tones, row after row.
fn map(picture: &Picture<'_>, tones: &[Tone]) -> Vec<f32> {
    let [width, height] = picture.size;
    let (eye, limit) = (Eye::default(), color::largest_difference());
    let mut map = vec![0.0; width * height];
    map.par_chunks_mut(width * SIDE).enumerate().for_each_init(Scratch::default, |scratch, (band, rows)| {
        for tile in Tile::of_band(picture.size, band) {
            if scratch.load(picture, tile) {
                scratch.largest.fill(0.0);
                for tone in tones {
                    scratch.difference(&eye, *tone, limit);
                }
                copy(tile, &scratch.largest, rows);
            }
        }
        let first = band * SIDE * width;
        for (i, value) in rows.iter_mut().enumerate() {
            *value = if picture.is_finite(first + i) { *value } else { f32::NAN };
        }
    });
    map
}

/// The memory that one thread needs for a tile.
struct Scratch {
    linear: [[Box<Plane>; 3]; 2],
    looks: [Look; 2],
    work: Work,
    largest: Box<Plane>,
}

impl Default for Scratch {
    fn default() -> Scratch {
        let [largest] = planes();
        Scratch { linear: [planes(), planes()], looks: [planes(), planes()], work: planes(), largest }
    }
}

impl Scratch {
    /// Loads the tile of both images. Returns false if they are equal there, so that the difference is zero.
    fn load(&mut self, picture: &Picture<'_>, tile: Tile) -> bool {
        let [reference, test] = &mut self.linear;
        for color in 0..3 {
            tile.load(picture.reference[color], &mut reference[color]);
            tile.load(picture.test[color], &mut test[color]);
        }
        reference != test
    }

    fn difference(&mut self, eye: &Eye, tone: Tone, limit: f32) {
        for (linear, look) in self.linear.iter().zip(&mut self.looks) {
            simd::dispatch(See { eye, tone, linear, work: &mut self.work, look });
        }
        simd::dispatch(Compare { looks: &self.looks, limit, largest: &mut self.largest });
    }
}

/// Copies the pixels of a tile into the rows of its band.
fn copy(tile: Tile, from: &Plane, rows: &mut [f32]) {
    let [columns, _] = tile.size();
    for (row, line) in rows.chunks_mut(tile.picture[0]).enumerate() {
        let at = (row + HALO) * PITCH + MARGIN;
        line[tile.first[0]..tile.first[0] + columns].copy_from_slice(&from[at..at + columns]);
    }
}

/// The distribution of a map. If the map holds NaN, the mean is NaN; NaN ranks as the largest value.
fn summary(map: &[f32]) -> Flip {
    const CHUNK: usize = 1 << 16;
    let sum = |values: &[f32]| values.iter().copied().map(f64::from).sum::<f64>();
    let sums: Vec<f64> = map.par_chunks(CHUNK).map(sum).collect();
    let percentile = |percent: usize| {
        let rank = (map.len() * percent).div_ceil(100).saturating_sub(1);
        f64::from(select::select(map.len(), rank, |i| map[i]))
    };
    Flip {
        mean: sums.iter().sum::<f64>() / map.len() as f64,
        median: percentile(50),
        p99: percentile(99),
        max: percentile(100),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ldr_map(picture: &Picture<'_>) -> Vec<f32> {
        map(picture, &[Tone::Clamp])
    }

    fn hdr_map(picture: &Picture<'_>) -> Vec<f32> {
        map(picture, &Exposures::of(picture).tones())
    }

    fn with<T>(size: [usize; 2], reference: &[f32], test: &[f32], measure: impl Fn(&Picture<'_>) -> T) -> T {
        measure(&Picture { size, reference: [reference; 3], test: [test; 3] })
    }

    #[test]
    fn equal_pictures_do_not_differ() {
        let light: Vec<f32> = (0..140 * 30).map(|i| (i * 7 % 97) as f32 / 20.0).collect();
        let mut zero = Flip { mean: 0.0, median: 0.0, p99: 0.0, max: 0.0 };
        assert_eq!(with([140, 30], &light, &light, ldr), zero);
        // One pixel at the right end differs: the tile on the left is still equal, and its difference is zero.
        let mut other = light.clone();
        other[139] += 0.5;
        let map = with([140, 30], &light, &other, ldr_map);
        assert!(map[139] > 0.05 && map[128] == 0.0 && map[0] == 0.0);
        zero = with([140, 30], &light, &light, hdr).flip;
        assert_eq!(zero.max, 0.0);
    }

    #[test]
    fn one_color_that_differs_is_enough() {
        let (even, other) = ([0.3; 4], [0.4; 4]);
        for color in 0..3 {
            let mut test = [even.as_slice(); 3];
            test[color] = &other;
            let picture = Picture { size: [2, 2], reference: [&even; 3], test };
            assert!(ldr(&picture).mean > 0.01 && hdr(&picture).flip.mean > 0.01, "{color}");
        }
    }

    #[test]
    fn uniform_pictures_on_paper() {
        // L* is 50 and 60, without color, edges or points. The difference is 10^0.7, below the joint at 0.95.
        let (dark, light) = ([0.184_186_5; 9], [0.281_233_2; 9]);
        let expected = 0.95 * 10f64.powf(0.7) / (0.4 * f64::from(color::largest_difference()));
        let found = with([3, 3], &dark, &light, ldr);
        assert!((found.mean - expected).abs() < 1e-5, "{found:?} {expected}");
        assert_eq!(found.max, found.median);
        // A uniform reference is shown as 0.85, which is L* 93.88; half of it is shown as 0.6853, which is L* 86.27.
        let found = with([3, 3], &[7.0; 9], &[3.5; 9], hdr);
        let shown = 2.118_872 / 2.0 * 0.6;
        let half: f64 = shown * (2.51 * shown + 0.03) / (shown * (2.43 * shown + 0.59) + 0.14);
        let difference = 116.0 * (0.85f64.cbrt() - half.cbrt());
        let expected = 0.95 * difference.powf(0.7) / (0.4 * f64::from(color::largest_difference()));
        assert!((found.flip.mean - expected).abs() < 1e-5, "{found:?} {expected}");
    }

    #[test]
    fn a_spot_looks_the_same_wherever_it_lies_among_the_tiles() {
        let size = [300, 290];
        let spot = |x: usize, y: usize| {
            let mut test = vec![0.1; size[0] * size[1]];
            test[y * size[0] + x] = 5.0;
            let map = with(size, &vec![0.1; size[0] * size[1]], &test, ldr_map);
            let at = |i: usize| map[(y + i / 41 - 20) * size[0] + x + i % 41 - 20];
            (0..41 * 41).map(at).collect::<Vec<f32>>()
        };
        let inside = spot(60, 60);
        assert!(inside[20 * 41 + 20] > 0.5 && inside[0] == 0.0);
        for (x, y) in [(127, 60), (128, 128), (60, 120), (257, 255)] {
            assert!(spot(x, y) == inside, "{x} {y}");
        }
    }

    #[test]
    fn a_pixel_that_is_not_finite_is_seen_in_the_mean() {
        let mut test = vec![0.5; 400];
        test[77] = f32::INFINITY;
        for map in [with([20, 20], &[0.5; 400], &test, ldr_map), with([20, 20], &test, &[0.5; 400], hdr_map)] {
            assert_eq!(map.iter().filter(|value| value.is_nan()).count(), 1);
            assert!(map[77].is_nan() && map[78] > 0.0);
            assert!(summary(&map).mean.is_nan() && summary(&map).max.is_nan());
        }
        // The same fault in both does not cancel.
        assert!(with([20, 20], &test, &test, ldr).mean.is_nan());
    }
}

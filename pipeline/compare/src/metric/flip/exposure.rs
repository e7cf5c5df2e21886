//! HDR-FLIP: the exposures at which a viewer would look at the reference, and the tone curve that shows it on a screen.

use rayon::prelude::*;
use serde::Serialize;

use crate::metric::{picture::Picture, select};

/// The coefficients of [`color::tone::aces`] in float32, and the factor on the light before it.
const ACES: [f32; 5] = {
    let [a, b, c, d, e] = color::tone::ACES;
    [a as f32, b as f32, c as f32, d as f32, e as f32]
};
const ACES_SCALE: f64 = 0.6;

/// The value that the curve gives the brightest pixel at the first exposure, and the median pixel at the last.
const SHOWN: f64 = 0.85;

/// How linear light is shown on a screen.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Tone {
    /// Light is clamped to 0..1.
    Clamp,
    /// Light is scaled by this factor, then mapped by the ACES curve and clamped.
    Aces(f32),
}

impl Tone {
    /// The light that the screen emits, 0 to 1, for light that is finite and not negative.
    #[inline(always)]
    pub fn show(self, light: f32) -> f32 {
        let Tone::Aces(scale) = self else { return light.min(1.0) };
        let [a, b, c, d, e] = ACES;
        // The curve is above 1 from far below this value on; beyond it, squares would become infinite.
        let x = (light * scale).min(1e4);
        ((x * (a * x + b)) / (x * (c * x + d) + e)).min(1.0)
    }
}

/// Evenly spaced exposures in stops, each of which doubles the light.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Exposures {
    /// The first exposure, at which the brightest pixel of the reference is just below saturation.
    pub start: f64,
    /// The last exposure, at which the median pixel is as bright as that.
    pub stop: f64,
    /// The number of exposures, both ends included.
    pub count: usize,
}

impl Exposures {
    /// The exposures for the reference.
    pub fn of(picture: &Picture<'_>) -> Exposures {
        let [r, g, b] = picture.reference;
        let luminance = |i: usize| {
            let light = |samples: &[f32]| if samples[i].is_finite() { samples[i].max(0.0) } else { 0.0 };
            let [red, green, blue] = color::LUMINANCE.map(|weight| weight as f32);
            (red * light(r) + green * light(g) + blue * light(b)).min(f32::MAX)
        };
        let median = select::select(r.len(), r.len() / 2, luminance);
        let brightest = (0..r.len()).into_par_iter().map(luminance).reduce(|| 0.0, f32::max);
        // Guards the division by zero: a black pixel would need an infinite exposure.
        let stops = |luminance: f32| (light_shown() / f64::from(luminance.max(f32::EPSILON))).log2();
        let (start, stop) = (stops(brightest), stops(median));
        Exposures { start, stop, count: ((stop - start).ceil() as usize).max(2) }
    }

    /// The tones of the exposures. If both ends are equal, they are one tone.
    pub(super) fn tones(&self) -> Vec<Tone> {
        let step = (self.stop - self.start) / (self.count - 1) as f64;
        let exposure = |i: usize| self.start + i as f64 * step;
        let mut tones: Vec<Tone> =
            (0..self.count).map(|i| Tone::Aces((ACES_SCALE * exposure(i).exp2()) as f32)).collect();
        tones.dedup();
        tones
    }
}

/// The light that the curve maps to [`SHOWN`]: the positive root of the quadratic.
fn light_shown() -> f64 {
    let [a, b, c, d, e] = ACES.map(f64::from);
    let (square, linear, constant) = (a - SHOWN * c, b - SHOWN * d, -SHOWN * e);
    let root = (linear * linear - 4.0 * square * constant).sqrt();
    (root - linear) / (2.0 * square) / ACES_SCALE
}

#[cfg(test)]
mod tests {
    use super::*;

    fn exposures(grays: &[f32]) -> Exposures {
        Exposures::of(&Picture { size: [grays.len(), 1], reference: [grays; 3], test: [grays; 3] })
    }

    #[test]
    fn the_curve_shows_black_gray_and_white() {
        let tone = Tone::Aces(ACES_SCALE as f32);
        assert_eq!(
            [tone.show(0.0), tone.show(f32::MAX), Tone::Clamp.show(0.3), Tone::Clamp.show(3.0)],
            [0.0, 1.0, 0.3, 1.0]
        );
        // 0.6 * (2.51 * 0.6 + 0.03) / (0.6 * (2.43 * 0.6 + 0.59) + 0.14)
        assert!((tone.show(1.0) - 0.9216 / 1.3688).abs() < 1e-6);
        assert!((f64::from(tone.show(light_shown() as f32)) - SHOWN).abs() < 1e-6);
    }

    #[test]
    fn stops_of_the_brightest_and_the_median() {
        // 2.118872 is shown as 0.85 because 2.51 * 0.36 x^2 + 0.018 x = 0.85 (2.43 * 0.36 x^2 + 0.354 x + 0.14).
        let stops = |light: f64| (2.118_872 / light).log2();
        let Exposures { start, stop, count } = exposures(&[16.0, 0.5, 4.0, 1.0, f32::NAN, -3.0]);
        // Sorted they are 0, 0, 0.5, 1, 4, 16; the median of an even number is the upper of the two in the middle.
        assert!((start - stops(16.0)).abs() < 1e-6 && (stop - stops(1.0)).abs() < 1e-6, "{start} {stop}");
        assert_eq!(count, 4);
        assert_eq!(exposures(&[16.0, 0.5, 4.0, 1.0]).tones().len(), 2);
        let ends = exposures(&[1.0, 1.0, 64.0]).tones();
        assert_eq!(ends.len(), 6);
        let Tone::Aces(last) = ends[5] else { panic!() };
        assert!((f64::from(last) - ACES_SCALE * 2.118_872).abs() < 1e-6);
    }

    #[test]
    fn a_uniform_or_black_picture_has_one_tone() {
        assert_eq!((exposures(&[0.5; 3]).count, exposures(&[0.5; 3]).tones().len()), (2, 1));
        let black = exposures(&[0.0; 4]);
        assert!(black.start.is_finite() && black.start == black.stop);
        assert!(exposures(&[f32::MAX, 0.0, 0.0]).count < 160);
    }
}

//! The colors of errors: black, violet, red, orange, yellow.
//!
//! Equal steps of the error are equal steps of lightness in Oklab, so that the picture can also be read in gray and by
//! those who do not tell red from green.

use color::{oklab, srgb};
use std::f64::consts::FRAC_PI_2;

/// The number of steps of the scale, which is more than eight bits of lightness can show.
pub(super) const STEPS: usize = 256;
/// The color of errors beyond the scale.
pub(super) const ABOVE: [u8; 3] = [255; 3];
/// The color of NaN and infinity, whose hue is not on the scale.
pub(super) const NOT_FINITE: [u8; 3] = [0, 255, 0];

/// The lightness in Oklab at the end of the scale, that of the yellow which is farthest from white.
const LIGHTEST: f64 = 0.9;
/// The hues at both ends in degrees. From violet the hue goes up through red.
const HUES: [f64; 2] = [285.0, 465.0];
/// The largest chroma of the scale.
const CHROMA: f64 = 0.185;

/// The numbers of pixels that the scale does not show.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Counts {
    pub above: u64,
    pub not_finite: u64,
}

impl Counts {
    /// The color of an error on a scale that ends at `max`. An error that is not finite is `None`.
    pub fn shade(&mut self, scale: &[[u8; 3]; STEPS], error: Option<f64>, max: f64) -> [u8; 3] {
        match error {
            None => {
                self.not_finite += 1;
                NOT_FINITE
            }
            Some(error) if error > max => {
                self.above += 1;
                ABOVE
            }
            Some(error) => scale[(error / max * (STEPS - 1) as f64).round() as usize],
        }
    }
}

/// The colors from no error to the end of the scale.
pub(super) fn scale() -> [[u8; 3]; STEPS] {
    std::array::from_fn(|step| color(step as f64 / (STEPS - 1) as f64))
}

/// The color at a part, 0 to 1, of the scale.
fn color(part: f64) -> [u8; 3] {
    let hue = (HUES[0] + (HUES[1] - HUES[0]) * part).to_radians();
    let lightness = LIGHTEST * part;
    let light = |chroma: f64| oklab::to_linear([lightness, chroma * hue.cos(), chroma * hue.sin()]);
    let wanted = CHROMA * (FRAC_PI_2 * part).sin().sqrt();
    // sRGB has no vivid dark colors: bisection finds the largest chroma that it can show; that of black is zero.
    let (mut chroma, mut step) = (wanted, wanted / 2.0);
    for _ in 0..20 {
        let shown = light(chroma).iter().all(|light| (0.0..=1.0).contains(light));
        chroma = (chroma + if shown { step } else { -step }).min(wanted);
        step /= 2.0;
    }
    light(chroma).map(srgb::encode_byte)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The paper's conversion from sRGB to lightness and to hue in degrees.
    fn lightness_and_hue(color: [u8; 3]) -> [f64; 2] {
        let [r, g, b] = color.map(srgb::decode_byte);
        let l = (0.412_221_470_8 * r + 0.536_332_536_3 * g + 0.051_445_992_9 * b).cbrt();
        let m = (0.211_903_498_2 * r + 0.680_699_545_1 * g + 0.107_396_956_6 * b).cbrt();
        let s = (0.088_302_461_9 * r + 0.281_718_837_6 * g + 0.629_978_700_5 * b).cbrt();
        let lightness = 0.210_454_255_3 * l + 0.793_617_785_0 * m - 0.004_072_046_8 * s;
        let red = 1.977_998_495_1 * l - 2.428_592_205_0 * m + 0.450_593_709_9 * s;
        let yellow = 0.025_904_037_1 * l + 0.782_771_766_2 * m - 0.808_675_766_0 * s;
        [lightness, yellow.atan2(red).to_degrees()]
    }

    /// The tolerance is half a step of eight bits. It is largest in the dark, where the cube root is steep: 0.04 of
    /// lightness near black, and 0.005 and three degrees of hue elsewhere. Seen to catch: no reduction of chroma, a
    /// wrong sign in a matrix.
    #[test]
    fn lightness_is_linear_in_the_error() {
        for (step, color) in scale().into_iter().enumerate() {
            let part = step as f64 / 255.0;
            let [lightness, hue] = lightness_and_hue(color);
            let (tolerance, turn) = if step < 26 { (0.04, 360.0) } else { (0.005, 3.0) };
            assert!((lightness - LIGHTEST * part).abs() < tolerance, "{step}: {color:?} {lightness}");
            let off = (hue - HUES[0] - (HUES[1] - HUES[0]) * part + 540.0).rem_euclid(360.0) - 180.0;
            assert!(off.abs() < turn, "{step}: {color:?} is off by {off} degrees");
        }
    }

    #[test]
    fn ends_and_other_colors_are_told_apart() {
        let scale = scale();
        assert_eq!(scale[0], [0; 3]);
        let [r, g, b] = scale[STEPS - 1];
        assert!(r > 230 && g > 200 && b < 80, "{:?}", scale[STEPS - 1]);
        let apart = |one: [u8; 3], two: [u8; 3]| (0..3).map(|c| one[c].abs_diff(two[c])).max().unwrap();
        for other in [ABOVE, NOT_FINITE] {
            assert!(scale.iter().all(|color| apart(*color, other) > 100));
        }
    }
}

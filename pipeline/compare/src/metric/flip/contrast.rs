//! Contrast sensitivity: filters of the opponent channels remove what is too fine to be seen. Color blurs more than
//! light.

use std::f64::consts::PI;

use crate::metric::convolve::gaussian;

/// The pixels of the screen in one degree of the visual field.
pub(super) const PIXELS_PER_DEGREE: f64 = 3840.0 * PI / 180.0;

/// The paper's a and b: each Gaussian is a sqrt(pi / b) exp(-pi^2 x^2 / b) with x in degrees.
const LIGHT: [f64; 2] = [1.0, 0.0047];
const RED_GREEN: [f64; 2] = [1.0, 0.0053];
const BLUE_YELLOW: [[f64; 2]; 2] = [[34.1, 0.04], [13.5, 0.025]];

/// A separable filter, with its weight among those that are added.
#[derive(Clone, Debug)]
pub(super) struct Blur {
    /// The taps along rows.
    pub rows: Vec<f32>,
    /// The taps along columns, times the weight.
    pub columns: Vec<f32>,
}

/// The filters of the three opponent channels.
#[derive(Clone, Debug)]
pub(super) struct Contrast {
    pub light: Blur,
    pub red_green: Blur,
    /// Two filters whose results are added.
    pub blue_yellow: [Blur; 2],
}

impl Default for Contrast {
    /// The filters for the screen of [`PIXELS_PER_DEGREE`].
    fn default() -> Contrast {
        let total: f64 = BLUE_YELLOW.iter().copied().map(volume).sum();
        Contrast {
            light: blur(LIGHT, 1.0),
            red_green: blur(RED_GREEN, 1.0),
            blue_yellow: BLUE_YELLOW.map(|term| blur(term, volume(term) / total)),
        }
    }
}

/// The standard deviation of a Gaussian in pixels.
fn sigma([_, b]: [f64; 2]) -> f64 {
    (b / (2.0 * PI * PI)).sqrt() * PIXELS_PER_DEGREE
}

/// The radius of all filters in pixels: three standard deviations of the widest Gaussian.
fn radius() -> usize {
    (3.0 * sigma(BLUE_YELLOW[0])).ceil() as usize
}

/// The sum that the weights of a Gaussian, cut off at the radius, would have over both dimensions.
fn volume([a, b]: [f64; 2]) -> f64 {
    let middle = gaussian(sigma([a, b]), radius())[0];
    a * (PI / b).sqrt() / (middle * middle)
}

/// A filter without the weights that float32 would not notice beside the others.
fn blur(term: [f64; 2], weight: f64) -> Blur {
    let taps = gaussian(sigma(term), radius());
    let taps = || taps.iter().copied().filter(|tap| *tap > 1e-9);
    Blur { rows: taps().map(|tap| tap as f32).collect(), columns: taps().map(|tap| (tap * weight) as f32).collect() }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::metric::tile::HALO;

    #[test]
    fn filters_fit_and_keep_the_mean() {
        let contrast = Contrast::default();
        let sum = |taps: &[f32]| 2.0 * taps.iter().sum::<f32>() - taps[0];
        let whole = |blur: &Blur| sum(&blur.rows) * sum(&blur.columns);
        let colors = contrast.blue_yellow.iter().map(whole).sum();
        for found in [whole(&contrast.light), whole(&contrast.red_green), colors] {
            // The tolerance is a few roundings of 1.
            assert!((found - 1.0).abs() < 1e-6, "{found}");
        }
        assert_eq!(radius(), HALO);
        assert!([&contrast.light, &contrast.red_green].iter().all(|blur| blur.rows.len() < HALO));
    }

    #[test]
    fn frequencies_fade_as_in_the_paper() {
        // The Fourier transform of the filter for light at f cycles per degree is exp(-b f^2). At 8 it is exp(-0.3008).
        let taps = Contrast::default().light.rows;
        let phase = |distance: usize| (2.0 * PI * 8.0 * distance as f64 / PIXELS_PER_DEGREE).cos();
        let pairs = taps.iter().enumerate().skip(1).map(|(distance, tap)| 2.0 * f64::from(*tap) * phase(distance));
        let found = f64::from(taps[0]) + pairs.sum::<f64>();
        // The tolerance is for the filter, which is sampled once per pixel.
        assert!((found - (-0.3008f64).exp()).abs() < 1e-3, "{found}");
    }
}

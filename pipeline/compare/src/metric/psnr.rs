//! The peak signal to noise ratio of display values, whose peak is 1.

use super::displayed::{DisplayedMetric, Scratch};
use super::tile::{HALO, MARGIN, PITCH, Tile};

/// The ratio in dB; it is infinite for equal pictures.
pub(super) const METRIC: DisplayedMetric = DisplayedMetric {
    key: "psnr",
    sum: squared_error,
    value: |sum, [width, height]| Ok(decibels(sum / (3.0 * (width * height) as f64))),
    words: |psnr| format!("PSNR {psnr:.3} dB"),
};

/// The sum of the squared error over the pixels of a tile.
fn squared_error(tile: Tile, Scratch { reference, test, .. }: &mut Scratch) -> f64 {
    let [width, height] = tile.size();
    let mut sum = 0.0;
    for row in HALO..HALO + height {
        for at in row * PITCH + MARGIN..row * PITCH + MARGIN + width {
            let error = f64::from(test[at] - reference[at]);
            sum += error * error;
        }
    }
    sum
}

/// The ratio of a mean squared error.
fn decibels(mean_squared_error: f64) -> f64 {
    -10.0 * mean_squared_error.log10()
}

#[cfg(test)]
mod tests {
    use super::decibels;

    #[test]
    fn known_ratios() {
        assert_eq!(decibels(0.0), f64::INFINITY);
        // An error of a tenth everywhere is 20 dB.
        assert!((decibels(0.01) - 20.0).abs() < 1e-12);
        assert!(decibels(f64::NAN).is_nan());
    }
}

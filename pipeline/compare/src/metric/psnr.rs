//! Peak signal to noise ratio, of display values whose peak is 1.

use super::tile::{HALO, MARGIN, PITCH, Plane, Tile};

/// Sum over the pixels of a tile, of planes of display values.
pub(super) fn squared_error(tile: Tile, reference: &Plane, test: &Plane) -> f64 {
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

/// Of a mean squared error; infinite without any.
pub(super) fn decibels(mean_squared_error: f64) -> f64 {
    -10.0 * mean_squared_error.log10()
}

#[cfg(test)]
mod tests {
    use super::decibels;

    #[test]
    fn known_ratios() {
        assert_eq!(decibels(0.0), f64::INFINITY);
        // An error of a tenth everywhere: 20 dB.
        assert!((decibels(0.01) - 20.0).abs() < 1e-12);
        assert!(decibels(f64::NAN).is_nan());
    }
}

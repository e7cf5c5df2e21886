//! Energy: is the test image brighter or darker on the whole? Noise cancels here, faults do not.

use super::Samples;

/// Of reference and test.
pub(super) fn means(samples: &Samples<'_>) -> [f64; 2] {
    [samples.mean(|reference, _| reference), samples.mean(|_, test| test)]
}

/// Positive where the test image is brighter. Against a black reference any light is infinitely more.
pub(super) fn relative_difference(reference: f64, test: f64) -> f64 {
    let difference = test - reference;
    // Guards 0/0: two black images have no bias.
    if difference == 0.0 { 0.0 } else { difference / reference.abs() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn known_means() {
        let samples = Samples { planes: vec![(&[1.0, 2.0], &[2.0, 2.5]), (&[3.0, 6.0], &[3.0, 0.0])] };
        assert_eq!(means(&samples), [3.0, 1.875]);
        assert_eq!(relative_difference(3.0, 1.875), -0.375);
    }

    #[test]
    fn sign_and_limits() {
        assert_eq!(relative_difference(-2.0, -1.0), 0.5);
        assert_eq!(relative_difference(0.0, 0.0), 0.0);
        assert_eq!(relative_difference(0.0, 1.0), f64::INFINITY);
        assert!(relative_difference(f64::NAN, 1.0).is_nan());
        assert!(relative_difference(f64::INFINITY, f64::INFINITY).is_nan());
    }
}

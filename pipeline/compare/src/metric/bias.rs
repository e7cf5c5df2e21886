//! Energy: is the test image brighter or darker on the whole? Noise cancels here, faults do not.

/// Positive where the test image is brighter. Against a black reference any light is infinitely more.
pub(super) fn relative_difference(reference: f64, test: f64) -> f64 {
    let difference = test - reference;
    // Guards 0/0: two black images have no bias.
    if difference == 0.0 { 0.0 } else { difference / reference.abs() }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::metric::{Samples, measure};

    #[test]
    fn known_means() {
        let samples = Samples { planes: vec![(&[1.0, 2.0], &[2.0, 2.5]), (&[3.0, 6.0], &[3.0, 0.0])] };
        let metrics = measure(&samples, 2, [0, 0]);
        assert_eq!([metrics.mean_reference, metrics.mean_test], [3.0, 1.875]);
        assert_eq!(metrics.bias, -0.375);
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

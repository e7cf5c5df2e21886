//! Error relative to the reference: dark and bright parts of the picture count alike.

/// Added to the squared reference, so that black pixels do not divide by zero; printed with every report.
pub const EPSILON: f64 = 0.01;

/// What the relative mean squared error is the mean of.
#[inline(always)]
pub(super) fn relative(reference: f64, test: f64) -> f64 {
    let error = test - reference;
    error * error / (reference * reference + EPSILON)
}

#[cfg(test)]
mod tests {
    use super::EPSILON;
    use crate::metric::{Samples, measure};

    #[test]
    fn known_errors() {
        // 0.5^2 / (0^2 + 0.01) = 25 and 1^2 / (3^2 + 0.01) = 1 / 9.01, over two samples.
        let samples = Samples { planes: vec![(&[0.0, 3.0], &[0.5, 4.0])] };
        let expected = (0.25 / EPSILON + 1.0 / 9.01) / 2.0;
        assert!((measure(&samples, 2, [0, 0]).relmse - expected).abs() < 1e-12);
    }

    #[test]
    fn one_value_that_is_not_finite_shows() {
        let samples = Samples { planes: vec![(&[1.0, f32::INFINITY], &[1.0, f32::INFINITY])] };
        assert!(measure(&samples, 2, [0, 0]).relmse.is_nan());
    }
}

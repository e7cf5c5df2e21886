//! Error in the units of the channel.

/// What the mean absolute error is the mean of.
#[inline(always)]
pub(super) fn absolute(reference: f64, test: f64) -> f64 {
    (test - reference).abs()
}

/// What the root mean squared error is the root of the mean of.
#[inline(always)]
pub(super) fn squared(reference: f64, test: f64) -> f64 {
    let error = test - reference;
    error * error
}

#[cfg(test)]
mod tests {
    use crate::metric::{Samples, measure};

    #[test]
    fn known_errors() {
        let samples = Samples { planes: vec![(&[1.0, 2.0], &[4.0, 2.0]), (&[0.0, 5.0], &[0.0, 1.0])] };
        let metrics = measure(&samples, 2, [0, 0]);
        assert_eq!((metrics.mae, metrics.rmse), (1.75, 2.5));
    }

    #[test]
    fn one_value_that_is_no_number_shows() {
        let metrics = measure(&Samples { planes: vec![(&[1.0, f32::NAN], &[1.0, f32::NAN])] }, 2, [0, 0]);
        assert!(metrics.mae.is_nan() && metrics.rmse.is_nan());
    }
}

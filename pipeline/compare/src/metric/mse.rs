//! Error in the units of the channel.

use super::Samples;

pub(super) fn mean_absolute_error(samples: &Samples<'_>) -> f64 {
    samples.mean(|reference, test| (test - reference).abs())
}

pub(super) fn root_mean_square_error(samples: &Samples<'_>) -> f64 {
    samples.mean(|reference, test| (test - reference).powi(2)).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn known_errors() {
        let samples = Samples { planes: vec![(&[1.0, 2.0], &[4.0, 2.0]), (&[0.0, 5.0], &[0.0, 1.0])] };
        assert_eq!(mean_absolute_error(&samples), 1.75);
        assert_eq!(root_mean_square_error(&samples), 2.5);
    }

    #[test]
    fn one_value_that_is_no_number_shows() {
        let samples = Samples { planes: vec![(&[1.0, f32::NAN], &[1.0, f32::NAN])] };
        assert!(mean_absolute_error(&samples).is_nan());
        assert!(root_mean_square_error(&samples).is_nan());
    }
}

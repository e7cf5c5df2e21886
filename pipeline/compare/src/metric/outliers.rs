//! Counts of pixels and samples that differ, and the gates on single pixels.

use rayon::prelude::*;

use super::gate_kind::{GateKind, GateValue};
use super::picture::Pair;

pub(super) const ABS: GateKind = GateKind {
    name: "max-abs",
    help: "Largest absolute error of any sample, in units of the channel",
    value: GateValue::Channel("max"),
};

pub(super) const OUTLIERS: GateKind = GateKind {
    name: "max-outliers",
    help: "At most N pixels may differ by more than T, in units of the channel",
    value: GateValue::Pixels(pixels_beyond),
};

pub(super) const EXACT: GateKind = GateKind {
    name: "exact",
    help: "Every bit must be equal; looks at all layers unless --layer says otherwise",
    value: GateValue::Samples(bitwise_differences),
};

/// The number of pixels of which any channel differs by more than the threshold, or by NaN.
pub(super) fn pixels_beyond(samples: &[Pair<'_>], threshold: f64) -> u64 {
    let pixels = samples.first().map_or(0, |(reference, _)| reference.len());
    let differs = |pixel: usize, (reference, test): &Pair<'_>| {
        let error = (f64::from(test[pixel]) - f64::from(reference[pixel])).abs();
        error.is_nan() || error > threshold
    };
    (0..pixels).into_par_iter().filter(|pixel| samples.iter().any(|pair| differs(*pixel, pair))).count() as u64
}

/// The number of samples whose bits differ. Those of the two zeroes differ, those of equal NaNs do not.
pub(crate) fn bitwise_differences(samples: &[Pair<'_>]) -> u64 {
    let planes = samples.par_iter();
    let pairs = planes.flat_map(|(reference, test)| reference.par_iter().zip(*test));
    pairs.filter(|(reference, test)| reference.to_bits() != test.to_bits()).count() as u64
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_pixel_counts_once_and_the_threshold_is_allowed() {
        let red = ([0.0; 4].as_slice(), [1.0, 2.0, 0.0, f32::NAN].as_slice());
        let green = ([0.0; 4].as_slice(), [0.0, 2.0, -1.5, 0.0].as_slice());
        assert_eq!(pixels_beyond(&[red, green], 1.0), 3);
        assert_eq!(pixels_beyond(&[red, green], 2.0), 1);
    }

    #[test]
    fn bits_of_zero_have_a_sign() {
        let differences = |reference: f32, test: f32| bitwise_differences(&[(&[1.0, reference], &[1.0, test])]);
        assert_eq!(differences(0.0, -0.0), 1);
        assert_eq!(differences(f32::NAN, f32::NAN), 0);
        assert_eq!(differences(f32::NAN, -f32::NAN), 1);
    }
}

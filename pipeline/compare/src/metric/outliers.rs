//! Single samples that are far off, which every mean hides.

use serde::Serialize;

use super::Samples;

/// The sample with the largest absolute error: the first of equals; one that is no number beats all.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Worst {
    /// Absolute error.
    pub error: f64,
    /// Column and row in the data window's coordinates, rows downwards.
    pub pixel: [i64; 2],
    /// Value of the reference there.
    pub reference: f64,
    /// Value of the test image there.
    pub test: f64,
}

pub(super) fn worst(samples: &Samples<'_>, width: usize, window: [i32; 2]) -> Worst {
    let pixels = samples.planes.first().map_or(1, |(reference, _)| reference.len()).max(1);
    let mut worst = Worst { error: 0.0, pixel: window.map(i64::from), reference: 0.0, test: 0.0 };
    for (number, (reference, test)) in samples.pairs().enumerate() {
        let error = (test - reference).abs();
        let first = number == 0;
        if first || (!worst.error.is_nan() && (error.is_nan() || error > worst.error)) {
            let (x, y) = (number % pixels % width.max(1), number % pixels / width.max(1));
            let pixel = [i64::from(window[0]) + x as i64, i64::from(window[1]) + y as i64];
            worst = Worst { error, pixel, reference, test };
        }
    }
    worst
}

/// Nearest rank: the smallest error that at least 99 % of the samples do not exceed. No number counts as largest.
pub(super) fn percentile_99(samples: &Samples<'_>) -> f64 {
    let mut errors: Vec<f64> = samples.pairs().map(|(reference, test)| (test - reference).abs()).collect();
    let rank = (errors.len() * 99).div_ceil(100);
    match rank.checked_sub(1) {
        Some(index) => *errors.select_nth_unstable_by(index, f64::total_cmp).1,
        None => 0.0,
    }
}

/// Pixels of which any channel differs by more than the threshold, or by no number.
pub(crate) fn pixels_beyond(samples: &Samples<'_>, threshold: f64) -> u64 {
    let pixels = samples.planes.first().map_or(0, |(reference, _)| reference.len());
    let within = |pixel: usize| {
        samples
            .planes
            .iter()
            .all(|(reference, test)| (f64::from(test[pixel]) - f64::from(reference[pixel])).abs() <= threshold)
    };
    (0..pixels).filter(|pixel| !within(*pixel)).count() as u64
}

/// Samples whose bits differ: the two zeroes do, equal NaNs do not.
pub(crate) fn bitwise_differences(samples: &Samples<'_>) -> u64 {
    let planes = samples.planes.iter();
    let pairs = planes.flat_map(|(reference, test)| reference.iter().zip(*test));
    pairs.filter(|(reference, test)| reference.to_bits() != test.to_bits()).count() as u64
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn worst_pixel_is_found_in_its_row_and_channel() {
        let first = ([0.0; 6].as_slice(), [0.0, 1.0, 0.0, 0.0, 0.0, -2.0].as_slice());
        let second = ([5.0; 6].as_slice(), [5.0, 5.0, 5.0, 5.0, 2.5, 5.0].as_slice());
        let found = worst(&Samples { planes: vec![first, second] }, 3, [10, -20]);
        assert_eq!(found, Worst { error: 2.5, pixel: [11, -19], reference: 5.0, test: 2.5 });
        let found = worst(&Samples { planes: vec![first] }, 3, [0, 0]);
        assert_eq!(found, Worst { error: 2.0, pixel: [2, 1], reference: 0.0, test: -2.0 });
    }

    #[test]
    fn no_number_is_worst() {
        let planes = vec![([0.0, 0.0, 0.0].as_slice(), [1.0, f32::NAN, f32::MAX].as_slice())];
        let found = worst(&Samples { planes }, 3, [0, 0]);
        assert!(found.error.is_nan());
        assert_eq!(found.pixel, [1, 0]);
    }

    #[test]
    fn percentile_of_the_first_numbers() {
        let numbers = |count: u16| (1..=count).map(f32::from).collect::<Vec<f32>>();
        for (count, expected) in [(1, 1.0), (99, 99.0), (100, 99.0), (101, 100.0), (200, 198.0)] {
            let (zeroes, errors) = (vec![0.0; usize::from(count)], numbers(count));
            assert_eq!(percentile_99(&Samples { planes: vec![(&zeroes, &errors)] }), expected);
        }
        let planes = vec![([0.0, 0.0].as_slice(), [-f32::NAN, 1.0].as_slice())];
        assert!(percentile_99(&Samples { planes }).is_nan());
    }

    #[test]
    fn a_pixel_counts_once_and_the_threshold_is_allowed() {
        let red = ([0.0; 4].as_slice(), [1.0, 2.0, 0.0, f32::NAN].as_slice());
        let green = ([0.0; 4].as_slice(), [0.0, 2.0, -1.5, 0.0].as_slice());
        assert_eq!(pixels_beyond(&Samples { planes: vec![red, green] }, 1.0), 3);
        assert_eq!(pixels_beyond(&Samples { planes: vec![red, green] }, 2.0), 1);
    }

    #[test]
    fn bits_of_zero_have_a_sign() {
        let differences = |reference: f32, test: f32| {
            bitwise_differences(&Samples { planes: vec![(&[1.0, reference], &[1.0, test])] })
        };
        assert_eq!(differences(0.0, -0.0), 1);
        assert_eq!(differences(f32::NAN, f32::NAN), 0);
        assert_eq!(differences(f32::NAN, -f32::NAN), 1);
    }
}

//! The largest error and the 99th percentile: single samples that are far off, which every mean hides.

use serde::Serialize;

use super::{picture::Pair, select};

/// The sample with the largest absolute error. Among equal errors it is the first; NaN counts as the largest.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Worst {
    /// The absolute error.
    pub error: f64,
    /// Its column and row in the coordinates of the data window; rows count downwards.
    pub pixel: [i64; 2],
    /// The value of the reference there.
    pub reference: f64,
    /// The value of the test image there.
    pub test: f64,
}

/// A sample and its error.
#[derive(Clone, Copy, Debug)]
pub(super) struct Found {
    pub error: f64,
    /// Its index in the plane.
    pub sample: usize,
    pub reference: f64,
    pub test: f64,
}

impl Found {
    /// The worse of two, and the first of two that are equal.
    #[inline(always)]
    pub fn worse(first: Option<Found>, second: Option<Found>) -> Option<Found> {
        match (first, second) {
            (Some(a), Some(b)) if a.error.is_nan() || !(b.error.is_nan() || b.error > a.error) => Some(a),
            (first, None) => first,
            (_, second) => second,
        }
    }

    /// The sample with its pixel in the data window. If there is none, it is the first pixel, without error.
    pub fn in_window(found: Option<Found>, width: usize, window: [i32; 2]) -> Worst {
        let window = window.map(i64::from);
        let Some(Found { error, sample, reference, test }) = found else {
            return Worst { error: 0.0, pixel: window, reference: 0.0, test: 0.0 };
        };
        let (x, y) = (sample % width.max(1), sample / width.max(1));
        Worst { error, pixel: [window[0] + x as i64, window[1] + y as i64], reference, test }
    }
}

/// The absolute error, rounded to float32. No finite error becomes infinite.
#[inline(always)]
fn error(reference: &[f32], test: &[f32], i: usize) -> f32 {
    let error = (f64::from(test[i]) - f64::from(reference[i])).abs();
    if error.is_finite() { error.min(f64::from(f32::MAX)) as f32 } else { error as f32 }
}

/// The errors of a channel, counted by the upper half of their bits.
pub(super) fn histogram((reference, test): Pair<'_>) -> select::Histogram {
    select::upper(reference.len(), |i| error(reference, test, i))
}

/// The 99th percentile by nearest rank: the smallest error that at least 99 % of the samples do not exceed. NaN counts
/// as the largest.
pub(super) fn percentile_99(samples: &[Pair<'_>], upper: &select::Histogram) -> f64 {
    let Some(rank) = (upper.iter().sum::<u64>() * 99).div_ceil(100).checked_sub(1) else { return 0.0 };
    let (bin, rank) = select::locate(upper, rank);
    let planes = samples.iter();
    let lower = planes.map(|(reference, test)| select::lower(reference.len(), |i| error(reference, test, i), bin));
    let lower = lower.reduce(|counts, others| select::and(counts, &others)).unwrap_or_default();
    f64::from(select::value(bin, select::locate(&lower, rank).0))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::metric::measure_each;

    fn worst(samples: &[Pair<'_>], width: usize, window: [i32; 2]) -> Worst {
        measure_each(samples, width, window).0.max
    }

    fn p99(planes: Vec<(&[f32], &[f32])>) -> f64 {
        measure_each(&planes, 1, [0, 0]).0.p99
    }

    #[test]
    fn worst_pixel_is_found_in_its_row_and_channel() {
        let first = ([0.0; 6].as_slice(), [0.0, 1.0, 0.0, 0.0, 0.0, -2.0].as_slice());
        let second = ([5.0; 6].as_slice(), [5.0, 5.0, 5.0, 5.0, 2.5, 5.0].as_slice());
        let found = worst(&[first, second], 3, [10, -20]);
        assert_eq!(found, Worst { error: 2.5, pixel: [11, -19], reference: 5.0, test: 2.5 });
        let found = worst(&[first], 3, [0, 0]);
        assert_eq!(found, Worst { error: 2.0, pixel: [2, 1], reference: 0.0, test: -2.0 });
    }

    #[test]
    fn nan_is_worst() {
        let planes = vec![([0.0, 0.0, 0.0].as_slice(), [1.0, f32::NAN, f32::MAX].as_slice())];
        let found = worst(&planes, 3, [0, 0]);
        assert!(found.error.is_nan());
        assert_eq!(found.pixel, [1, 0]);
    }

    #[test]
    fn percentile_of_the_first_numbers() {
        let numbers = |count: u16| (1..=count).map(f32::from).collect::<Vec<f32>>();
        for (count, expected) in [(1, 1.0), (99, 99.0), (100, 99.0), (101, 100.0), (200, 198.0)] {
            let (zeroes, errors) = (vec![0.0; usize::from(count)], numbers(count));
            assert_eq!(p99(vec![(&zeroes, &errors)]), expected);
        }
        // Of 3 * 50 errors of 1 to 150, 149 do not exceed the 149th.
        let (zeroes, errors) = (vec![0.0; 50], numbers(150));
        let thirds = errors.chunks(50).map(|errors| (zeroes.as_slice(), errors)).collect();
        assert_eq!(p99(thirds), 149.0);
        assert!(p99(vec![(&[0.0, 0.0], &[-f32::NAN, 1.0])]).is_nan());
        assert_eq!(p99(vec![(&[-f32::MAX], &[f32::MAX])]), f64::from(f32::MAX));
    }
}

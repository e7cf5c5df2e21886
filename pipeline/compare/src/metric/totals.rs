//! One pass over a channel: every sum and count that its metrics are made of.

use rayon::prelude::*;

use super::outliers::Found;
use super::{mse, rel_mse};

/// Samples that are summed one after the other. Fixed, so that the sums do not depend on the number of threads.
const CHUNK: usize = 1 << 16;

/// Sums over samples of both images.
#[derive(Clone, Debug, Default)]
pub(super) struct Totals {
    pub count: usize,
    pub reference: f64,
    pub test: f64,
    pub absolute: f64,
    pub squared: f64,
    pub relative: f64,
    pub nonfinite_reference: u64,
    pub nonfinite_test: u64,
    /// None without samples.
    pub worst: Option<Found>,
}

impl Totals {
    /// Of two planes of the same length.
    pub fn of(reference: &[f32], test: &[f32]) -> Totals {
        let pairs = reference.par_chunks(CHUNK).zip(test.par_chunks(CHUNK));
        let chunks: Vec<Totals> =
            pairs.enumerate().map(|(number, (reference, test))| chunk(number * CHUNK, reference, test)).collect();
        chunks.iter().fold(Totals::default(), Totals::and)
    }

    /// With the totals of samples that come later.
    pub fn and(self, later: &Totals) -> Totals {
        Totals {
            count: self.count + later.count,
            reference: self.reference + later.reference,
            test: self.test + later.test,
            absolute: self.absolute + later.absolute,
            squared: self.squared + later.squared,
            relative: self.relative + later.relative,
            nonfinite_reference: self.nonfinite_reference + later.nonfinite_reference,
            nonfinite_test: self.nonfinite_test + later.nonfinite_test,
            worst: Found::worse(self.worst, later.worst),
        }
    }

    /// A sum as the mean; zero without samples.
    pub fn mean(&self, sum: f64) -> f64 {
        sum / self.count.max(1) as f64
    }
}

fn chunk(first: usize, references: &[f32], tests: &[f32]) -> Totals {
    let mut totals = Totals { count: references.len(), ..Totals::default() };
    for (i, (&r, &t)) in references.iter().zip(tests).enumerate() {
        let (reference, test) = (f64::from(r), f64::from(t));
        totals.reference += reference;
        totals.test += test;
        totals.absolute += mse::absolute(reference, test);
        totals.squared += mse::squared(reference, test);
        totals.relative += rel_mse::relative(reference, test);
        totals.nonfinite_reference += u64::from(!r.is_finite());
        totals.nonfinite_test += u64::from(!t.is_finite());
        let found = Found { error: mse::absolute(reference, test), sample: first + i, reference, test };
        totals.worst = Found::worse(totals.worst, Some(found));
    }
    totals
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn chunks_make_the_whole() {
        let reference: Vec<f32> = (0..3 * CHUNK + 7).map(|i| (i % 1000) as f32).collect();
        let mut test = reference.clone();
        test[2 * CHUNK + 5] += 3.0;
        test[3 * CHUNK + 6] = f32::NAN;
        let totals = Totals::of(&reference, &test);
        assert_eq!(totals.count, reference.len());
        assert_eq!(totals.reference, reference.iter().copied().map(f64::from).sum::<f64>());
        assert_eq!((totals.nonfinite_reference, totals.nonfinite_test), (0, 1));
        assert_eq!(totals.worst.unwrap().sample, 3 * CHUNK + 6);
        test[3 * CHUNK + 6] = reference[3 * CHUNK + 6];
        let totals = Totals::of(&reference, &test);
        assert_eq!((totals.absolute, totals.squared), (3.0, 9.0));
        assert_eq!(totals.worst.unwrap().sample, 2 * CHUNK + 5);
    }
}

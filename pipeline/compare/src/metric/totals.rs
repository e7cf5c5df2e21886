//! One pass over a channel, which makes every sum and count that its metrics need.

use rayon::prelude::*;

use super::worst::Found;

/// The number of samples that are summed one after the other. It is fixed, so that sums do not depend on the number of
/// threads.
const CHUNK: usize = 1 << 16;

/// Computes the terms of all metrics from the values of reference and test image.
pub(super) trait Terms<const N: usize>: Fn(f64, f64) -> [f64; N] + Copy + Sync {}

impl<const N: usize, F: Fn(f64, f64) -> [f64; N] + Copy + Sync> Terms<N> for F {}

/// Sums over samples of both images.
#[derive(Clone, Debug)]
pub(super) struct Totals<const N: usize> {
    pub count: usize,
    pub reference: f64,
    pub test: f64,
    /// The sum of each metric's term.
    pub terms: [f64; N],
    pub nonfinite_reference: u64,
    pub nonfinite_test: u64,
    /// `None` if there are no samples.
    pub worst: Option<Found>,
}

impl<const N: usize> Default for Totals<N> {
    fn default() -> Totals<N> {
        let (reference, test, terms) = (0.0, 0.0, [0.0; N]);
        Totals { count: 0, reference, test, terms, nonfinite_reference: 0, nonfinite_test: 0, worst: None }
    }
}

impl<const N: usize> Totals<N> {
    /// The totals of two planes of the same length.
    pub fn of(reference: &[f32], test: &[f32], terms: impl Terms<N>) -> Totals<N> {
        let pairs = reference.par_chunks(CHUNK).zip(test.par_chunks(CHUNK)).enumerate();
        let chunks: Vec<Totals<N>> =
            pairs.map(|(number, (reference, test))| chunk(number * CHUNK, reference, test, terms)).collect();
        chunks.iter().fold(Totals::default(), Totals::and)
    }

    /// These totals with those of samples that come later.
    pub fn and(mut self, later: &Totals<N>) -> Totals<N> {
        self.count += later.count;
        self.reference += later.reference;
        self.test += later.test;
        self.terms.iter_mut().zip(&later.terms).for_each(|(sum, term)| *sum += term);
        self.nonfinite_reference += later.nonfinite_reference;
        self.nonfinite_test += later.nonfinite_test;
        self.worst = Found::worse(self.worst, later.worst);
        self
    }

    /// The mean that a sum makes; it is zero if there are no samples.
    pub fn mean(&self, sum: f64) -> f64 {
        sum / self.count.max(1) as f64
    }
}

fn chunk<const N: usize>(first: usize, references: &[f32], tests: &[f32], terms: impl Terms<N>) -> Totals<N> {
    let mut totals = Totals { count: references.len(), ..Totals::default() };
    for (i, (&r, &t)) in references.iter().zip(tests).enumerate() {
        let (reference, test) = (f64::from(r), f64::from(t));
        totals.reference += reference;
        totals.test += test;
        totals.terms.iter_mut().zip(terms(reference, test)).for_each(|(sum, term)| *sum += term);
        totals.nonfinite_reference += u64::from(!r.is_finite());
        totals.nonfinite_test += u64::from(!t.is_finite());
        let found = Found { error: (test - reference).abs(), sample: first + i, reference, test };
        totals.worst = Found::worse(totals.worst, Some(found));
    }
    totals
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn chunks_make_the_whole() {
        let of = |reference: &[f32], test: &[f32]| Totals::of(reference, test, |r: f64, t: f64| [(t - r).abs(), r]);
        let reference: Vec<f32> = (0..3 * CHUNK + 7).map(|i| (i % 1000) as f32).collect();
        let mut test = reference.clone();
        test[2 * CHUNK + 5] += 3.0;
        test[3 * CHUNK + 6] = f32::NAN;
        let totals = of(&reference, &test);
        assert_eq!(totals.count, reference.len());
        assert_eq!([totals.reference; 2], [totals.terms[1], reference.iter().copied().map(f64::from).sum::<f64>()]);
        assert_eq!((totals.nonfinite_reference, totals.nonfinite_test), (0, 1));
        assert_eq!(totals.worst.unwrap().sample, 3 * CHUNK + 6);
        test[3 * CHUNK + 6] = reference[3 * CHUNK + 6];
        let totals = of(&reference, &test);
        assert_eq!(totals.terms[0], 3.0);
        assert_eq!(totals.worst.unwrap().sample, 2 * CHUNK + 5);
    }
}

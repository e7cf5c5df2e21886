//! The value of a given rank without sorting or copying, by two histograms over the bits of float32.
//!
//! The bits of numbers that are not negative have the order of the numbers, with infinity and then NaN at the end. The
//! first histogram, over the upper half of the bits, finds the bin of the value; the second, over the lower half of the
//! bits of the numbers in that bin, finds the value. Counts do not depend on the order in which they are made.

use rayon::prelude::*;

/// The number of samples that one thread counts at a time.
const CHUNK: usize = 1 << 20;

/// Counts for each value of sixteen bits.
pub(super) type Histogram = Vec<u64>;

/// Counts by the upper half of the bits of the keys, which are not negative.
pub(super) fn upper(length: usize, key: impl Fn(usize) -> f32 + Sync) -> Histogram {
    histogram(length, |i| Some((key(i).to_bits() >> 16) as u16))
}

/// Counts by the lower half of the bits of the keys whose upper half is `bin`.
pub(super) fn lower(length: usize, key: impl Fn(usize) -> f32 + Sync, bin: u16) -> Histogram {
    histogram(length, |i| {
        let bits = key(i).to_bits();
        ((bits >> 16) as u16 == bin).then_some(bits as u16)
    })
}

/// The sum of two histograms.
pub(super) fn and(mut counts: Histogram, others: &Histogram) -> Histogram {
    counts.iter_mut().zip(others).for_each(|(count, other)| *count += other);
    counts
}

/// The bin of this rank, from 0, and the rank within it.
pub(super) fn locate(counts: &Histogram, mut rank: u64) -> (u16, u64) {
    for (bin, count) in counts.iter().enumerate() {
        if rank < *count {
            return (bin as u16, rank);
        }
        rank -= count;
    }
    (u16::MAX, 0)
}

/// The value whose halves these are.
pub(super) fn value(upper: u16, lower: u16) -> f32 {
    f32::from_bits(u32::from(upper) << 16 | u32::from(lower))
}

/// The key of this rank, from 0, among keys that are not negative.
pub(super) fn select(length: usize, rank: usize, key: impl Fn(usize) -> f32 + Sync) -> f32 {
    let (bin, rank) = locate(&upper(length, &key), rank as u64);
    value(bin, locate(&lower(length, &key, bin), rank).0)
}

fn histogram(length: usize, bin: impl Fn(usize) -> Option<u16> + Sync) -> Histogram {
    let empty = || vec![0; 1 << 16];
    let chunk = |number: usize| {
        let mut counts = empty();
        for i in number * CHUNK..length.min((number + 1) * CHUNK) {
            if let Some(bin) = bin(i) {
                counts[usize::from(bin)] += 1;
            }
        }
        counts
    };
    (0..length.div_ceil(CHUNK)).into_par_iter().map(chunk).reduce(empty, |counts, others| and(counts, &others))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_rank_of_a_shuffled_list() {
        // 611 and 1000 have no common factor, so that each of 0..1000 comes once.
        let keys: Vec<f32> = (0..1000).map(|i| (i * 611 % 1000) as f32 * 1.000_1).collect();
        for rank in [0, 1, 7, 500, 998, 999] {
            assert_eq!(select(keys.len(), rank, |i| keys[i]), rank as f32 * 1.000_1);
        }
    }

    #[test]
    fn infinity_and_nan_come_last() {
        let keys = [f32::NAN, 3.0, f32::INFINITY, f32::MAX, 0.0];
        let ranked = [0.0, 3.0, f32::MAX, f32::INFINITY];
        assert_eq!([0, 1, 2, 3].map(|rank| select(5, rank, |i| keys[i])), ranked);
        assert!(select(5, 4, |i| keys[i]).is_nan());
    }
}

//! Well-spread numbers: Sobol's sequence in four dimensions under Owen's scrambling.
//!
//! Every prefix of the sequence is spread evenly, and each coordinate of each point is uniform over the scrambles:
//! means are unbiased whatever the number of points. The scrambling is a hash that changes each bit by the bits above
//! it only (Laine and Karras 2011, with Vegdahl's multipliers; Burley 2020), followed by a random digital shift.

use crate::random::{Item, Stream};

/// The number of coordinates of a point.
pub const DIMENSIONS: usize = 4;

/// The number of points of a sequence.
pub const LENGTH: u64 = 1 << 32;

/// Columns of Sobol's matrices for dimensions 2 to 4, with their bits reversed (Joe and Kuo 2008); the first dimension
/// is the index with its bits reversed.
const COLUMNS: [[u32; 32]; DIMENSIONS - 1] =
    [columns(1, 0, [1, 0, 0]), columns(2, 1, [1, 3, 0]), columns(3, 1, [1, 3, 1])];

/// The columns of a primitive polynomial of `degree` with inner coefficients `inner` and initial numbers `m`.
const fn columns(degree: usize, inner: u32, m: [u32; 3]) -> [u32; 32] {
    let (mut v, mut reversed) = ([0u32; 32], [0; 32]);
    let mut k = 0;
    while k < 32 {
        if k < degree {
            v[k] = m[k] << (31 - k);
        } else {
            v[k] = v[k - degree] ^ (v[k - degree] >> degree);
            let mut j = 1;
            while j < degree {
                if (inner >> (degree - 1 - j)) & 1 == 1 {
                    v[k] ^= v[k - j];
                }
                j += 1;
            }
        }
        reversed[k] = v[k].reverse_bits();
        k += 1;
    }
    reversed
}

/// One scrambled sequence.
#[derive(Clone, Copy, Debug)]
pub struct Sequence {
    seeds: [[u32; 2]; DIMENSIONS],
    shifts: [u32; DIMENSIONS],
    rest: Stream,
}

impl Sequence {
    /// The sequence that `key` scrambles; `rest` gives the bits of its numbers after the first 32.
    pub fn new(key: Item, rest: Stream) -> Sequence {
        let word = |d: usize, k: u64| key.bits(3 * d as u64 + k) as u32;
        let dimensions: [usize; DIMENSIONS] = std::array::from_fn(|d| d);
        Sequence { seeds: dimensions.map(|d| [word(d, 0), word(d, 1)]), shifts: dimensions.map(|d| word(d, 2)), rest }
    }

    /// Point `index`, in [0, 1)⁴. The bits after the first 32, which distinguish no two points, are independent random
    /// bits.
    pub fn point(&self, index: u32) -> [f64; DIMENSIONS] {
        let rest = self.rest.item(u64::from(index));
        std::array::from_fn(|d| {
            let reversed = if d == 0 { index } else { sobol_reversed(&COLUMNS[d - 1], index) };
            let [one, two] = self.seeds[d];
            let high = scramble(scramble(reversed, one), two).reverse_bits() ^ self.shifts[d];
            // 32 bits of the sequence, 21 random ones.
            let low = rest.bits(d as u64) >> 43;
            ((u64::from(high) << 21) | low) as f64 * (1.0 / (1u64 << 53) as f64)
        })
    }
}

/// The point that a point of the square becomes at the step `index` of a sequence that fills the square evenly (Roberts
/// 2018); the first is the point itself.
pub fn turned([x, y]: [f64; 2], index: usize) -> [f64; 2] {
    const STEPS: [f64; 2] = [0.754_877_666_246_692_7, 0.569_840_290_998_053_2];
    let steps = STEPS.map(|step| index as f64 * step);
    [(x + steps[0]).fract(), (y + steps[1]).fract()]
}

/// Another place in the order of a sequence for each place, which random `bits` choose: sequences of which one is taken in
/// this order are independent of each other, where the same index of two is a point of one curve. Aligned points stay
/// together, `2^k` for each k (Burley 2020), and are spread as evenly as before.
pub fn shuffled(index: u32, bits: u64) -> u32 {
    scramble(scramble(index.reverse_bits(), bits as u32), (bits >> 32) as u32).reverse_bits()
}

fn sobol_reversed(columns: &[u32; 32], mut index: u32) -> u32 {
    let mut value = 0;
    while index != 0 {
        value ^= columns[index.trailing_zeros() as usize];
        index &= index - 1;
    }
    value
}

/// A bijection in which bit k of the result depends on bits 0 to k alone.
fn scramble(mut x: u32, seed: u32) -> u32 {
    x ^= x.wrapping_mul(0x3d20_adea);
    x = x.wrapping_add(seed);
    x = x.wrapping_mul((seed >> 16) | 1);
    x ^= x.wrapping_mul(0x0552_6c56);
    x ^ x.wrapping_mul(0x53a2_2864)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Purpose;

    fn sequence(seed: u64) -> Sequence {
        let stream = Stream::new(seed, Purpose::Surface);
        Sequence::new(stream.item(0), stream)
    }

    /// Of the first 2^m points, each interval of length 2^-m of each axis holds one, and so does each box of area 2^-m
    /// of the first two axes: a (0, m, 2)-net, which scrambling keeps. Seen to catch: a wrong initial number, a
    /// scramble that mixes downwards.
    #[test]
    fn powers_of_two_are_nets() {
        for (seed, m) in [(1, 4), (2, 8), (3, 10)] {
            let points: Vec<_> = (0..1u32 << m).map(|i| sequence(seed).point(i)).collect();
            for first in 0..=m {
                let cell = |p: &[f64; 4], d: usize, bits: i32| (p[d] * 2f64.powi(bits)) as usize;
                let mut boxes = vec![0; 1 << m];
                points.iter().for_each(|p| boxes[cell(p, 0, first) << (m - first) | cell(p, 1, m - first)] += 1);
                assert!(boxes.iter().all(|n| *n == 1), "{seed} {m} {first}");
                for d in 0..DIMENSIONS {
                    let mut line = vec![0; 1 << m];
                    points.iter().for_each(|p| line[cell(p, d, m)] += 1);
                    assert!(line.iter().all(|n| *n == 1), "{seed} {m} {d}");
                }
            }
        }
    }

    /// Two sequences in the same order are strongly related: of the boxes of their first coordinates together many stay
    /// empty. In another order each box has its share, and the first 2^m points are still a net.
    ///
    /// Seen to catch: the order left as it is.
    #[test]
    fn in_another_order_two_sequences_are_independent() {
        let (m, n) = (10, 1u32 << 10);
        let filled = |order: &dyn Fn(u32) -> u32| {
            let mut boxes = vec![false; 1024];
            let (one, two) = (sequence(1), sequence(2));
            for index in 0..n {
                let cell = |x: f64| (x * 32.0) as usize;
                boxes[32 * cell(one.point(index)[0]) + cell(two.point(order(index))[0])] = true;
            }
            boxes.iter().filter(|full| **full).count()
        };
        // Of 1024 boxes, 1024 independent points leave 377 empty, with a standard deviation of 10.
        assert!(filled(&|index| index) < 100);
        assert!(filled(&|index| shuffled(index, 0x1234_5678_9abc_def0)) > 550);
        let mut line = vec![0; n as usize];
        for index in 0..n {
            line[(sequence(3).point(shuffled(index, 77))[1] * f64::from(1 << m)) as usize] += 1;
        }
        assert!(line.iter().all(|n| *n == 1));
    }

    #[test]
    fn one_point_is_uniform_over_the_scrambles() {
        let n = 20_000;
        for index in [0, 1, 1000] {
            let mut sum = [0.0; DIMENSIONS];
            let mut product = 0.0;
            for seed in 0..n {
                let p = sequence(seed).point(index);
                (0..DIMENSIONS).for_each(|d| sum[d] += p[d] - 0.5);
                product += (p[0] - 0.5) * (p[1] - 0.5);
            }
            let sigma = (n as f64 / 12.0).sqrt();
            // Five standard deviations; the seeds are fixed.
            assert!(sum.iter().all(|s| s.abs() < 5.0 * sigma), "{index} {sum:?}");
            assert!(product.abs() < 5.0 * (n as f64).sqrt() / 12.0, "{index} {product}");
        }
    }

    /// Sums of smooth functions converge almost as n^-3/2, not as n^-1/2.
    #[test]
    fn a_smooth_sum_converges_fast() {
        let error = |n: u32| {
            let runs = 16;
            let squares: f64 = (0..runs)
                .map(|seed| {
                    let s = sequence(seed);
                    let sum: f64 = (0..n).map(|i| s.point(i)).map(|p| p[0] * p[0] + p[1]).sum();
                    (sum / f64::from(n) - 5.0 / 6.0).powi(2)
                })
                .sum();
            (squares / runs as f64).sqrt()
        };
        assert!(error(4096) < error(256) / 30.0, "{} {}", error(256), error(4096));
        assert!(error(3000) < 0.3 / 3000f64.sqrt() / 5.0);
    }
}

//! The square of what a fit leaves, without the noise of the walks (docs/method.md 16.6).

/// A part of the surface, or of the light that leaves it towards some directions.
#[derive(Clone, Copy, Debug)]
pub struct Part {
    /// Its share of the images.
    pub weight: f64,
    /// Its radiance, in units of white.
    pub radiance: f64,
    /// The counts of each half of the walks, and those that the fit of each half expects.
    pub counts: [f64; 2],
    pub expected: [f64; 2],
}

/// relMSE, and the standard error of the estimate.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Misfit {
    pub energy: f64,
    pub scatter: f64,
}

/// The squared radiance that is added to the denominator of relMSE, in units of white.
pub const DARK: f64 = 0.01;

/// An estimate is more than noise above this many standard errors: of eight scales, none of noise alone should be.
const SIGNIFICANT: f64 = 3.0;

impl Misfit {
    /// Of parts that together are all of the images. The misfits of the two halves of the walks are independent, so that
    /// their product estimates the square of what both share, without any noise on average.
    pub fn of(parts: impl Iterator<Item = Part>) -> Misfit {
        let (mut energy, mut squares) = (0.0, 0.0);
        for part in parts.filter(|part| part.expected.iter().all(|m| *m > 0.0)) {
            let [a, b] = [0, 1].map(|half| part.counts[half] / part.expected[half] - 1.0);
            let square = part.radiance * part.radiance;
            let product = part.weight * square / (square + DARK) * a * b;
            energy += product;
            squares += product * product;
        }
        Misfit { energy, scatter: squares.sqrt() }
    }

    pub fn is_significant(&self) -> bool {
        self.energy > SIGNIFICANT * self.scatter
    }

    /// Of estimates by finer and finer parts, the last that is more than noise: finer parts hold more of the misfit, and
    /// more noise. If all are noise, nothing, with the standard error of the finest.
    pub fn finest(scales: &[Misfit]) -> Misfit {
        let significant = scales.iter().rev().find(|misfit| misfit.is_significant());
        let noise = Misfit { energy: 0.0, scatter: scales.last().map_or(0.0, |misfit| misfit.scatter) };
        significant.copied().unwrap_or(noise)
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use crate::fit::tests::poisson;
    use scene::random::{Purpose, Stream};

    const PARTS: usize = 1024;

    /// Counts of each half of walks at as many parts, of a mean that is off by `off` from what is expected.
    pub fn drawn(off: impl Fn(usize) -> f64, expected: &[f64], seed: u64) -> [Vec<f64>; 2] {
        let stream = Stream::new(seed, Purpose::LightWalk);
        let count = expected.len();
        [0, 1].map(|half| {
            let one = |k: usize| poisson(stream.item((half * count + k) as u64), expected[k] * (1.0 + off(k)));
            (0..count).map(one).collect()
        })
    }

    /// Estimates by 16, 64, 256 and 1024 parts of radiance 1, each half with 100 counts of each of the finest.
    fn scales(off: impl Fn(usize) -> f64, seed: u64) -> Vec<Misfit> {
        let expected = vec![100.0; PARTS];
        let counts = drawn(off, &expected, seed);
        let part = |own: &[usize]| {
            let sum = |of: &[f64]| own.iter().map(|k| of[*k]).sum::<f64>();
            let weight = own.len() as f64 / PARTS as f64;
            Part {
                weight,
                radiance: 1.0,
                counts: counts.each_ref().map(|half| sum(half)),
                expected: [sum(&expected); 2],
            }
        };
        let all: Vec<usize> = (0..PARTS).collect();
        [64, 16, 4, 1].map(|size| Misfit::of(all.chunks(size).map(part))).to_vec()
    }

    /// Five per cent up and down in blocks of sixteen parts, and ten from part to part, which have a noise of ten per cent
    /// in each half.
    ///
    /// Seen to catch: the square of the misfit of one half; the coarsest scale in place of the finest.
    #[test]
    fn a_planted_misfit_is_found_without_the_noise_of_the_walks() {
        let sign = |odd: usize| if odd.is_multiple_of(2) { 1.0 } else { -1.0 };
        let off = |k: usize| 0.05 * sign(k / 16) + 0.1 * sign(k);
        for seed in 0..8 {
            let found = Misfit::finest(&scales(off, seed));
            let planted = (0.05f64.powi(2) + 0.1f64.powi(2)) / (1.0 + DARK);
            assert!((found.energy / planted - 1.0).abs() < 0.2, "seed {seed}: {found:?} for {planted:e}");
            assert!((found.energy - planted).abs() < 4.0 * found.scatter, "seed {seed}: {found:?} for {planted:e}");
        }
    }

    /// Seen to catch: estimates that are said from one standard error on; the square of the misfit of one half.
    #[test]
    fn nothing_is_found_where_there_is_nothing_but_noise() {
        for seed in 0..8 {
            let found = Misfit::finest(&scales(|_| 0.0, seed));
            assert_eq!(found.energy, 0.0, "seed {seed}");
            // The root of the number of parts over the counts of a half.
            let expected = (PARTS as f64).sqrt() / (100.0 * PARTS as f64);
            assert!((found.scatter / expected - 1.0).abs() < 0.3, "seed {seed}: {found:?} for {expected:e}");
        }
    }
}

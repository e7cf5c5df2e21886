//! Shares the paths of an image out among its pixels by their noise, which is mostly that of silhouettes: a few pixels
//! in a hundred have nine tenths of the squared error.
//!
//! The first paths are the same number for all pixels. A pixel's share of all further ones follows from the variance of
//! the first paths of its neighbors, and never from its own, so that its mean and the estimate of its variance stay free
//! of bias (docs/method.md 13.10).

use rayon::prelude::*;
use scene::random::Stream;

/// How far away, in columns and rows, the neighbors of a pixel may be.
const REACH: usize = 2;

/// The least noise that is expected of a pixel whose neighbors have any, as a share of the root mean square of those
/// pixels': few paths miss what is rare.
const FLOOR: f64 = 0.1;

/// The shares of the pixels of an image in its paths.
#[derive(Clone, Debug)]
pub struct Allotment {
    /// Paths that every pixel has.
    pub base: u32,
    /// The share of each pixel in all further paths. Those of pixels whose neighbors have noise are 1 on average, but
    /// for edge pixels, of which none has less than 1.
    pub shares: Vec<f64>,
    /// Random numbers by which the pixels' numbers of paths are rounded.
    rounding: Stream,
}

impl Allotment {
    /// The given shares.
    pub fn new(base: u32, shares: Vec<f64>, rounding: Stream) -> Allotment {
        Allotment { base, shares, rounding }
    }

    /// The shares that follow from the variance of each pixel after `base` paths, and from which pixels are edges, of an
    /// image of this width, in pixels, row by row.
    pub fn by_noise(base: u32, width: usize, variances: &[f64], edges: &[bool], rounding: Stream) -> Allotment {
        let mut shares: Vec<f64> =
            (0..variances.len()).into_par_iter().map(|pixel| noise_around(pixel, width, variances)).collect();
        let noisy = || shares.iter().filter(|noise| **noise > 0.0);
        let count = noisy().count() as f64;
        let least = FLOOR * (noisy().map(|noise| noise * noise).sum::<f64>() / count).sqrt();
        let mean = noisy().map(|noise| noise.max(least)).sum::<f64>() / count;
        // Where no pixel has noise, nothing distinguishes them. The noise of an edge pixel may be its own alone.
        let share = |noise: f64, is_edge: bool| (noise.max(least) / mean).max(if is_edge { 1.0 } else { 0.0 });
        for (own, is_edge) in shares.iter_mut().zip(edges) {
            *own = if count > 0.0 { share(*own, *is_edge) } else { 1.0 };
        }
        Allotment { base, shares, rounding }
    }

    /// The number of paths of a pixel where the shares add up to `level` paths for each: it never falls with the level,
    /// and is the base and an even number. A random number of the pixel decides the direction in which it is rounded.
    pub fn paths(&self, pixel: usize, level: u32) -> u32 {
        if level <= self.base {
            return level;
        }
        let own = self.rounding.item(pixel as u64).uniform(0);
        let pairs = f64::from(level - self.base) * self.shares[pixel] / 2.0 + own;
        self.base.saturating_add((pairs as u32).saturating_mul(2))
    }

    /// The variance that is expected of the image at this level, in units of its own.
    pub fn expected_variance(&self, level: u32) -> f64 {
        let of_pixel = |(pixel, share): (usize, &f64)| share * share / f64::from(self.paths(pixel, level));
        self.shares.iter().enumerate().map(of_pixel).sum()
    }
}

/// The standard deviation that is expected of a pixel: the root mean square of its neighbors'.
fn noise_around(pixel: usize, width: usize, variances: &[f64]) -> f64 {
    let around = |x: usize, size: usize| x.saturating_sub(REACH)..(x + REACH + 1).min(size);
    let (columns, rows) = (around(pixel % width, width), around(pixel / width, variances.len() / width));
    let (mut sum, mut count) = (0.0, 0.0f64);
    for neighbor in rows.flat_map(|y| columns.clone().map(move |x| y * width + x)).filter(|other| *other != pixel) {
        sum += variances[neighbor];
        count += 1.0;
    }
    (sum / count.max(1.0)).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;
    use scene::random::Purpose;

    fn by_noise(width: usize, variances: &[f64]) -> Allotment {
        Allotment::by_noise(4, width, variances, &vec![false; variances.len()], Stream::new(1, Purpose::Allotment))
    }

    /// By hand: in a row, the neighbors of the inner pixels have the mean variances 4/3, 1, 1/4 and 1/3. Pixels without
    /// noise around them, the noisy ones too, have the least share, and no edge pixel has less than 1.
    ///
    /// Seen to catch: a pixel that is its own neighbor; the mean of standard deviations for the root of that of
    /// variances; a floor for noisy neighbors alone; shares that are 1 on average over all pixels; edge pixels like all
    /// others, or alone.
    #[test]
    fn neighbors_decide() {
        let (variances, stream) = ([4.0, 0.0, 0.0, 0.0, 0.0, 1.0], Stream::new(1, Purpose::Allotment));
        let edges = [false, true, false, true, false, true];
        let shares = Allotment::by_noise(4, 6, &variances, &edges, stream).shares;
        let noise = [4.0 / 3.0, 1.0, 1.0 / 4.0, 1.0 / 3.0].map(f64::sqrt);
        let mean = noise.iter().sum::<f64>() / 4.0;
        let least = FLOOR * ((4.0 / 3.0 + 1.0 + 1.0 / 4.0 + 1.0 / 3.0) / 4.0f64).sqrt();
        let expected = [least / mean, noise[0] / mean, noise[1] / mean, 1.0, noise[3] / mean, 1.0];
        assert!(shares.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-12), "{shares:?}, {expected:?}");
    }

    /// Corners, borders and the middle of an image of 9 x 7 pixels: the variance of a pixel changes the shares of all
    /// pixels within two columns and rows, over that of one far away, and not its own.
    ///
    /// Seen to catch: a pixel that is its own neighbor; neighbors across the border of a row; the height for the width.
    #[test]
    fn a_pixel_has_no_say_in_its_own_share() {
        let (width, height) = (9, 7);
        let variances: Vec<f64> = (0..width * height).map(|k| 1.0 + (k * 37 % 64) as f64 / 64.0).collect();
        for pixel in [0, 8, 9, 31, 44, 54, 62] {
            let mut louder = variances.clone();
            louder[pixel] += 1.0;
            let [before, after] = [&variances, &louder].map(|variances| by_noise(width, variances).shares);
            let away = |other: usize| {
                let (dx, dy) = ((other % width).abs_diff(pixel % width), (other / width).abs_diff(pixel / width));
                dx.max(dy)
            };
            let far = (0..width * height).max_by_key(|other| away(*other)).expect("a pixel");
            for other in 0..width * height {
                let grown = after[other] / after[far] * before[far] / before[other];
                let is_near = (1..=REACH).contains(&away(other));
                assert!(if is_near { grown > 1.001 } else { (grown - 1.0).abs() < 1e-12 }, "{pixel} {other}: {grown}");
            }
        }
    }

    /// Seen to catch: the quotient of nothing by nothing.
    #[test]
    fn pixels_without_noise_are_alike() {
        for (width, variances) in [(1, &[3.0][..]), (2, &[0.0; 6]), (1, &[0.0; 3])] {
            assert!(by_noise(width, variances).shares.iter().all(|share| *share == 1.0), "{variances:?}");
        }
    }

    /// The numbers of paths grow by pairs, never fall as the level rises, and have the means that the shares promise: the
    /// mean of 10,000 pixels, rounded up or down by two, is within 0.05, five standard deviations.
    ///
    /// Seen to catch: another random number for each level; rounding down; odd numbers of paths.
    #[test]
    fn paths_follow_the_level() {
        let stream = Stream::new(7, Purpose::Allotment);
        for base in [4, 5] {
            for share in [0.07, 0.9, 3.3] {
                let allotment = Allotment::new(base, vec![share; 10_000], stream);
                let mut before = vec![0; 10_000];
                for level in [1, base, base + 1, base + 2, base + 7, 64, 65] {
                    let paths: Vec<u32> = (0..10_000).map(|pixel| allotment.paths(pixel, level)).collect();
                    assert!(paths.iter().zip(&before).all(|(now, before)| now >= before), "{base} {share} {level}");
                    assert!(level <= base || paths.iter().all(|paths| (paths - base).is_multiple_of(2)));
                    let mean = paths.iter().sum::<u32>() as f64 / 1e4;
                    let expected = f64::from(level.min(base)) + share * f64::from(level.saturating_sub(base));
                    assert!((mean - expected).abs() < 0.05, "{base} {share} {level}: {mean}, {expected}");
                    before = paths;
                }
            }
        }
    }

    /// By hand: shares of 1 and 3 have 4 + 8 and 4 + 24 paths at the level of 12.
    ///
    /// Seen to catch: the square of the share left out; the level for the paths of a pixel.
    #[test]
    fn the_expected_variance_is_that_of_the_shares() {
        let allotment = Allotment::new(4, vec![1.0, 3.0], Stream::new(7, Purpose::Allotment));
        assert!((allotment.expected_variance(12) - (1.0 / 12.0 + 9.0 / 28.0)).abs() < 1e-12);
        assert!((allotment.expected_variance(2) - 5.0).abs() < 1e-12);
    }
}

//! Errors of images, however they were made.
//!
//! A reference is the mean of several independent images, and has an error of its own. Its square is estimated from
//! their spread and subtracted, which is unbiased because the tested images are independent of them.

use crate::speed::picture::Picture;

/// A converged image and its remaining error.
pub struct Reference {
    mean: Vec<f64>,
    /// Squared standard error of each value of `mean`.
    variance: Vec<f64>,
    object: Vec<bool>,
}

impl Reference {
    /// The mean of two or more images of independent clouds and independent paths.
    pub fn of(pictures: &[Picture]) -> Reference {
        let count = pictures.len() as f64;
        let each = |f: &dyn Fn(usize) -> f64| (0..pictures[0].values.len()).map(f).collect::<Vec<f64>>();
        let mean = each(&|k| pictures.iter().map(|p| p.values[k]).sum::<f64>() / count);
        let square = |k: usize| pictures.iter().map(|p| (p.values[k] - mean[k]).powi(2)).sum::<f64>();
        let variance = each(&|k| square(k) / (count * (count - 1.0)));
        Reference { mean, variance, object: pictures[0].object.clone() }
    }

    /// Sum of the squares of the true image.
    fn power(&self) -> f64 {
        let known = self.mean.iter().map(|r| r * r).sum::<f64>();
        let noise = self.variance.iter().sum::<f64>();
        if known > noise { known - noise } else { known }
    }

    /// Mean square of the true image's values.
    pub fn mean_square(&self) -> f64 {
        self.power() / self.mean.len() as f64
    }

    /// Its own relative RMSE.
    pub fn own_error(&self) -> f64 {
        (self.variance.iter().sum::<f64>() / self.power()).sqrt()
    }

    /// Squared relative RMSE of a whole image, all channels. May be negative by chance, if the reference is the worse.
    pub fn squared_error(&self, test: &Picture) -> f64 {
        let triples = test.values.iter().zip(&self.mean).zip(&self.variance);
        triples.map(|((t, r), v)| (t - r).powi(2) - v).sum::<f64>() / self.power()
    }

    /// `relMSE` over the object: the mean of `(t - r)² / (r² + 0.01)`.
    pub fn relative_mse(&self, test: &Picture) -> f64 {
        let error = |k: usize| {
            let r = self.mean[k];
            ((test.values[k] - r).powi(2) - self.variance[k]) / (r * r + 0.01)
        };
        let inside: Vec<usize> = (0..self.mean.len()).filter(|k| self.object[k / 3]).collect();
        inside.iter().map(|k| error(*k)).sum::<f64>() / inside.len().max(1) as f64
    }

    /// Relative excess of the mean brightness of the whole image; the error of a single cloud contributes to it.
    pub fn bias(&self, test: &Picture) -> f64 {
        test.values.iter().sum::<f64>() / self.mean.iter().sum::<f64>() - 1.0
    }
}

/// The root of a squared relative RMSE, which may be negative by chance.
pub fn root(squared: f64) -> f64 {
    squared.max(0.0).sqrt()
}

/// The parts of the squared relative error of an image.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Parts {
    /// Part of the paths and the estimator, which another seed of `gather` changes.
    pub paths: f64,
    /// Part of the cloud, which another seed of `sample-surface` changes, without the noise of the paths; none for a
    /// single cloud.
    pub cloud: Option<f64>,
}

/// Splits the error of images of several clouds, each with the same two seeds of the gather; `mean_square` is that of
/// the true image.
///
/// Two images of one cloud differ by the paths alone. The difference between two clouds under one seed and that under
/// the other share nothing but the clouds, so the mean of their products is the squared error of the clouds, however
/// few the paths.
pub fn parts(crossed: &[[Picture; 2]], mean_square: f64) -> Parts {
    let (clouds, size) = (crossed.len(), crossed[0][0].values.len());
    let scale = 1.0 / (2.0 * mean_square * size as f64);
    let sum = |f: &dyn Fn(usize) -> f64| scale * (0..size).map(f).sum::<f64>();
    let value = |cloud: usize, seed: usize, k: usize| crossed[cloud][seed].values[k];
    let noise = |i: usize| sum(&|k| (value(i, 0, k) - value(i, 1, k)).powi(2));
    let paths = (0..clouds).map(noise).sum::<f64>() / clouds as f64;
    let between = |i: usize, j: usize, seed: usize, k: usize| value(i, seed, k) - value(j, seed, k);
    let shared = |(i, j): &(usize, usize)| sum(&|k| between(*i, *j, 0, k) * between(*i, *j, 1, k));
    let pairs: Vec<(usize, usize)> = (0..clouds).flat_map(|i| (i + 1..clouds).map(move |j| (i, j))).collect();
    let cloud = pairs.iter().map(shared).sum::<f64>() / pairs.len().max(1) as f64;
    Parts { paths, cloud: (clouds > 1).then_some(cloud) }
}

/// Relative RMSE of each channel, from the spread of images that differ by their clouds alone, with the same paths.
pub fn spread(pictures: &[Picture]) -> [f64; 3] {
    let count = pictures.len() as f64;
    let mut sums = [(0.0, 0.0); 3];
    for k in 0..pictures[0].values.len() {
        let mean = pictures.iter().map(|p| p.values[k]).sum::<f64>() / count;
        let square = pictures.iter().map(|p| (p.values[k] - mean).powi(2)).sum::<f64>() / (count - 1.0);
        let (error, power) = &mut sums[k % 3];
        *error += square;
        *power += mean * mean - square / count;
    }
    sums.map(|(error, power)| (error / power).sqrt())
}

/// Relative RMSE of one image against an exact one.
pub fn difference(test: &Picture, exact: &Picture) -> f64 {
    let error: f64 = test.values.iter().zip(&exact.values).map(|(t, r)| (t - r).powi(2)).sum();
    (error / exact.values.iter().map(|r| r * r).sum::<f64>()).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;
    use test_support::random::Random;

    const PIXELS: usize = 20_000;

    /// An image of ones with independent noise of standard deviation `paths`, times one plus `cloud` in each pixel.
    fn noisy(paths: f64, cloud: &[f64], random: &mut Random) -> Picture {
        let normal = |random: &mut Random| (0..12).map(|_| random.uniform()).sum::<f64>() - 6.0;
        let values = cloud.iter().map(|c| 1.0 + c + paths * normal(random)).collect();
        Picture { values, object: vec![true; PIXELS] }
    }

    fn cloud(deviation: f64, random: &mut Random) -> Vec<f64> {
        noisy(deviation, &[0.0; 3 * PIXELS], random).values.iter().map(|x| x - 1.0).collect()
    }

    #[test]
    fn the_reference_s_own_noise_is_subtracted() {
        let mut random = Random(1);
        let none = [0.0; 3 * PIXELS];
        let four: Vec<Picture> = (0..4).map(|_| noisy(0.1, &none, &mut random)).collect();
        let reference = Reference::of(&four);
        assert!((reference.own_error() - 0.05).abs() < 0.001);
        let test = noisy(0.1, &none, &mut random);
        let squared = reference.squared_error(&test);
        assert!((squared / 0.01 - 1.0).abs() < 0.05, "{squared}");
        assert!((reference.relative_mse(&test) - squared).abs() < 3e-4);
        assert!(reference.bias(&test).abs() < 0.003);
    }

    #[test]
    fn parts_are_told_apart_however_noisy_the_paths() {
        let mut random = Random(2);
        let crossed: Vec<[Picture; 2]> = (0..4)
            .map(|_| {
                let cloud = cloud(0.05, &mut random);
                [noisy(0.2, &cloud, &mut random), noisy(0.2, &cloud, &mut random)]
            })
            .collect();
        let both = parts(&crossed, 1.0);
        assert!((both.paths / 0.04 - 1.0).abs() < 0.03, "{both:?}");
        assert!((both.cloud.unwrap() / 0.0025 - 1.0).abs() < 0.1, "{both:?}");
        assert_eq!(parts(&crossed[..1], 1.0).cloud, None);
    }

    #[test]
    fn the_spread_is_that_of_the_clouds() {
        let mut random = Random(3);
        let pictures: Vec<Picture> = (0..4).map(|_| noisy(0.05, &[0.0; 3 * PIXELS], &mut random)).collect();
        assert!(spread(&pictures).iter().all(|x| (x / 0.05 - 1.0).abs() < 0.02));
        let exact = noisy(0.0, &[0.0; 3 * PIXELS], &mut random);
        assert!((difference(&pictures[0], &exact) / 0.05 - 1.0).abs() < 0.02);
    }
}

//! Trial clouds: small independent clouds, which tell what one difference of two halves cannot: how many independent
//! values the error of a cloud consists of, from one that is the same everywhere on the surface to many.
//!
//! The light that leaves the points of the surface by one half of a trial is a vector; `d` is the difference of the
//! vectors of both halves, and `C` its covariance. If `d` is normal, `|d|²` scatters as a chi-square distribution with
//! `ν = (tr C)²/tr C²` degrees of freedom (Satterthwaite 1946). Here `tr C` is the mean of `|d|²`, and `tr C²` the mean
//! of `(d · d')²` over pairs of trials. Rare light makes `|d|²` scatter more; so the scatter gives a second estimate of
//! `ν`, and the smaller one counts.

use crate::{
    plan::{Plan, SampleError, Settings},
    points::{Goal, Points},
    portions::sample,
};
use rayon::prelude::*;
use scene::{Rays, Scene, random};
use sums::confidence::Estimate;

/// Trial clouds in a round.
pub const TRIALS: u64 = 8;

/// Halves of all trial clouds.
const HALVES: f64 = 2.0 * TRIALS as f64;

/// Points of the surface at which the trials are compared.
const POINTS: u64 = 256;

/// The statistics of one round of trial clouds.
#[derive(Clone, Copy, Debug)]
pub struct Trials {
    /// Samples of each trial.
    pub samples: u64,
    /// Lit samples of all trials.
    pub lit: u64,
    /// The relative error of the mean of all trials, with the degrees of freedom of all; none if no light leaves the
    /// surface.
    pub mean: Option<Estimate>,
    /// Degrees of freedom of the difference of the two halves of one trial.
    pub freedom: f64,
}

impl Trials {
    /// Draws trials of `samples` each, all with their own random numbers.
    pub fn draw(
        (scene, rays): (&Scene, &Rays),
        settings: &Settings,
        plan: &Plan,
        goal: &Goal,
        samples: u64,
    ) -> Result<Trials, SampleError> {
        let points = Points::new(scene, settings, plan, goal, POINTS);
        let trial = |index: u64| {
            let mut own = Settings { samples, ..settings.clone() };
            // No shard that is ever drawn has the same random numbers: none has so large a count.
            own.options.seed = random::shard_seed(settings.seed(), index as u32, u32::MAX);
            own.options.shard = formats::cloud::Shard::ALONE;
            let sampled = sample(scene, rays, &own, plan, |_| ())?;
            let halves = [0, 1].map(|half| points.light(&sampled, half, index));
            Ok((sampled.content.samples, halves))
        };
        let drawn: Result<Vec<_>, SampleError> = (0..TRIALS).into_par_iter().map(trial).collect();
        let (lit, halves): (Vec<u64>, Vec<[Vec<f64>; 2]>) = drawn?.into_iter().unzip();
        let freedom = freedom(&halves);
        let error = error_of_mean(&halves);
        let mean = error.map(|error| Estimate { error, freedom: (HALVES - 1.0) * freedom });
        Ok(Trials { samples, lit: lit.iter().sum(), mean, freedom })
    }

    /// Samples of all trials together.
    pub fn all(&self) -> u64 {
        TRIALS * self.samples
    }

    /// An upper bound of the relative error of a cloud of more samples: the error of independent samples, which falls
    /// as the root of their number. It is 0 if no light leaves the surface.
    pub fn error_bound(&self, samples: u64) -> f64 {
        let root = (self.all() as f64 / samples as f64).sqrt();
        self.mean.map_or(0.0, |mean| mean.error * root)
    }
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// The relative standard error of the mean of all halves; none if the mean is zero.
fn error_of_mean(trials: &[[Vec<f64>; 2]]) -> Option<f64> {
    let halves = || trials.iter().flatten();
    let mut mean = vec![0.0; halves().next().map_or(0, Vec::len)];
    halves().for_each(|v| mean.iter_mut().zip(v).for_each(|(m, x)| *m += x / HALVES));
    let power = dot(&mean, &mean);
    let scatter: f64 = halves().map(|v| v.iter().zip(&mean).map(|(x, m)| (x - m) * (x - m)).sum::<f64>()).sum();
    (power > 0.0).then(|| (scatter / (HALVES * (HALVES - 1.0)) / power).sqrt())
}

/// The degrees of freedom of the difference of the two halves of one trial, at least one.
fn freedom(trials: &[[Vec<f64>; 2]]) -> f64 {
    let difference = |[one, two]: &[Vec<f64>; 2]| one.iter().zip(two).map(|(a, b)| a - b).collect::<Vec<f64>>();
    let differences: Vec<Vec<f64>> = trials.iter().map(difference).collect();
    let squares: Vec<f64> = differences.iter().map(|d| dot(d, d)).collect();
    let count = squares.len() as f64;
    let mean = squares.iter().sum::<f64>() / count;
    let scatter = squares.iter().map(|s| (s - mean) * (s - mean)).sum::<f64>() / (count - 1.0);
    let mut products = 0.0;
    for (k, one) in differences.iter().enumerate() {
        products += differences[..k].iter().map(|two| dot(one, two).powi(2)).sum::<f64>();
    }
    let shared = products / (0.5 * count * (count - 1.0));
    // If the halves do not differ, nothing is known, and one degree of freedom is assumed.
    let ratio = |of: f64| if of > 0.0 { mean * mean / of } else { 1.0 };
    ratio(shared).min(2.0 * ratio(scatter)).max(1.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Trials of `length` values for each half, with normal errors of equal variance, each shared by `together` values.
    fn trials(length: usize, together: usize) -> Vec<[Vec<f64>; 2]> {
        let stream = random::Stream::new(7, random::Purpose::CutCorrection);
        let half = |half: u64| {
            let normal = |k: u64| (0..12).map(|d| stream.item(half << 32 | k).uniform(d)).sum::<f64>() - 6.0;
            (0..length).map(|k| 100.0 + normal((k / together) as u64)).collect()
        };
        (0..TRIALS).map(|k| [half(2 * k), half(2 * k + 1)]).collect()
    }

    /// 256 values have independent errors, or four errors that 64 share each, or one error that all share.
    ///
    /// Seen to catch: differences multiplied by themselves instead of one another; the number of values in place of
    /// their correlation.
    #[test]
    fn shared_values_are_one_degree_of_freedom() {
        for (together, low, high) in [(1, 60.0, 600.0), (64, 1.5, 9.0), (256, 1.0, 2.0)] {
            let trials = trials(256, together);
            let found = freedom(&trials);
            assert!((low..high).contains(&found), "{together} together: {found}");
            // The mean of 16 halves has a quarter of the error of one half, which is 1 %.
            let error = error_of_mean(&trials).expect("there is light");
            assert!((0.001..0.004).contains(&error), "{error}");
        }
        assert_eq!(error_of_mean(&[[vec![0.0; 3], vec![0.0; 3]]]), None);
    }
}

//! Finds the number of samples with which the error of the light that leaves the surface meets a target. This is the
//! only part of phase one that depends on a medium, and only the number of samples depends on it.
//!
//! The difference of a cloud's two halves estimates its error. That estimate follows a chi-square distribution: a
//! search that stopped at the first small estimate would often stop by chance. Trial clouds therefore show first how
//! many degrees of freedom the estimate has ([`crate::trials`]). With many, the halves are trusted within the bounds of
//! Student's distribution. With few, as where all light comes through one small hole, larger trials are drawn until the
//! error of their mean, which 16 independent halves estimate well, meets the target; one cloud of as many samples as
//! all trials has no larger error.

use crate::{
    plan::{Plan, SampleError, Settings},
    points::{Goal, Points, relative_error},
    portions::{Sampled, sample},
    trials::{TRIALS, Trials},
};
use scene::{Rays, Scene};
use std::ops::ControlFlow;
use sums::confidence::Estimate;

/// The result of a round of the search.
#[derive(Clone, Copy, Debug)]
pub enum Round {
    /// The result of trial clouds.
    Trials(Trials),
    /// The number of samples of a cloud, and its error as estimated from its halves.
    Cloud(u64, Estimate),
}

/// A cloud that meets the target.
pub struct SufficientCloud {
    pub sampled: Sampled,
    /// The error of its light; none if no sample carries light.
    pub estimate: Option<Estimate>,
}

/// Points of the surface at which the error is measured.
const POINTS: u64 = 1024;

/// Samples of the first trials, all together, and the fewest of the first cloud.
const FIRST: u64 = 1 << 16;

/// The error of well-spread samples is taken to fall as their number to the power 3/4; this is the inverse.
const POWER: f64 = 4.0 / 3.0;

/// The fewest lit samples in all trials: the scatter of fewer is no reliable estimate.
const MIN_LIT: u64 = 32;

/// A scene is considered dark if none of this many samples is lit.
const SEARCH: u64 = 1 << 24;

/// The fewest degrees of freedom with which one difference of two halves is trusted.
const MANY: f64 = 8.0;

/// The degrees of freedom are measured again for a cloud with more than this many times the samples of all trials.
const STALE: u64 = 8;

/// The largest growth from one cloud to the next, and from one round of trials to the next: larger trials may turn out
/// to have more degrees of freedom.
const CLOUDS_GROW: f64 = 64.0;
const TRIALS_GROW: f64 = 8.0;

/// The error of one cloud, which is two well-spread halves, relative to that of the mean of trials with as many samples
/// in all.
const GAIN: f64 = 0.5;

/// A cloud whose error exceeds the bound from trials by this factor has found light that the trials had not.
const SURPRISE: f64 = 1.5;

/// A search for the number of samples that meets a goal.
pub struct Search<'a> {
    pub scene: &'a Scene,
    pub rays: &'a Rays<'a>,
    pub settings: &'a Settings,
    pub plan: &'a Plan,
    pub goal: &'a Goal<'a>,
    /// Called with each round.
    pub tell: &'a (dyn Fn(&Round) + Sync),
}

impl Search<'_> {
    /// Draws clouds of more and more samples until one meets the target.
    pub fn run(&self) -> Result<SufficientCloud, SampleError> {
        let mut trials = self.trials(FIRST.min(self.goal.max_samples))?;
        loop {
            let samples = trials.all();
            let error = match trials.mean {
                None => return Ok(SufficientCloud { sampled: self.cloud(samples)?, estimate: None }),
                Some(mean) if trials.freedom < MANY && mean.safe() <= self.goal.error => {
                    return Ok(SufficientCloud { sampled: self.cloud(samples)?, estimate: Some(mean) });
                }
                Some(mean) => mean.safe(),
            };
            trials = if trials.freedom < MANY {
                self.trials(self.more(samples, error, TRIALS_GROW)?)?
            } else {
                match self.by_halves(trials)? {
                    ControlFlow::Break(cloud) => return Ok(cloud),
                    ControlFlow::Continue(trials) => trials,
                }
            };
        }
    }

    fn cloud(&self, samples: u64) -> Result<Sampled, SampleError> {
        let settings = Settings { samples, ..self.settings.clone() };
        sample(self.scene, self.rays, &settings, self.plan, |_| ())
    }

    /// The number of samples to try next, given that `samples` have this error.
    fn more(&self, samples: u64, error: f64, max_growth: f64) -> Result<u64, SampleError> {
        let growth = (error / self.goal.error).powf(POWER).clamp(1.5, max_growth);
        let (next, max_samples) = ((samples as f64 * growth).ceil() as u64, self.goal.max_samples);
        if next > max_samples { Err(SampleError::TooMany { samples, error, next, max_samples }) } else { Ok(next) }
    }

    /// Draws trials with at least `samples` in total, enough of them lit unless the scene is dark.
    fn trials(&self, mut samples: u64) -> Result<Trials, SampleError> {
        let Search { scene, rays, settings, plan, goal, .. } = *self;
        loop {
            let trials = Trials::draw((scene, rays), settings, plan, goal, samples.div_ceil(TRIALS))?;
            (self.tell)(&Round::Trials(trials));
            let max_samples = if trials.lit == 0 { SEARCH.min(goal.max_samples) } else { goal.max_samples };
            if trials.lit >= MIN_LIT || samples >= max_samples {
                return Ok(trials);
            }
            // The number of lit samples varies, so it is aimed above the minimum.
            let growth = 1.5 * MIN_LIT as f64 / trials.lit.max(1) as f64;
            samples = ((samples as f64 * growth.clamp(2.0, 16.0)) as u64).min(max_samples);
        }
    }

    /// Draws clouds whose error their halves estimate, until one meets the target, or larger trials turn out to have few
    /// degrees of freedom.
    fn by_halves(&self, mut trials: Trials) -> Result<ControlFlow<SufficientCloud, Trials>, SampleError> {
        let points = Points::new(self.scene, self.settings, self.plan, self.goal, POINTS);
        let mut samples = self.first_cloud(&trials)?;
        loop {
            let sampled = self.cloud(samples)?;
            let error = relative_error(&points, &sampled).unwrap_or(f64::INFINITY);
            let mut estimate = Estimate { error, freedom: trials.freedom };
            let enough = |estimate: &Estimate| estimate.safe() <= self.goal.error;
            let checked = if error > SURPRISE * trials.error_bound(samples) {
                Some(samples)
            } else {
                (enough(&estimate) && samples > STALE * trials.all()).then_some(samples / STALE)
            };
            if let Some(checked) = checked {
                // The cloud stays in memory beside the new trials.
                trials = self.trials(checked.min(self.goal.max_samples - samples).max(TRIALS))?;
                if trials.freedom < MANY {
                    return Ok(ControlFlow::Continue(trials));
                }
                estimate.freedom = trials.freedom;
            }
            (self.tell)(&Round::Cloud(samples, estimate));
            if enough(&estimate) {
                return Ok(ControlFlow::Break(SufficientCloud { sampled, estimate: Some(estimate) }));
            }
            samples = self.more(samples, estimate.safe(), CLOUDS_GROW)?;
        }
    }

    /// Samples of the first cloud whose error its halves estimate: somewhat fewer than the trials suggest.
    fn first_cloud(&self, trials: &Trials) -> Result<u64, SampleError> {
        let all = trials.all();
        match GAIN * trials.error_bound(all) {
            error if error > self.goal.error => self.more(all, error, CLOUDS_GROW),
            _ => Ok(FIRST.min(self.goal.max_samples)),
        }
    }
}

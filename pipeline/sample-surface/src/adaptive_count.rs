//! How many samples are enough: as many as bring the error of the light that leaves the surface to a target. The one
//! place where phase one knows a medium; the samples themselves depend on their number alone.
//!
//! The error of a cloud is what its two halves differ by. That is one value of a chi-square, and whoever draws until it
//! is small stops when it is small by luck. So trial clouds tell first how many degrees of freedom it has
//! ([`crate::trials`]). If it has many, the halves are believed, as far as Student's law does. If it has few, as where
//! all light comes through one small hole, the trials themselves are drawn larger until the error of their mean is small
//! enough, which 16 independent halves know well; one cloud of as many samples as all trials has no larger error.

use crate::{
    Plan, SampleError, Sampled, Settings,
    points::{Goal, Points, relative_error},
    sample,
    trials::{TRIALS, Trials},
};
use scene::{Rays, Scene};
use sums::confidence::Estimate;

/// What a round of samples has shown.
#[derive(Clone, Copy, Debug)]
pub enum Round {
    /// Trial clouds.
    Trials(Trials),
    /// A cloud of so many samples, by its two halves.
    Cloud(u64, Estimate),
}

/// A cloud that is good enough.
pub struct Enough {
    pub sampled: Sampled,
    /// Of its light; none if no sample carries any.
    pub estimate: Option<Estimate>,
}

/// Points that the error is measured at.
const POINTS: u64 = 1024;

/// Samples of the first trials, all together, and of the first cloud at least.
const FIRST: u64 = 1 << 16;

/// The number of samples is raised as if the error of well-spread ones fell as their number to the power 3/4.
const POWER: f64 = 4.0 / 3.0;

/// Samples that carry light in all trials, at least: of fewer the scatter of the trials says little.
const MIN_LIT: u64 = 32;

/// Samples that are drawn in search of light. A scene in which none of so many carries any is taken for dark.
const SEARCH: u64 = 1 << 24;

/// Degrees of freedom that make one difference of two halves an estimate.
const MANY: f64 = 8.0;

/// Trials tell the degrees of freedom of clouds that have at most so many times the samples of all of them together.
const STALE: u64 = 8;

/// Clouds grow by this factor at most from one to the next. So do trials of few degrees of freedom, of which larger ones
/// may have more.
const CLOUDS_GROW: f64 = 64.0;
const TRIALS_GROW: f64 = 8.0;

/// The error of one cloud, two well-spread halves, as a share of that of the mean of trials of as many samples.
const GAIN: f64 = 0.5;

/// A cloud that has so many times the error that trials foretold shows light that they had not found.
const SURPRISE: f64 = 1.5;

/// Draws clouds of more and more samples until one is good enough.
pub fn sample_enough(
    scene: &Scene,
    rays: &Rays,
    settings: &Settings,
    plan: &Plan,
    goal: &Goal,
    tell: impl Fn(&Round) + Sync,
) -> Result<Enough, SampleError> {
    let search = Search { scene, rays, settings, plan, goal, tell: &tell };
    let mut trials = search.trials(FIRST.min(goal.most))?;
    loop {
        let samples = trials.all();
        let error = match trials.mean {
            None => return Ok(Enough { sampled: search.cloud(samples)?, estimate: None }),
            Some(mean) if trials.freedom < MANY && mean.safe() <= goal.error => {
                return Ok(Enough { sampled: search.cloud(samples)?, estimate: Some(mean) });
            }
            Some(mean) => mean.safe(),
        };
        trials = if trials.freedom < MANY {
            search.trials(search.more(samples, error, TRIALS_GROW)?)?
        } else {
            match search.by_halves(trials)? {
                Found::Enough(enough) => return Ok(*enough),
                Found::Few(trials) => trials,
            }
        };
    }
}

/// What comes of clouds that are judged by their halves.
enum Found {
    Enough(Box<Enough>),
    /// Larger trials have but few degrees of freedom.
    Few(Trials),
}

struct Search<'a> {
    scene: &'a Scene,
    rays: &'a Rays<'a>,
    settings: &'a Settings,
    plan: &'a Plan,
    goal: &'a Goal<'a>,
    tell: &'a (dyn Fn(&Round) + Sync),
}

impl Search<'_> {
    fn cloud(&self, samples: u64) -> Result<Sampled, SampleError> {
        let settings = Settings { samples, ..self.settings.clone() };
        sample(self.scene, self.rays, &settings, self.plan, |_| ())
    }

    /// How many samples to try next where so many have this error: `max_growth` times as many at most.
    fn more(&self, samples: u64, error: f64, max_growth: f64) -> Result<u64, SampleError> {
        let growth = (error / self.goal.error).powf(POWER).clamp(1.5, max_growth);
        let (next, most) = ((samples as f64 * growth).ceil() as u64, self.goal.most);
        if next > most { Err(SampleError::TooMany { samples, error, next, most }) } else { Ok(next) }
    }

    /// Trials of so many samples in all, or of more, until enough carry light; dark ones if none does.
    fn trials(&self, mut samples: u64) -> Result<Trials, SampleError> {
        let Search { scene, rays, settings, plan, goal, .. } = *self;
        loop {
            let trials = Trials::draw((scene, rays), settings, plan, goal, samples.div_ceil(TRIALS))?;
            (self.tell)(&Round::Trials(trials));
            let most = if trials.lit == 0 { SEARCH.min(goal.most) } else { goal.most };
            if trials.lit >= MIN_LIT || samples >= most {
                return Ok(trials);
            }
            // Their number varies: somewhat more samples than would do by those that were found.
            let growth = 1.5 * MIN_LIT as f64 / trials.lit.max(1) as f64;
            samples = ((samples as f64 * growth.clamp(2.0, 16.0)) as u64).min(most);
        }
    }

    /// Clouds, each with the error that its halves differ by.
    fn by_halves(&self, mut trials: Trials) -> Result<Found, SampleError> {
        let points = Points::new(self.scene, self.settings, self.plan, POINTS);
        let mut samples = self.first_cloud(&trials)?;
        loop {
            let sampled = self.cloud(samples)?;
            let error = relative_error(&points, &sampled, self.goal).unwrap_or(f64::INFINITY);
            let mut estimate = Estimate { error, freedom: trials.freedom };
            let enough = |estimate: &Estimate| estimate.safe() <= self.goal.error;
            let checked = if error > SURPRISE * trials.foretell(samples) {
                Some(samples)
            } else {
                (enough(&estimate) && samples > STALE * trials.all()).then_some(samples / STALE)
            };
            if let Some(checked) = checked {
                // The cloud is kept meanwhile.
                trials = self.trials(checked.min(self.goal.most - samples).max(TRIALS))?;
                if trials.freedom < MANY {
                    return Ok(Found::Few(trials));
                }
                estimate.freedom = trials.freedom;
            }
            (self.tell)(&Round::Cloud(samples, estimate));
            if enough(&estimate) {
                return Ok(Found::Enough(Box::new(Enough { sampled, estimate: Some(estimate) })));
            }
            samples = self.more(samples, estimate.safe(), CLOUDS_GROW)?;
        }
    }

    /// Samples of the first cloud that is judged by its halves: somewhat fewer than trials say.
    fn first_cloud(&self, trials: &Trials) -> Result<u64, SampleError> {
        let all = trials.all();
        match GAIN * trials.foretell(all) {
            error if error > self.goal.error => self.more(all, error, CLOUDS_GROW),
            _ => Ok(FIRST.min(self.goal.most)),
        }
    }
}

//! Renders with a given number of paths, or with as many paths as a target error needs.

use crate::{
    holes,
    image_jobs::ImageJob,
    judge::{Round, Verdict},
    steps::{Live, Steps},
};
use cli::{Common, Failure, Progress, count};
use gather::{Input, Passes, Rendered, Settings, State, can_share, estimator::Estimator};
use sums::confidence::Estimate;

/// A rendered image, and why it has no more paths.
pub struct Outcome {
    pub rendered: Rendered,
    /// The estimator, with the accuracy of the planned paths.
    pub estimator: Estimator,
    pub end: End,
    /// The sums of the image, if they are kept.
    pub state: Option<State>,
}

/// Why an image has no more paths.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum End {
    /// It has all that were asked for.
    Paths,
    TargetError,
    /// More would not bring it to the target error.
    OutOfReach,
    TimeLimit,
    /// It is not finished: it was asked for while it was rendered.
    Asked,
}

impl End {
    /// The word in the statistics.
    pub fn name(self) -> &'static str {
        match self {
            End::Paths => "paths",
            End::TargetError => "target error",
            End::OutOfReach => "target error out of reach",
            End::TimeLimit => "time limit",
            End::Asked => "not finished",
        }
    }
}

/// An image to render: its inputs, the sums that it goes on from, and what goes on beside.
pub struct Work<'a> {
    pub input: Input<'a>,
    pub job: &'a ImageJob,
    pub common: &'a Common,
    pub before: Option<State>,
    pub live: &'a Live<'a>,
    pub keeps_sums: bool,
}

impl Work<'_> {
    /// Renders the job's paths for each pixel, or until the target error is met.
    pub fn render(&self, target: Option<f64>) -> Result<Outcome, Failure> {
        let (passes, end) = match target {
            None => self.render_all(),
            Some(target) => self.render_to(target),
        }?;
        if end == End::TimeLimit {
            let [done, all] = [passes.paths(), self.job.settings.paths_per_pixel].map(|n| count(u64::from(n)));
            let line = format!("--time-limit: stopped with {done} of {all} paths per pixel");
            self.common.say(self.job.line(&line));
        }
        Ok(outcome(&passes, end, self.keeps_sums))
    }

    fn render_all(&self) -> Result<(Passes<'_>, End), Failure> {
        let (mut passes, all) = (self.begin(&self.job.settings)?, self.job.settings.paths_per_pixel);
        let mut steps = Steps::new(self.live, self.input.clouds.len());
        let progress = Progress::start(self.common, "gathering", passes.paths_until(all), "paths");
        let mut end = End::Paths;
        while passes.paths() < all && end == End::Paths {
            let (done, left) = (passes.paths(), all - passes.paths());
            // The paths of several clouds are added together, or in rounds of which each is whole.
            let rounds = self.input.clouds.len() > 1 && self.live.deadline.is_some();
            let round = if rounds { left.min(done.max(FIRST_PATHS)) } else { left };
            passes.plan(round);
            if !steps.add(&mut passes, round, &progress) {
                end = End::TimeLimit;
            }
        }
        progress.finish();
        Ok((passes, end))
    }

    /// An image that can be rendered, as far as a few of its paths tell, or that is continued.
    fn begin(&self, settings: &Settings) -> Result<Passes<'_>, Failure> {
        let mut passes = Passes::new(&self.input, settings);
        match &self.before {
            Some(before) => passes.resume(before),
            None => holes::probe(&passes, self.job)?,
        }
        Ok(passes)
    }

    /// Adds paths until the error meets the target, or the cloud's own error exceeds it, or the most paths of the job are
    /// reached.
    fn render_to(&self, target: f64) -> Result<(Passes<'_>, End), Failure> {
        let (settings, input) = (&self.job.settings, &self.input);
        let max_paths = settings.paths_per_pixel;
        let first = if can_share(input, settings) { FIRST_SHARED } else { FIRST_PATHS };
        let mut paths = first.max(self.before.as_ref().map_or(0, |before| before.paths)).min(max_paths);
        let mut passes = self.begin(&Settings { paths_per_pixel: paths, ..settings.clone() })?;
        let mut steps = Steps::new(self.live, input.clouds.len());
        let unknown = Estimate { error: f64::INFINITY, freedom: 1.0 };
        let (mut done, mut before) = (0, unknown);
        let end = loop {
            let added = paths - passes.paths();
            let mean = if passes.shares() { " on average" } else { "" };
            let unit = format!("paths, {} to {} of each pixel{mean}", passes.paths() + 1, paths);
            let progress = Progress::start(self.common, "gathering", passes.paths_until(paths), &unit);
            passes.plan(added);
            let in_time = steps.add(&mut passes, added, &progress);
            progress.finish();
            if !in_time {
                break End::TimeLimit;
            }
            let errors = passes.errors();
            passes.share_out();
            let round = Round { target, input, paths, done, before, passes: &passes };
            // Two paths draw silhouettes as stairs, and miss what one path in many sees: noisy pixels have more at least once.
            let is_first = passes.shares() && paths == FIRST_SHARED && paths < max_paths;
            match if is_first { Verdict::More } else { round.judge(errors.as_ref(), settings) } {
                Verdict::Met => break End::TargetError,
                Verdict::OutOfReach(why) => {
                    self.common.warn(why);
                    break End::OutOfReach;
                }
                Verdict::More => {}
            }
            if paths >= max_paths {
                self.common.warn(format_args!(
                    "--target-error is not met with {} paths per pixel; a larger --spp allows more",
                    count(u64::from(max_paths))
                ));
                break End::Paths;
            }
            let next = round.next(errors.as_ref());
            before = errors
                .and_then(|errors| Some(Estimate { error: errors.total, freedom: errors.estimate()?.freedom }))
                .unwrap_or(unknown);
            done = paths;
            paths = next.min(max_paths);
        };
        Ok((passes, end))
    }
}

/// The image of these passes, with its sums if they are kept.
pub fn outcome(passes: &Passes, end: End, keeps_sums: bool) -> Outcome {
    let estimator = passes.settings().estimator;
    Outcome { rendered: passes.image(), estimator, end, state: keeps_sums.then(|| passes.state()) }
}

/// Paths of the first pass: two for each half of the cloud.
const FIRST_PATHS: u32 = 4;

/// The same of images whose pixels share all further paths by their noise: one for each half of the cloud, which is enough
/// inside silhouettes.
const FIRST_SHARED: u32 = 2;

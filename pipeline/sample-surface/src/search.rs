//! Draws as many samples as a medium needs, and reports the progress of the search for their number.

use crate::{inputs::Inputs, settings::Request};
use cli::count;
use sample_surface::{Goal, Round, SampleError, Sampled, Search, SufficientCloud, TRIALS};
use scene::Rays;
use sums::confidence::{Estimate, percent};

/// Draws clouds of more and more samples until one meets the goal.
pub fn search(request: &Request, inputs: &Inputs, rays: &Rays, goal: &Goal) -> Result<Sampled, SampleError> {
    let (common, medium) = (&request.common, &goal.medium.name);
    let tell = |round: &Round| common.say(describe(round, medium));
    let Inputs { scene, settings, plan, .. } = inputs;
    let SufficientCloud { sampled, estimate } = Search { scene, rays, settings, plan, goal, tell: &tell }.run()?;
    match estimate {
        Some(estimate) => common.say(met(&sampled, &estimate, medium)),
        None => common.warn(dark(&sampled, medium)),
    }
    Ok(sampled)
}

/// A standard error and its upper confidence limit.
fn error(estimate: &Estimate) -> String {
    format!("relative error {}, below {} with 95 % confidence", percent(estimate.error), percent(estimate.within()))
}

/// The result of a round of the search, as a message.
fn describe(round: &Round, medium: &str) -> String {
    match round {
        Round::Trials(trials) => {
            let what = format!("{TRIALS} trial clouds of {} samples, {} lit", count(trials.samples), count(trials.lit));
            match &trials.mean {
                Some(mean) => format!("{what}: their mean has {} in {medium}", error(mean)),
                None => format!("{what}: relative error unknown"),
            }
        }
        Round::Cloud(samples, estimate) => format!("{} samples: {} in {medium}", count(*samples), error(estimate)),
    }
}

/// The number of samples that meets the target.
fn met(sampled: &Sampled, estimate: &Estimate, medium: &str) -> String {
    format!("{} samples are enough: {} in {medium}", count(sampled.meta.samples_drawn), error(estimate))
}

/// A cloud from which no light leaves, so that its error is unknown.
fn dark(sampled: &Sampled, medium: &str) -> String {
    let drawn = count(sampled.meta.samples_drawn);
    if sampled.content.samples > 0 {
        return format!(
            "no light leaves the surface in {medium}, so that the relative error of {drawn} samples is unknown"
        );
    }
    // Where a share of 3/n of the surface is lit, none of n samples is lit with a probability of 5 %.
    let share = 300.0 / sampled.meta.samples_drawn as f64;
    format!(
        "none of {drawn} samples carries light, so that their relative error is unknown: with 95 % confidence less than \
         {share:.1e} % of them would find light; are the lights hidden or turned away? --samples draws more"
    )
}

//! What a search for enough samples says of its rounds.

use cli::count;
use sample_surface::{Round, Sampled, TRIALS};
use sums::confidence::{Estimate, percent};

/// A standard error, and the interval that it stands for.
fn error(estimate: &Estimate) -> String {
    format!("relative error {}, below {} with 95 % confidence", percent(estimate.error), percent(estimate.within()))
}

pub fn round(round: &Round, medium: &str) -> String {
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

pub fn enough(sampled: &Sampled, estimate: &Estimate, medium: &str) -> String {
    format!("{} samples are enough: {} in {medium}", count(sampled.meta.samples_drawn), error(estimate))
}

/// Of a cloud that no light leaves: its error is unknown.
pub fn dark(sampled: &Sampled, medium: &str) -> String {
    let drawn = count(sampled.meta.samples_drawn);
    if sampled.content.samples > 0 {
        return format!(
            "no light leaves the surface in {medium}, so that the relative error of {drawn} samples is unknown"
        );
    }
    // The chance to find none of n samples is 5 % if a share of 3/n is lit.
    let share = 300.0 / sampled.meta.samples_drawn as f64;
    format!(
        "none of {drawn} samples carries light, so that their relative error is unknown: with 95 % confidence less than \
         {share:.1e} % of them would find light; are the lights hidden or turned away? --samples draws more"
    )
}

//! The ways to an image that are compared with the truth, and the efforts of each.

use crate::speed::{
    configuration::{CONFIGURATIONS, Configuration, MODEL, STRATIFIED_AREA, Summing},
    effort::Effort,
};
use bssrdf::Model;

/// The effort of one image.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Step {
    /// `K`
    pub samples: u64,
    pub spp: u64,
    /// Random walks of each channel of a calibration.
    pub walks: Option<u64>,
}

/// A way to an image, with efforts that grow.
pub struct Way {
    pub label: &'static str,
    pub configuration: Configuration,
    pub steps: Vec<Step>,
}

/// Label of the calibrated model.
pub const CALIBRATED: &str = "half-space, calibrated";

/// Label of the exact solution.
pub const REFERENCE: &str = "gather --reference";

/// The note, the dipoles with fast sums, the half-space model without and with a calibration, and random walks.
pub fn ways(effort: Effort) -> Vec<Way> {
    let [note, ..] = CONFIGURATIONS;
    let pairs = |list: &[(u64, u64)]| list.iter().map(|(samples, spp)| step(*samples, *spp, None)).collect::<Vec<_>>();
    let noted = effort.of(NOTED[..1].to_vec(), NOTED.to_vec(), NOTED.to_vec());
    let mut ways = vec![Way { label: "note", configuration: note, steps: pairs(&noted) }];
    let summed = effort.of(SUMMED[..2].to_vec(), SUMMED.to_vec(), SUMMED.to_vec());
    for model in [MODEL, Model::BetterDipole, Model::StandardDipole, Model::HalfSpace] {
        ways.push(Way { label: model.name(), configuration: fast(model.name(), model), steps: pairs(&summed) });
    }
    let steps = effort.of(CALIBRATIONS[..1].to_vec(), CALIBRATIONS[..5].to_vec(), CALIBRATIONS.to_vec());
    ways.push(Way { label: CALIBRATED, configuration: fast(CALIBRATED, Model::HalfSpace), steps });
    let paths = effort.of(vec![1], vec![1, 4, 16], vec![1, 4, 16, 64]);
    let configuration = Configuration { summing: Summing::Walks, ..fast(REFERENCE, Model::HalfSpace) };
    // Of the cloud, only the materials count.
    let steps = paths.into_iter().map(|spp| step(1_000, spp, None)).collect();
    ways.push(Way { label: REFERENCE, configuration, steps });
    ways
}

/// Samples and paths of the note's settings, whose cost is their product.
const NOTED: [(u64, u64); 4] = [(3_000, 1), (10_000, 2), (30_000, 4), (100_000, 8)];

/// Samples and paths of the cut: both errors fall together.
const SUMMED: [(u64, u64); 6] =
    [(10_000, 1), (30_000, 2), (100_000, 4), (300_000, 8), (1_000_000, 16), (3_000_000, 32)];

const CALIBRATIONS: [Step; 6] = [
    step(100_000, 2, Some(3_000)),
    step(300_000, 4, Some(10_000)),
    step(1_000_000, 8, Some(30_000)),
    step(2_000_000, 16, Some(100_000)),
    step(3_000_000, 32, Some(300_000)),
    step(4_000_000, 64, Some(1_000_000)),
];

const fn step(samples: u64, spp: u64, walks: Option<u64>) -> Step {
    Step { samples, spp, walks }
}

/// The default sums, over a cloud of the default kind.
const fn fast(name: &'static str, model: Model) -> Configuration {
    Configuration { name, cloud: STRATIFIED_AREA, summing: Summing::Cut(None), model }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn efforts_grow_and_only_ours_is_calibrated() {
        for effort in [Effort::Tiny, Effort::Quick, Effort::Full] {
            for way in ways(effort) {
                assert!(way.steps.iter().all(|s| s.walks.is_some() == (way.label == CALIBRATED)), "{}", way.label);
                let grow = way.steps.windows(2).all(|w| w[0].samples <= w[1].samples && w[0].spp < w[1].spp);
                assert!(grow, "{}", way.label);
            }
        }
    }
}

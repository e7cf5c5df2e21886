//! The estimators of the sum over the samples of a cloud. Each returns the sum before the division by K, which
//! [`crate::Summation`] makes.

mod cut;
mod cut_correction;
mod exhaustive;
mod falloff_tables;
mod random_bits;
mod roulette;
mod scatterer;
mod sum;

pub use cut::Scratch;
pub use cut_correction::CutCorrection;
pub use random_bits::random_bits;
pub use roulette::{Rates, Roulette, Rule};
pub use scatterer::Scatterer;
pub use sum::Sum;

use crate::samples::{Exit, LitSamples};
use bssrdf::{LaneWork, lanes::LaneModel, simd};
use cut::Cut;
use exhaustive::Exhaustive;
use std::fmt;

/// How the sum is estimated.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Estimator {
    /// Hierarchical: near samples are evaluated one by one, far ones by a few that represent many.
    Cut {
        /// Target of the relative standard error of a pixel's sums; callers that make one of many sums set that of the
        /// sum.
        accuracy: f64,
    },
    /// The note's: a sample is evaluated with a probability that falls with its distance.
    Roulette(Rule),
    /// Every sample is evaluated.
    Exhaustive,
}

impl Estimator {
    /// All estimators with their default parameters, the default estimator first.
    pub const ALL: [Estimator; 3] =
        [Estimator::Cut { accuracy: 0.01 }, Estimator::Roulette(Rule::Mixture), Estimator::Exhaustive];

    /// The word that users type.
    pub fn name(self) -> &'static str {
        match self {
            Estimator::Cut { .. } => "cut",
            Estimator::Roulette(_) => "roulette",
            Estimator::Exhaustive => "exhaustive",
        }
    }

    /// The accuracy that was asked for, if the estimator has one.
    pub fn accuracy(self) -> Option<f64> {
        match self {
            Estimator::Cut { accuracy } => Some(accuracy),
            _ => None,
        }
    }

    /// The same estimator with another accuracy, if it has one.
    pub fn map_accuracy(self, map: impl FnOnce(f64) -> f64) -> Estimator {
        match self {
            Estimator::Cut { accuracy } => Estimator::Cut { accuracy: map(accuracy) },
            other => other,
        }
    }

    /// Whether a sum over many samples costs hardly more than one over few. If so, each point gathers from one whole
    /// shard instead of from all: cuts through the trees of four shards evaluate twice as many samples as one cut
    /// through the tree of a cloud of the same total size.
    pub fn is_hierarchical(self) -> bool {
        matches!(self, Estimator::Cut { .. })
    }

    /// Estimates the sum over `samples` at `exit`.
    pub fn sum(
        self,
        scatterer: &Scatterer,
        correction: &CutCorrection,
        samples: &LitSamples,
        exit: &Exit,
        scratch: &mut Scratch,
    ) -> Sum {
        if samples.is_empty() {
            return Sum::default();
        }
        scatterer.lanes.run(Estimation { estimator: self, scatterer, correction, samples, exit, scratch })
    }
}

/// The estimator with the parameter that users chose, as image files state it.
impl fmt::Display for Estimator {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str(self.name())?;
        match self {
            Estimator::Cut { accuracy } => write!(f, " {accuracy}"),
            Estimator::Roulette(rule) => write!(f, " {}", rule.name()),
            Estimator::Exhaustive => Ok(()),
        }
    }
}

/// The arguments of one sum, before the type of its model is known.
struct Estimation<'a> {
    estimator: Estimator,
    scatterer: &'a Scatterer,
    correction: &'a CutCorrection,
    samples: &'a LitSamples<'a>,
    exit: &'a Exit,
    scratch: &'a mut Scratch,
}

impl LaneWork for Estimation<'_> {
    type Output = Sum;

    fn run<M: LaneModel>(self, model: &M) -> Sum {
        let Estimation { estimator, scatterer, correction, samples, exit, scratch } = self;
        let level = scatterer.level;
        match estimator {
            Estimator::Cut { accuracy } => {
                let (tables, accuracy) = (scatterer.tables(), accuracy as f32);
                simd::run_as(level, Cut { model, samples, tables, exit, accuracy, correction, scratch })
            }
            Estimator::Roulette(rule) => {
                simd::run_as(level, Roulette { model, samples, exit, rates: rule.rates(scatterer.transport) })
            }
            Estimator::Exhaustive => simd::run_as(level, Exhaustive { model, samples, exit }),
        }
    }
}

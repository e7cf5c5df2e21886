//! note: [estimator] The sum over the samples of the cloud, method.md (6.7):
//! `L_r = (1/K) Σ_k S_gather(x_k, ω_k; x_o, ω_o) Φ_k`, with K the number of samples *drawn*.
//!
//! Each estimator returns the sum before the division by K.

mod calibration;
mod cut;
mod exhaustive;
mod falloff_tables;
mod roulette;

pub use calibration::Calibration;
pub use cut::{Cut, Scratch};
pub use exhaustive::Exhaustive;
pub use falloff_tables::FalloffTables;
pub use roulette::{Rates, Roulette, Rule, random_bits};

use bssrdf::lanes::{LANES, Lane};
use glam::DVec3;

/// How the sum is estimated.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Estimator {
    /// Hierarchical: near samples one by one, far ones by a few that stand for many.
    Cut {
        /// Target of the relative standard error of a pixel's sums.
        accuracy: f64,
    },
    /// Every sample is evaluated.
    Exhaustive,
    /// The note's: a sample is evaluated with a probability that falls with its distance.
    Roulette(Rule),
}

/// A sum over samples.
#[derive(Clone, Copy, Debug, Default)]
pub struct Sum {
    /// `Σ_k S_gather Φ_k`, W/(m² sr).
    pub radiance: DVec3,
    /// Samples whose BSSRDF was evaluated.
    pub evaluations: u64,
    /// Nodes of the tree that were looked at.
    pub nodes: u64,
    /// A rough estimate of the radiance, summed over channels, that does not depend on what the cut picks; 0 of others.
    pub predicted: f64,
}

impl Sum {
    /// Both sums together.
    pub fn plus(self, other: Sum) -> Sum {
        Sum {
            radiance: self.radiance + other.radiance,
            evaluations: self.evaluations + other.evaluations,
            nodes: self.nodes + other.nodes,
            predicted: self.predicted + other.predicted,
        }
    }
}

/// Running sums of sixteen lanes, in float64 and in a fixed order.
struct Accumulator([[f64; LANES]; 3]);

impl Accumulator {
    #[inline(always)]
    fn new() -> Self {
        Accumulator([[0.0; LANES]; 3])
    }

    /// Adds `values · flux · weight`.
    #[inline(always)]
    fn add(&mut self, values: &[Lane; 3], flux: &[Lane; 3], weight: &Lane) {
        for c in 0..3 {
            for i in 0..LANES {
                self.0[c][i] += f64::from(values[c][i]) * f64::from(flux[c][i]) * f64::from(weight[i]);
            }
        }
    }

    #[inline(always)]
    fn total(&self) -> DVec3 {
        DVec3::from_array([0, 1, 2].map(|c| self.0[c].iter().sum()))
    }
}

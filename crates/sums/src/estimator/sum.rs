//! The result of an estimator, and the accumulator that makes it.

use bssrdf::lanes::{LANES, Lane};
use glam::DVec3;

/// A sum over samples, before the division by K.
#[derive(Clone, Copy, Debug, Default)]
pub struct Sum {
    /// `Σ_k S_gather Φ_k`, W/(m² sr).
    pub radiance: DVec3,
    /// How many times the BSSRDF was evaluated.
    pub evaluations: u64,
    /// How many nodes of the tree were visited.
    pub nodes: u64,
    /// An estimate of the radiance, summed over the channels, that does not depend on which samples the cut picks; 0
    /// for the other estimators.
    pub predicted: f64,
}

impl Sum {
    /// The sum over the samples of both.
    pub fn plus(self, other: Sum) -> Sum {
        Sum {
            radiance: self.radiance + other.radiance,
            evaluations: self.evaluations + other.evaluations,
            nodes: self.nodes + other.nodes,
            predicted: self.predicted + other.predicted,
        }
    }
}

/// Sixteen running sums for each channel, in float64 and in a fixed order.
pub(super) struct Accumulator([[f64; LANES]; 3]);

impl Accumulator {
    #[inline(always)]
    pub fn new() -> Self {
        Accumulator([[0.0; LANES]; 3])
    }

    /// Adds `values · flux · weight`.
    #[inline(always)]
    pub fn add(&mut self, values: &[Lane; 3], flux: &[Lane; 3], weight: &Lane) {
        for c in 0..3 {
            for i in 0..LANES {
                self.0[c][i] += f64::from(values[c][i]) * f64::from(flux[c][i]) * f64::from(weight[i]);
            }
        }
    }

    #[inline(always)]
    pub fn total(&self) -> DVec3 {
        DVec3::from_array([0, 1, 2].map(|c| self.0[c].iter().sum()))
    }
}

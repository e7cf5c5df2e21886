//! The whole sum: the reference of the other estimators.

use super::sum::{Accumulator, Sum};
use crate::samples::{Exit, LitSamples};
use bssrdf::{
    lanes::{LANES, LaneModel},
    simd::Kernel,
};

/// Evaluates every sample.
pub struct Exhaustive<'a, M> {
    pub model: &'a M,
    pub samples: &'a LitSamples<'a>,
    pub exit: &'a Exit,
}

impl<M: LaneModel> Kernel for Exhaustive<'_, M> {
    type Output = Sum;

    #[inline(always)]
    fn run(self) -> Sum {
        let mut sum = Accumulator::new();
        for index in 0..self.samples.tiles.len() {
            let (block, flux) = self.samples.block(index, self.exit);
            sum.add(&self.model.bare(&block, self.exit.normal), &flux, &[1.0; LANES]);
        }
        Sum { radiance: sum.total(), evaluations: self.samples.len() as u64, nodes: 0, predicted: 0.0 }
    }
}

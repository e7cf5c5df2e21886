//! `note: [estimator]` The radiance that leaves a translucent surface scattered, docs/method.md (6.7):
//! `L_r = (1/K) Σ_k S_gather(x_k, ω_k; x_o, ω_o) Φ_k`, where K counts all samples that were *drawn*, the unlit ones
//! included.

use crate::{
    drawn::{DrawnCounts, ShardPick},
    estimator::{CutCorrection, Estimator, Scatterer, Scratch, Sum},
    samples::{Exit, LitSamples},
};
use bssrdf::RoughEntry;
use formats::cloud::Cloud;
use glam::DVec3;
use std::sync::Arc;

/// The samples of one translucent material in all shards of a cloud, ready to be summed at any exitant point.
pub struct Summation<'a> {
    scatterer: Arc<Scatterer>,
    /// Corrects the cut's prediction of its own error; it starts as 1.
    pub correction: CutCorrection,
    /// The two independent halves of each shard.
    shards: Vec<[LitSamples<'a>; 2]>,
    drawn: DrawnCounts,
}

/// `L_r` at an exitant point, and its cost.
#[derive(Clone, Copy, Debug, Default)]
pub struct Leaving {
    /// W/(m² sr).
    pub radiance: DVec3,
    /// The independent estimates of the two halves of the cloud, W/(m² sr).
    pub halves: [DVec3; 2],
    /// How many times the BSSRDF was evaluated.
    pub evaluations: u64,
    /// How many nodes of the tree were visited.
    pub nodes: u64,
}

impl<'a> Summation<'a> {
    /// Takes the two halves of each shard; `drawn` counts the samples of all materials.
    pub fn new(scatterer: Arc<Scatterer>, shards: Vec<[LitSamples<'a>; 2]>, drawn: DrawnCounts) -> Summation<'a> {
        Summation { scatterer, correction: CutCorrection::default(), shards, drawn }
    }

    /// The samples of the sampled material `slot` in shards of one cloud.
    pub fn of_clouds(scatterer: Arc<Scatterer>, clouds: &'a [Cloud], slot: usize) -> Summation<'a> {
        let eta = scatterer.eta();
        let halves = |cloud: &'a Cloud| cloud.meta().materials[slot].halves.map(|h| LitSamples::new(cloud, &h, eta));
        Summation::new(scatterer, clouds.iter().map(halves).collect(), DrawnCounts::of(clouds))
    }

    /// The same sum behind an interface that may be rough.
    pub fn behind(mut self, rough: Option<&RoughEntry>) -> Summation<'a> {
        self.shards = self.shards.into_iter().map(|halves| halves.map(|half| half.behind(rough))).collect();
        self
    }

    /// True if no sample carries light.
    pub fn is_empty(&self) -> bool {
        self.shards.iter().flatten().all(LitSamples::is_empty)
    }

    /// The number of shards.
    pub fn shards(&self) -> usize {
        self.shards.len()
    }

    /// The sum over one half of one shard, before the division by K.
    pub fn sum(&self, estimator: Estimator, half: usize, shard: usize, exit: &Exit, scratch: &mut Scratch) -> Sum {
        estimator.sum(&self.scatterer, &self.correction, &self.shards[shard][half], exit, scratch)
    }

    /// The sum over one half of all shards, each with random numbers of its own.
    fn sum_of_half(&self, estimator: Estimator, half: usize, exit: &Exit, scratch: &mut Scratch) -> Sum {
        let of_shard = |shard| self.sum(estimator, half, shard, &exit.of_shard(shard), scratch);
        (0..self.shards.len()).map(of_shard).fold(Sum::default(), Sum::plus)
    }

    /// `L_r` as one half of the cloud estimates it, W/(m² sr).
    pub fn half(&self, estimator: Estimator, half: usize, exit: &Exit, scratch: &mut Scratch) -> DVec3 {
        mean(self.sum_of_half(estimator, half, exit, scratch).radiance, self.drawn.half(half))
    }

    /// `L_r` from all samples. `exit` gives the exitant point with the random numbers of a half.
    pub fn whole(&self, estimator: Estimator, exit: impl Fn(usize) -> Exit, scratch: &mut Scratch) -> Leaving {
        let sums = [0, 1].map(|half| self.sum_of_half(estimator, half, &exit(half), scratch));
        let drawn = [0, 1].map(|half| self.drawn.half(half));
        let both = sums[0].plus(sums[1]);
        let radiance = mean(both.radiance, drawn[0] + drawn[1]);
        // The second half is empty if only one sample was drawn.
        let halves = [0, 1].map(|k| if drawn[1] == 0 { radiance } else { mean(sums[k].radiance, drawn[k]) });
        Leaving { radiance, halves, evaluations: both.evaluations, nodes: both.nodes }
    }

    /// `L_r` from one half of the shard that was picked.
    pub fn by_shard(
        &self,
        estimator: Estimator,
        half: usize,
        ShardPick { shard, weight }: ShardPick,
        exit: impl Fn(usize) -> Exit,
        scratch: &mut Scratch,
    ) -> Leaving {
        let half = if self.drawn.half(1) == 0 { 0 } else { half };
        let sum = self.sum(estimator, half, shard, &exit(half), scratch);
        let radiance = mean(weight * sum.radiance, self.drawn.shard(half, shard));
        Leaving { radiance, halves: [radiance; 2], evaluations: sum.evaluations, nodes: sum.nodes }
    }
}

/// `1/K` times the sum over K drawn samples.
fn mean(sum: DVec3, drawn: u64) -> DVec3 {
    sum / drawn.max(1) as f64
}

//! How many samples were drawn for each half of each shard, and which shard a camera path gathers from.

use formats::cloud::Cloud;

/// Numbers of samples drawn, the unlit ones included: the K of `1/K`.
#[derive(Clone, Debug)]
pub struct DrawnCounts {
    /// The two halves of each shard.
    shards: Vec<[u64; 2]>,
    /// The two halves of all shards together.
    halves: [u64; 2],
}

impl DrawnCounts {
    /// Takes the numbers of samples drawn for the two halves of each shard.
    pub fn new(shards: Vec<[u64; 2]>) -> DrawnCounts {
        DrawnCounts { halves: [0, 1].map(|half| shards.iter().map(|drawn| drawn[half]).sum()), shards }
    }

    pub fn of(clouds: &[Cloud]) -> DrawnCounts {
        DrawnCounts::new(clouds.iter().map(|cloud| cloud.meta().drawn_by_half()).collect())
    }

    /// The number of shards.
    pub fn shards(&self) -> usize {
        self.shards.len()
    }

    /// Samples drawn for one half of all shards.
    pub fn half(&self, half: usize) -> u64 {
        self.halves[half]
    }

    /// Samples drawn for one half of one shard.
    pub fn shard(&self, half: usize, shard: usize) -> u64 {
        self.shards[shard][half]
    }

    /// The shard that path `index` gathers from, of the `paths` of a pixel that are added together and gather from this
    /// half. Shards are picked round-robin, each in proportion to its samples, from a random `start` in [0, 1).
    pub fn pick_shard(&self, half: usize, index: u32, paths: u32, start: impl Fn() -> f64) -> ShardPick {
        if self.shards.len() == 1 {
            return ShardPick { shard: 0, weight: 1.0 };
        }
        let start = start();
        // The samples of all shards are numbered consecutively; the path gathers from the shard that holds this number.
        let sample = |index: u32| ((start + f64::from(index)) / f64::from(paths) * self.halves[half] as f64) as u64;
        // The number after the last sample of each shard. A shard without a sample in this half is never picked.
        let ends = self.shards.iter().scan(0, |end, drawn| {
            *end += drawn[half];
            Some(*end)
        });
        let own = sample(index).min(self.halves[half].saturating_sub(1));
        let Some((shard, end)) = ends.enumerate().find(|(_, end)| own < *end) else {
            return ShardPick { shard: 0, weight: 1.0 };
        };
        let drawn = self.shards[shard][half];
        // A shard that some path is certain to pick is weighted by its samples over the number of its paths. Any other
        // is picked with a probability in proportion to its samples, which makes its mean right without a weight.
        let certain = u128::from(drawn) * u128::from(paths) >= u128::from(self.halves[half]);
        let picks = first_at(&sample, paths, end) - first_at(&sample, paths, end - drawn);
        let share = drawn as f64 / self.halves[half] as f64;
        ShardPick { shard, weight: if certain { share * f64::from(paths) / f64::from(picks.max(1)) } else { 1.0 } }
    }
}

/// The shard that one camera path gathers from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ShardPick {
    pub shard: usize,
    /// The factor of the light that the path gathers there.
    pub weight: f64,
}

/// The first of `paths` indices whose sample is number `limit` or a later one; `sample` never decreases.
fn first_at(sample: &impl Fn(u32) -> u64, paths: u32, limit: u64) -> u32 {
    let (mut low, mut high) = (0, paths);
    while low < high {
        let middle = low + (high - low) / 2;
        if sample(middle) < limit { low = middle + 1 } else { high = middle }
    }
    low
}

#[cfg(test)]
mod tests {
    use super::*;

    fn drawn(shards: &[u64]) -> DrawnCounts {
        DrawnCounts::new(shards.iter().map(|n| [*n; 2]).collect())
    }

    /// Computed by hand: two shards with 2 and 3 of 5 samples. With five paths all weights are 1; with fewer, the
    /// weights of a shard that is certain to be picked add up to its share.
    ///
    /// Seen to catch: no weights; weights for shards that are not certain to be picked.
    #[test]
    fn a_shard_that_is_certain_to_be_picked_counts_for_its_samples() {
        let drawn = drawn(&[2, 3]);
        let picks = |paths: u32, start: f64| {
            (0..paths).map(|index| drawn.pick_shard(1, index, paths, || start)).collect::<Vec<_>>()
        };
        for start in [0.0, 0.3, 0.999] {
            // It can happen that neither of two paths picks the first shard.
            let two = picks(2, start);
            let weight = |pick: &ShardPick| if pick.shard == 0 { 1.0 } else { 1.2 / count(&two, 1) };
            assert!(two.iter().all(|pick| (pick.weight - weight(pick)).abs() < 1e-15), "{two:?}");
            let five = picks(5, start);
            assert_eq!([count(&five, 0), count(&five, 1)], [2.0, 3.0], "{start}");
            assert!(five.iter().all(|pick| (pick.weight - 1.0).abs() < 1e-15));
            // Three paths cannot be divided as 2 : 3, so the weights make up for it.
            let three = picks(3, start);
            for (shard, samples) in [(0, 2.0), (1, 3.0)] {
                let sum: f64 = three.iter().filter(|pick| pick.shard == shard).map(|pick| pick.weight).sum();
                assert!((sum - 3.0 * samples / 5.0).abs() < 1e-15, "{start}: {three:?}");
            }
        }
    }

    fn count(picks: &[ShardPick], shard: usize) -> f64 {
        picks.iter().filter(|pick| pick.shard == shard).count() as f64
    }

    /// The mean weight of each shard over random starts is its share of the samples, for few paths and for many.
    #[test]
    fn the_mean_weight_of_a_shard_is_its_share_of_the_samples() {
        let (drawn, sizes) = (drawn(&[7, 0, 1, 30, 12]), [7.0, 0.0, 1.0, 30.0, 12.0]);
        for paths in [1, 2, 3, 8, 100] {
            let mut means = [0.0; 5];
            for k in 0..5000 {
                let start = || f64::from(k / paths) * 0.618_033_988_749_895 % 1.0;
                let pick = drawn.pick_shard(0, k % paths, paths, start);
                means[pick.shard] += pick.weight / 5000.0;
            }
            for (mean, size) in means.into_iter().zip(sizes) {
                assert!((mean - size / 50.0).abs() < 0.02, "{paths} paths: {means:?}");
            }
        }
    }
}

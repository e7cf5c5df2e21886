//! Several clouds of one scene gathered as one: the parts of a cloud too big for one sampler.
//!
//! `(1/n) Σ S Φ` over the `n` samples drawn for a cloud has the same mean for all of them. The whole sum and the roulette
//! take the sum over all clouds over the number drawn for all, which weighs each mean by what it is worth. Of the cut's
//! paths each gathers from one cloud, by turns, as often as that has samples: to cut through the trees of four clouds at
//! each takes twice the samples of one cloud as large, since none of the trees can be cut more coarsely than it alone.
//! The first halves of all clouds are one half, and so are the second ones: the two stay independent.

use formats::cloud::{Cloud, Meta, SampledMaterial, hex};
use std::path::PathBuf;

/// Why clouds cannot be gathered together.
#[derive(Debug, thiserror::Error)]
pub enum JoinError {
    #[error("{} and {}: clouds of different scenes: {differs}; sample them again, alike but for --shard", one.display(), two.display())]
    Differ { one: PathBuf, two: PathBuf, differs: &'static str },
    #[error(
        "{} and {}: both are shard {shard} of seed {seed}, samples of the same random numbers; leave one out, or sample it \
         again with another --shard or --seed",
        one.display(), two.display()
    )]
    Same { one: PathBuf, two: PathBuf, shard: String, seed: u64 },
}

/// Clouds that were opened, in an order that does not depend on that of the files; refuses those that do not belong
/// together.
pub fn join(mut files: Vec<(PathBuf, Cloud)>) -> Result<(Vec<PathBuf>, Vec<Cloud>), JoinError> {
    files.sort_by_key(|(_, cloud)| key(cloud.meta()));
    for pair in files.windows(2) {
        let (one, two) = (pair[0].0.clone(), pair[1].0.clone());
        let metas = [pair[0].1.meta(), pair[1].1.meta()];
        if let Some(differs) = difference(metas[0], metas[1]) {
            return Err(JoinError::Differ { one, two, differs });
        }
        if key(metas[0]) == key(metas[1]) {
            let options = &metas[0].options;
            return Err(JoinError::Same { one, two, shard: options.shard.to_string(), seed: options.seed });
        }
    }
    Ok(files.into_iter().unzip())
}

/// What tells the random numbers of one cloud from those of another.
fn key(meta: &Meta) -> (u64, u32, u32) {
    (meta.options.seed, meta.options.shard.count, meta.options.shard.index)
}

/// What keeps samples from having one mean. How they are spread, and over which triangles, does not.
fn difference(one: &Meta, two: &Meta) -> Option<&'static str> {
    let names = |meta: &Meta| meta.materials.iter().map(|m| (m.index, m.name.clone())).collect::<Vec<_>>();
    let (a, b) = (&one.options, &two.options);
    let differences = [
        (a.metres_per_unit != b.metres_per_unit, "--metres-per-unit"),
        (a.light_unit != b.light_unit, "--light-unit"),
        (a.emission_unit != b.emission_unit, "--emission-unit"),
        (one.geometry != two.geometry, "their meshes or materials differ"),
        (names(one) != names(two), "their translucent materials differ"),
        (one.lights != two.lights, "their lights differ"),
        (a.environment != b.environment, "--environment"),
        (a.normals != b.normals, "--normals"),
    ];
    differences.into_iter().find(|(differ, _)| *differ).map(|(_, what)| what)
}

/// `K`: samples drawn for all clouds, the unlit ones included.
pub fn drawn(clouds: &[Cloud]) -> u64 {
    clouds.iter().map(|cloud| cloud.meta().samples_drawn).sum()
}

/// The sampled materials, which all clouds share; where their samples lie is known of the first cloud.
pub fn materials(clouds: &[Cloud]) -> &[SampledMaterial] {
    clouds.first().map_or(&[], |cloud| &cloud.meta().materials)
}

/// Stored samples of a sampled material in all clouds.
pub fn count(clouds: &[Cloud], slot: usize) -> u64 {
    clouds.iter().map(|cloud| cloud.meta().materials[slot].count()).sum()
}

/// Samples drawn for each half of each cloud, and which cloud a path gathers from.
pub struct DrawnCounts {
    parts: Vec<[u64; 2]>,
    sums: [u64; 2],
}

impl DrawnCounts {
    pub fn of(clouds: &[Cloud]) -> DrawnCounts {
        let parts: Vec<[u64; 2]> = clouds.iter().map(|cloud| cloud.meta().drawn_by_half()).collect();
        DrawnCounts { sums: [0, 1].map(|half| parts.iter().map(|n| n[half]).sum()), parts }
    }

    /// How many clouds there are.
    pub fn clouds(&self) -> usize {
        self.parts.len()
    }

    /// Samples of a half of all clouds.
    pub fn half(&self, half: usize) -> u64 {
        self.sums[half]
    }

    /// Samples of a half of one cloud.
    pub fn part(&self, half: usize, part: usize) -> u64 {
        self.parts[part][half]
    }

    /// The cloud whose turn it is for path `index` of the `paths` of a pixel that are added at once and gather from one
    /// half: each as often as it has samples, evenly, from a random start in [0, 1).
    pub fn turn(&self, half: usize, index: u32, paths: u32, start: impl Fn() -> f64) -> ShardPick {
        if self.parts.len() == 1 {
            return ShardPick { part: 0, weight: 1.0 };
        }
        let start = start();
        let place = |index: u32| ((start + f64::from(index)) / f64::from(paths) * self.sums[half] as f64) as u64;
        // Where the samples of each cloud end. A cloud without a sample in this half has no turn.
        let ends = self.parts.iter().scan(0, |end, drawn| {
            *end += drawn[half];
            Some(*end)
        });
        let here = place(index).min(self.sums[half].saturating_sub(1));
        let Some((part, end)) = ends.enumerate().find(|(_, end)| here < *end) else {
            return ShardPick { part: 0, weight: 1.0 };
        };
        let drawn = self.parts[part][half];
        // Sure of a turn, it counts for its samples however often it has one; else on average.
        let sure = u128::from(drawn) * u128::from(paths) >= u128::from(self.sums[half]);
        let turns = first_beyond(&place, paths, end) - first_beyond(&place, paths, end - drawn);
        let share = drawn as f64 / self.sums[half] as f64;
        ShardPick { part, weight: if sure { share * f64::from(paths) / f64::from(turns.max(1)) } else { 1.0 } }
    }
}

/// A path's cloud.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ShardPick {
    pub part: usize,
    /// What the light that it gathers there is multiplied by.
    pub weight: f64,
}

/// The first of `paths` indices whose place, which grows with it, is `limit` or beyond.
fn first_beyond(place: &impl Fn(u32) -> u64, paths: u32, limit: u64) -> u32 {
    let (mut low, mut high) = (0, paths);
    while low < high {
        let middle = low + (high - low) / 2;
        if place(middle) < limit { low = middle + 1 } else { high = middle }
    }
    low
}

/// Identity of everything that the samples depend on: the cloud's own, or the BLAKE3 digest of those of all in order.
pub fn identity(clouds: &[Cloud]) -> [u8; 32] {
    match clouds {
        [cloud] => cloud.meta().content,
        _ => {
            let mut hasher = blake3::Hasher::new();
            clouds.iter().for_each(|cloud| {
                hasher.update(&cloud.meta().content);
            });
            *hasher.finalize().as_bytes()
        }
    }
}

/// One line for each cloud: identity, shard, seed, samples drawn.
pub fn describe(clouds: &[Cloud]) -> Vec<String> {
    let line = |cloud: &Cloud| {
        let meta = cloud.meta();
        let options = &meta.options;
        format!("{} shard {} seed {} samples {}", hex(&meta.content), options.shard, options.seed, meta.samples_drawn)
    };
    clouds.iter().map(line).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn drawn(halves: &[u64]) -> DrawnCounts {
        DrawnCounts { parts: halves.iter().map(|n| [*n; 2]).collect(), sums: [halves.iter().sum(); 2] }
    }

    /// On paper: 2 and 3 of 5 samples. Of five paths all weights are 1; of fewer, those of a cloud that is sure of a turn
    /// add up to its share.
    ///
    /// Seen to catch: no weights; weights for clouds that are not sure of a turn.
    #[test]
    fn a_cloud_that_is_sure_of_a_turn_counts_for_its_samples() {
        let drawn = drawn(&[2, 3]);
        let of = |paths: u32, start: f64| (0..paths).map(|i| drawn.turn(1, i, paths, || start)).collect::<Vec<_>>();
        for start in [0.0, 0.3, 0.999] {
            // Of two paths the first cloud may have none.
            let two = of(2, start);
            let weight = |turn: &ShardPick| if turn.part == 0 { 1.0 } else { 1.2 / turns(&two, 1) };
            assert!(two.iter().all(|turn| (turn.weight - weight(turn)).abs() < 1e-15), "{two:?}");
            let five = of(5, start);
            assert_eq!([turns(&five, 0), turns(&five, 1)], [2.0, 3.0], "{start}");
            assert!(five.iter().all(|turn| (turn.weight - 1.0).abs() < 1e-15));
            // Three paths: weights make up for what the turns are not.
            let three = of(3, start);
            for (part, samples) in [(0, 2.0), (1, 3.0)] {
                let sum: f64 = three.iter().filter(|turn| turn.part == part).map(|turn| turn.weight).sum();
                assert!((sum - 3.0 * samples / 5.0).abs() < 1e-15, "{start}: {three:?}");
            }
        }
    }

    fn turns(of: &[ShardPick], part: usize) -> f64 {
        of.iter().filter(|turn| turn.part == part).count() as f64
    }

    /// The mean weight of each cloud over random starts is its share of the samples, for few paths and many.
    #[test]
    fn every_path_gathers_from_each_cloud_as_it_has_samples() {
        let (drawn, sizes) = (drawn(&[7, 0, 1, 30, 12]), [7.0, 0.0, 1.0, 30.0, 12.0]);
        for paths in [1, 2, 3, 8, 100] {
            let mut means = [0.0; 5];
            for k in 0..5000 {
                let turn = drawn.turn(0, k % paths, paths, || f64::from(k / paths) * 0.618_033_988_749_895 % 1.0);
                means[turn.part] += turn.weight / 5000.0;
            }
            for (mean, size) in means.into_iter().zip(sizes) {
                assert!((mean - size / 50.0).abs() < 0.02, "{paths} paths: {means:?}");
            }
        }
    }
}

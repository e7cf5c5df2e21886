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
pub struct Drawn {
    parts: Vec<[u64; 2]>,
    sums: [u64; 2],
}

impl Drawn {
    pub fn of(clouds: &[Cloud]) -> Drawn {
        let parts: Vec<[u64; 2]> = clouds.iter().map(|cloud| cloud.meta().drawn_by_half()).collect();
        Drawn { sums: [0, 1].map(|half| parts.iter().map(|n| n[half]).sum()), parts }
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

    /// The cloud whose turn it is for path `index` of those of a pixel that gather from one half: each as often as it has
    /// samples, and evenly, from a random start in [0, 1).
    pub fn turn(&self, half: usize, index: u32, start: impl Fn() -> f64) -> usize {
        if self.parts.len() == 1 {
            return 0;
        }
        let place = start() + f64::from(index.reverse_bits()) * (1.0 / 4_294_967_296.0);
        // In exact numbers: a cloud without a sample in this half has no turn.
        let mut left = (place.fract() * self.sums[half] as f64) as u64;
        let holds = |n: &[u64; 2]| {
            let here = left < n[half];
            left = left.saturating_sub(n[half]);
            here
        };
        self.parts.iter().position(holds).unwrap_or(0)
    }
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

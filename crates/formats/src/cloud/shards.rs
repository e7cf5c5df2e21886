//! Several clouds of one scene, gathered as one: shards, each sampled by a process of its own.
//!
//! `(1/K) Σ S Φ` over the `K` samples drawn for a shard has the same mean for all shards. The whole sum and the
//! roulette add the sums of all shards and divide by the number of samples drawn for all of them, which weights each
//! shard by its samples. With `--estimator cut`, each path uses one shard, round-robin, in proportion to its samples.
//! The first halves of all shards together are one half, and so are the second halves; the two stay independent.

use super::{Cloud, Meta, SampledMaterial, hex};
use std::path::PathBuf;

/// Why clouds cannot be gathered together.
#[derive(Debug, thiserror::Error)]
pub enum JoinError {
    #[error("{} and {}: they do not belong together: {differs} differ; sample them again, as shards of one cloud", one.display(), two.display())]
    Differ { one: PathBuf, two: PathBuf, differs: &'static str },
    #[error(
        "{} and {}: both are shard {shard} of seed {seed}, samples of the same random numbers; leave one out, or sample it \
         again as another shard or with another seed",
        one.display(), two.display()
    )]
    Same { one: PathBuf, two: PathBuf, shard: String, seed: u64 },
}

/// Sorts open clouds into an order that does not depend on that of the files; refuses those that do not belong
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

/// The key of a cloud's random numbers.
fn key(meta: &Meta) -> (u64, u32, u32) {
    (meta.options.seed, meta.options.shard.count, meta.options.shard.index)
}

/// The first difference that gives the samples of two clouds different means. The pattern of the samples and the choice
/// of triangles may differ: they do not change the mean.
fn difference(one: &Meta, two: &Meta) -> Option<&'static str> {
    let names = |meta: &Meta| meta.materials.iter().map(|m| (m.index, m.name.clone())).collect::<Vec<_>>();
    let (a, b) = (&one.options, &two.options);
    let differences = [
        (a.metres_per_unit != b.metres_per_unit, "their metres per unit"),
        (a.light_unit != b.light_unit, "their units of lights"),
        (a.emission_unit != b.emission_unit, "their units of emission"),
        (a.pose != b.pose, "their poses"),
        (one.geometry != two.geometry, "their meshes or materials"),
        (names(one) != names(two), "their translucent materials"),
        (one.lights != two.lights, "their lights"),
        (a.environment != b.environment, "their environments"),
        (a.normals != b.normals, "their normals"),
    ];
    differences.into_iter().find(|(differ, _)| *differ).map(|(_, what)| what)
}

/// `K`: the number of samples drawn for all clouds, the unlit ones included.
pub fn drawn(clouds: &[Cloud]) -> u64 {
    clouds.iter().map(|cloud| cloud.meta().samples_drawn).sum()
}

/// The sampled materials, which all clouds share; the groups of samples are those of the first cloud.
pub fn materials(clouds: &[Cloud]) -> &[SampledMaterial] {
    clouds.first().map_or(&[], |cloud| &cloud.meta().materials)
}

/// The number of stored samples of a sampled material in all clouds.
pub fn count(clouds: &[Cloud], slot: usize) -> u64 {
    clouds.iter().map(|cloud| cloud.meta().materials[slot].count()).sum()
}

/// Identity of everything that the samples depend on: that of the cloud, or the BLAKE3 digest of those of all clouds in
/// order.
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

//! The facts of a cloud, beside its samples.

use super::{
    bounded::{counts, list, shares, text},
    record::{TILE, node_count},
    settings::{Choice, LightUnit, Normals, Pattern},
};
use serde::{Deserialize, Serialize};
use std::{collections::BTreeMap, fmt};

/// The facts with the number of their version, which is checked before they are read.
#[derive(Debug, Serialize, Deserialize)]
pub(super) enum Versioned {
    V7(Meta),
}

/// The facts of a cloud. They hold no time, host or path, so that the same inputs give the same bytes.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Meta {
    /// Digest of everything that the samples depend on.
    pub content: [u8; 32],
    /// Digest of the mesh in metres, its materials, colors and holes.
    pub geometry: [u8; 32],
    /// Digest of the lights of the scene file.
    pub lights: [u8; 32],
    /// How the samples were made.
    pub options: Options,
    /// `K`: samples drawn, including those that no light reaches. The estimator divides by it.
    pub samples_drawn: u64,
    /// Samples that were drawn and not stored because no light reaches them, by reason.
    #[serde(deserialize_with = "counts")]
    pub samples_dropped: BTreeMap<String, u64>,
    /// Shadow rays traced.
    pub shadow_rays: u64,
    /// Defects of the sampled surfaces as a mesh, by name, so that `gather` need not look for them again.
    #[serde(deserialize_with = "counts")]
    pub mesh_faults: BTreeMap<String, u64>,
    /// Area of the sampled surfaces, m².
    pub surface_area_m2: f64,
    /// Mean of the flux over all drawn samples, per channel, W.
    pub mean_flux_w: [f64; 3],
    /// Diagonal of the scene's bounding box, m.
    pub diagonal_m: f64,
    /// World position to which the sample positions are relative, m.
    pub origin_m: [f64; 3],
    /// The sampled materials, in the order of their groups in the file.
    #[serde(deserialize_with = "list")]
    pub materials: Vec<SampledMaterial>,
}

impl Meta {
    /// Samples drawn for each of the two independent halves: even and odd ones.
    pub fn drawn_by_half(&self) -> [u64; 2] {
        [self.samples_drawn.div_ceil(2), self.samples_drawn / 2]
    }

    /// The origin of float32 positions in files for other programs (`P` of an image, `x y z` of a PLY), m. It is 0 and
    /// the positions are those in the world, unless float32 would round them by more than 1e-5 of the scene's diagonal.
    /// Then it is the scene's center rounded to float32. That rounding moves it by 32 diagonals at most, because the
    /// import refuses scenes that lie farther from the origin, and positions relative to it are rounded by 2e-6 of the
    /// diagonal.
    pub fn exchange_origin_m(&self) -> [f32; 3] {
        const MAX_ROUNDING: f64 = 1e-5;
        let farthest = self.origin_m.iter().fold(0.0, |max: f64, x| max.max(x.abs())) + 0.5 * self.diagonal_m;
        let rounding = 0.5 * f64::from(f32::EPSILON) * farthest;
        if rounding > MAX_ROUNDING * self.diagonal_m { self.origin_m.map(|x| x as f32) } else { [0.0; 3] }
    }

    /// True if all facts are finite, only coordinates are negative, and the shard is one of its count.
    pub(super) fn is_sound(&self) -> bool {
        let single = [self.surface_area_m2, self.diagonal_m, self.options.metres_per_unit];
        let areas = self.materials.iter().map(|m| m.area_m2);
        let sizes = single.into_iter().chain(self.mean_flux_w).chain(areas);
        let shard = self.options.shard;
        let facts = sizes.chain(self.options.shares.iter().map(|(_, share)| *share));
        self.origin_m.into_iter().all(f64::is_finite)
            && facts.into_iter().all(|x| x.is_finite() && x >= 0.0)
            && shard.index < shard.count
    }
}

/// The settings of `sample-surface`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Options {
    pub seed: u64,
    pub shard: Shard,
    pub choice: Choice,
    pub pattern: Pattern,
    /// Materials with the requested share of the samples.
    #[serde(deserialize_with = "shares")]
    pub shares: Vec<(String, f64)>,
    pub normals: Normals,
    pub metres_per_unit: f64,
    /// Unit of the scene file's lights.
    pub light_unit: LightUnit,
    /// Unit of its emitting materials.
    pub emission_unit: LightUnit,
    /// The animation and time of the scene; empty at rest.
    #[serde(deserialize_with = "text")]
    pub pose: String,
    /// Identity of the light from all around: its radiance, or a digest of the map.
    #[serde(deserialize_with = "text")]
    pub environment: String,
}

/// The number of a cloud among several that are drawn apart and gathered together: `index` of `count`, from 0. Each
/// shard has random numbers of its own and any number of samples.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Shard {
    pub index: u32,
    pub count: u32,
}

impl Shard {
    /// The one shard of a whole cloud.
    pub const ALONE: Shard = Shard { index: 0, count: 1 };
}

impl fmt::Display for Shard {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        write!(f, "{}/{}", self.index, self.count)
    }
}

/// A translucent material and the ranges of its samples.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SampledMaterial {
    #[serde(deserialize_with = "text")]
    pub name: String,
    /// Index into the scene's materials.
    pub index: u16,
    /// The stored samples of each half.
    pub halves: [Group; 2],
    /// m².
    pub area_m2: f64,
}

impl SampledMaterial {
    /// Stored samples of both halves.
    pub fn count(&self) -> u64 {
        self.halves.iter().map(|h| h.samples).sum()
    }
}

/// The samples of one material and one half, in spatial order under a tree of their own.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Group {
    pub samples: u64,
    pub first_tile: u64,
    pub first_node: u64,
}

impl Group {
    /// Tiles of sixteen samples; samples without flux fill the last one.
    pub fn tiles(&self) -> u64 {
        self.samples.div_ceil(TILE as u64)
    }

    /// Nodes of the tree over the tiles, see [`super::Node`].
    pub fn nodes(&self) -> u64 {
        node_count(self.tiles())
    }
}

/// A digest as hexadecimal text.
pub fn hex(digest: &[u8; 32]) -> String {
    digest.iter().map(|b| format!("{b:02x}")).collect()
}

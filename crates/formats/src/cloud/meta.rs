//! What a cloud says of itself.

use super::{
    bounded::{counts, list, shares, text},
    settings::{Choice, LightUnit, Normals, Pattern},
};
use serde::{Deserialize, Serialize};
use std::{collections::BTreeMap, fmt};

/// The struct of this version; the number is checked before this is read.
#[derive(Debug, Serialize, Deserialize)]
pub(super) enum Versioned {
    V6(Meta),
}

/// Facts of a cloud. Holds no time, host or path: the same inputs give the same bytes.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Meta {
    /// Identity of everything the samples depend on.
    pub content: [u8; 32],
    /// Identity of the mesh, metres and materials' extents.
    pub geometry: [u8; 32],
    /// Identity of the lights of the scene file.
    pub lights: [u8; 32],
    /// How the samples were made.
    pub options: Options,
    /// `K`: samples drawn, the unlit ones included. The estimator divides by it.
    pub samples_drawn: u64,
    /// Samples drawn but not stored because they carry no light, by reason.
    #[serde(deserialize_with = "counts")]
    pub samples_dropped: BTreeMap<String, u64>,
    /// Shadow rays traced.
    pub shadow_rays: u64,
    /// Faults of the sampled surfaces as a mesh, by name: who gathers need not look for them again.
    #[serde(deserialize_with = "counts")]
    pub mesh_faults: BTreeMap<String, u64>,
    /// Area of the sampled surfaces, m².
    pub surface_area_m2: f64,
    /// Mean of the flux over all drawn samples, per channel, W.
    pub mean_flux_w: [f64; 3],
    /// Diagonal of the scene's bounding box, m.
    pub diagonal_m: f64,
    /// World position that sample positions are relative to, m.
    pub origin_m: [f64; 3],
    /// The sampled materials in order; their groups follow each other in the file.
    #[serde(deserialize_with = "list")]
    pub materials: Vec<SampledMaterial>,
}

impl Meta {
    /// Samples drawn for each of the two independent halves: even and odd ones.
    pub fn drawn_by_half(&self) -> [u64; 2] {
        [self.samples_drawn.div_ceil(2), self.samples_drawn / 2]
    }

    /// What positions in float32 are relative to in files for other programs (`P` of an image, `x y z` of a PLY), m. It is
    /// 0, and they are world positions, unless their rounding would exceed 1e-5 of the scene's diagonal; then it is the
    /// scene's centre, itself as float32 has it: what that is off by is 32 diagonals at most, since scenes farther from
    /// the origin for their size are refused, and then is the rounding still 2e-6 of the diagonal.
    pub fn exchange_origin_m(&self) -> [f32; 3] {
        const WORST: f64 = 1e-5;
        let farthest = self.origin_m.iter().fold(0.0, |most: f64, x| most.max(x.abs())) + 0.5 * self.diagonal_m;
        let rounding = 0.5 * f64::from(f32::EPSILON) * farthest;
        if rounding > WORST * self.diagonal_m { self.origin_m.map(|x| x as f32) } else { [0.0; 3] }
    }

    /// True if every fact is a number that it can be: none is NaN or infinite, and only a place may be negative.
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

/// What `sample-surface` was asked for.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Options {
    pub seed: u64,
    pub shard: Shard,
    pub choice: Choice,
    pub pattern: Pattern,
    /// Materials with the share of the samples that was asked for.
    #[serde(deserialize_with = "shares")]
    pub shares: Vec<(String, f64)>,
    pub normals: Normals,
    pub metres_per_unit: f64,
    /// Unit of the scene file's lights.
    pub light_unit: LightUnit,
    /// Unit of its emitting materials.
    pub emission_unit: LightUnit,
    /// Light from all around: its radiance, or the identity of a map.
    #[serde(deserialize_with = "text")]
    pub environment: String,
}

/// Which of several clouds that are drawn apart, to be gathered together: `index` of `count`, from 0. Each is a cloud of
/// its own random numbers and of any number of samples; 0 of 1 is the only one.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Shard {
    pub index: u32,
    pub count: u32,
}

impl Shard {
    /// A cloud that is meant to be alone.
    pub const ALONE: Shard = Shard { index: 0, count: 1 };
}

impl fmt::Display for Shard {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        write!(f, "{}/{}", self.index, self.count)
    }
}

/// A translucent material and its samples.
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

/// Samples in spatial order under a tree of their own: of one material and one half.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Group {
    pub samples: u64,
    pub first_tile: u64,
    pub first_node: u64,
}

impl Group {
    /// Tiles of sixteen samples; the last one may be filled up with samples without flux.
    pub fn tiles(&self) -> u64 {
        self.samples.div_ceil(super::TILE as u64)
    }

    /// Nodes of the tree over the tiles, see [`super::Node`].
    pub fn nodes(&self) -> u64 {
        super::node_count(self.tiles())
    }
}

/// A digest as hexadecimal text.
pub fn hex(digest: &[u8; 32]) -> String {
    digest.iter().map(|b| format!("{b:02x}")).collect()
}

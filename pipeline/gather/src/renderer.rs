//! What all camera paths of an image share: the scene, and the translucent objects with their media and samples.

use crate::{
    estimator::{Calibration, Estimator, FalloffTables, Rates},
    samples::LitSamples,
    shards::DrawnCounts,
};
use bssrdf::Medium;
use scene::{Camera, NormalKind, Rays, Scene, light::LightTree, random::Stream};
use std::ops::Range;

/// Everything a path needs; shared by all threads.
pub struct Renderer<'a, M> {
    pub scene: &'a Scene,
    pub rays: &'a Rays<'a>,
    pub lights: LightTree<'a>,
    pub camera: &'a Camera,
    /// One entry for each material; none for opaque ones.
    pub objects: Vec<Option<TranslucentObject<'a, M>>>,
    pub normals: NormalKind,
    pub estimator: Estimator,
    /// Samples of each cloud, the unlit ones included.
    pub drawn: DrawnCounts,
    pub paths_per_pixel: u32,
    /// Paths of each pixel that are added at once.
    pub pass: Range<u32>,
    pub max_depth: u32,
    /// How far beyond a surface a ray goes on that passes it straight, m.
    pub clearance: f64,
    pub paths: Stream,
    pub gathers: Stream,
    pub shard_picks: Stream,
}

/// A translucent material with its medium and its samples.
pub struct TranslucentObject<'a, M> {
    pub medium: Medium,
    pub model: M,
    /// `σ̃_t` of light that is not scattered, 1/m.
    pub unscattered: [f64; 3],
    pub method: Method,
    /// What the accuracy asked of the cut is multiplied by, see [`crate::calibration`].
    pub calibration: Calibration,
    /// The two independent halves of each cloud.
    pub parts: Vec<[LitSamples<'a>; 2]>,
}

impl<M> TranslucentObject<'_, M> {
    /// Nothing leaves it scattered.
    pub fn is_dark(&self) -> bool {
        self.medium.is_clear() || self.parts.iter().flatten().all(|samples| samples.is_empty())
    }
}

/// How the samples of an object are summed.
pub enum Method {
    Exhaustive,
    Roulette(Rates),
    Cut(FalloffTables),
}

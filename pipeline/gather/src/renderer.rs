//! What all camera paths of an image share: the scene, and the translucent objects with their media and samples.

use crate::{estimator::Estimator, shards::DrawnCounts};
use bssrdf::Medium;
use scene::{Camera, NormalKind, Rays, Scene, light::LightTree, random::Stream};
use std::ops::Range;
use sums::Summation;

/// Everything a path needs; shared by all threads.
pub struct Renderer<'a> {
    pub scene: &'a Scene,
    pub rays: &'a Rays<'a>,
    pub lights: LightTree<'a>,
    pub camera: &'a Camera,
    /// One entry for each material; none for opaque ones.
    pub objects: Vec<Option<TranslucentObject<'a>>>,
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
pub struct TranslucentObject<'a> {
    pub medium: Medium,
    /// `σ̃_t` of light that is not scattered, 1/m.
    pub unscattered: [f64; 3],
    pub summation: Summation<'a>,
}

impl TranslucentObject<'_> {
    /// Nothing leaves it scattered.
    pub fn is_dark(&self) -> bool {
        self.medium.is_clear() || self.summation.is_empty()
    }
}

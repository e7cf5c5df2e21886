//! The data that all camera paths of an image share: the scene, and translucent objects with their media and samples.

use crate::{
    estimator::{Calibration, Estimator, FalloffTables, Rates},
    samples::LitSamples,
    shards::DrawnCounts,
};
use bsdf::Surface;
use bssrdf::Medium;
use scene::{
    Camera, NormalKind, Rays, Scene,
    light::{Environment, LightTree},
    random::Stream,
};
use std::ops::Range;

/// The data of an image, shared by all threads.
pub struct Renderer<'a, M> {
    pub scene: &'a Scene,
    pub rays: &'a Rays<'a>,
    pub lights: LightTree<'a>,
    pub camera: &'a Camera,
    /// Of each material; none for opaque ones.
    pub objects: Vec<Option<TranslucentObject<'a, M>>>,
    /// The light of rays that leave the scene.
    pub environment: Environment,
    pub normals: NormalKind,
    pub estimator: Estimator,
    /// Samples of each cloud, the unlit ones included.
    pub drawn: DrawnCounts,
    pub paths_per_pixel: u32,
    /// Paths of each pixel that the current pass adds.
    pub pass: Range<u32>,
    pub max_depth: u32,
    /// Distance beyond a surface at which a ray continues that crosses it straight, m.
    pub clearance: f64,
    pub paths: Stream,
    pub gathers: Stream,
    pub shard_picks: Stream,
}

/// A translucent material with its medium and its samples.
pub struct TranslucentObject<'a, M> {
    pub medium: Medium,
    pub model: M,
    /// Extinction `σ̃_t` of unscattered light, 1/m (docs/method.md 5.11).
    pub unscattered: [f64; 3],
    pub method: Method,
    /// Factor of the accuracy that is asked of the cut, see [`crate::calibration`].
    pub calibration: Calibration,
    /// The two independent halves of each cloud.
    pub parts: Vec<[LitSamples<'a>; 2]>,
}

impl<M> TranslucentObject<'_, M> {
    /// What happens to light at its surface.
    pub fn surface(&self) -> Surface {
        Surface::dielectric(self.medium.eta)
    }

    /// True if no scattered light leaves it.
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

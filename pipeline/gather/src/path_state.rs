//! The state of one camera path, and the memory of its thread.

use crate::{
    counts::Counts,
    estimator::Scratch,
    path_light::{Layer, PathLight},
    shards::ShardPick,
};
use scene::{DVec3, SurfacePoint, random::Item};

/// The index of a path.
#[derive(Clone, Copy, Debug)]
pub struct PathIndex {
    pub pixel: u64,
    /// Index in the pixel. Even paths gather from the first half of the cloud, odd ones from the second.
    pub path: u32,
}

/// Counts and memory of one thread.
#[derive(Clone, Debug, Default)]
pub struct ThreadContext {
    pub counts: Counts,
    /// Of each material.
    pub scratch: Vec<Scratch>,
}

impl ThreadContext {
    /// The context for a scene with this number of materials.
    pub fn new(materials: usize) -> ThreadContext {
        ThreadContext { counts: Counts::default(), scratch: vec![Scratch::default(); materials] }
    }
}

/// A path between two surfaces.
#[derive(Clone, Copy)]
pub struct PathState {
    pub origin: DVec3,
    pub direction: DVec3,
    /// The triangle that the ray starts on.
    pub from: Option<u32>,
    /// The material whose medium the ray is in.
    pub inside: Option<u16>,
    pub throughput: DVec3,
    /// The layer of all further light, after the first event.
    pub layer: Option<Layer>,
    pub events: u32,
    /// The half of the cloud that it gathers from, if paths alternate between the halves.
    pub half: usize,
    /// The shard that it gathers from, if paths alternate between the shards.
    pub turn: ShardPick,
    /// Random numbers of the path, and the dimension of the next one.
    pub random: Item,
    pub dimension: u64,
    /// Random numbers of its gathers.
    pub key: Item,
}

impl PathState {
    /// The next uniform number of the path.
    pub fn uniform(&mut self) -> f64 {
        self.dimension += 1;
        self.random.uniform(self.dimension - 1)
    }

    /// Sends the path on from a surface point. The layer of its light becomes `event` if this is its first event.
    pub fn leave(&mut self, point: &SurfacePoint, direction: DVec3, event: Layer) {
        self.origin = point.position;
        self.direction = direction;
        self.from = Some(point.triangle);
        self.layer.get_or_insert(event);
    }
}

impl PathLight {
    /// Adds light to the path's layer, or to `layer` before its first event.
    pub fn add(&mut self, state: &PathState, layer: Layer, radiance: DVec3) {
        self.add_halves(state, layer, radiance, [radiance; 2]);
    }

    /// The same for light of which each half of the cloud has an estimate of its own.
    pub fn add_halves(&mut self, state: &PathState, layer: Layer, radiance: DVec3, halves: [DVec3; 2]) {
        self.layers[state.layer.unwrap_or(layer) as usize] += state.throughput * radiance;
        self.halves.iter_mut().zip(halves).for_each(|(sum, half)| *sum += state.throughput * half);
    }
}

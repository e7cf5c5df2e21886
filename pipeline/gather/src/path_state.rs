//! What a camera path carries with it, and what its thread keeps for it.

use crate::{
    counts::Counts,
    estimator::Scratch,
    path_light::{Layer, PathLight},
    shards::ShardPick,
};
use scene::{DVec3, SurfacePoint, random::Item};

/// Which path.
#[derive(Clone, Copy, Debug)]
pub struct PathIndex {
    pub pixel: u64,
    /// Its number in the pixel. Even ones gather from the first half of the cloud, odd ones from the second.
    pub path: u32,
}

/// What one thread counts and keeps between paths.
#[derive(Clone, Debug, Default)]
pub struct ThreadContext {
    pub counts: Counts,
    /// One for each material.
    scratch: Vec<Scratch>,
}

impl ThreadContext {
    /// For a scene of so many materials.
    pub fn new(materials: usize) -> ThreadContext {
        ThreadContext { counts: Counts::default(), scratch: vec![Scratch::default(); materials] }
    }

    pub fn scratch(&mut self, material: usize) -> &mut Scratch {
        &mut self.scratch[material]
    }
}

/// A path on its way.
#[derive(Clone, Copy)]
pub struct PathState {
    pub origin: DVec3,
    pub direction: DVec3,
    /// The triangle that the ray starts on.
    pub from: Option<u32>,
    /// The material whose medium the ray is in.
    pub inside: Option<u16>,
    pub throughput: DVec3,
    /// The layer of all further light, once there was an event.
    pub layer: Option<Layer>,
    pub events: u32,
    /// Which half of the cloud it gathers from, if it is one.
    pub half: usize,
    /// Which of several clouds, if it is one.
    pub turn: ShardPick,
    pub random: Item,
    pub dimension: u64,
    pub key: Item,
}

impl PathState {
    /// The next uniform number of the path.
    pub fn uniform(&mut self) -> f64 {
        self.dimension += 1;
        self.random.uniform(self.dimension - 1)
    }

    /// Sends the path on from a point of the surface, and files its light under this event if it is its first.
    pub fn leave(&mut self, point: &SurfacePoint, direction: DVec3, event: Layer) {
        self.origin = point.position;
        self.direction = direction;
        self.from = Some(point.triangle);
        self.layer.get_or_insert(event);
    }
}

impl PathLight {
    /// Files light under the path's layer, or under `layer` if nothing happened to it yet.
    pub fn add(&mut self, state: &PathState, layer: Layer, radiance: DVec3) {
        self.add_halves(state, layer, radiance, [radiance; 2]);
    }

    /// The same of light that the halves of the cloud know each in its own way.
    pub fn add_halves(&mut self, state: &PathState, layer: Layer, radiance: DVec3, halves: [DVec3; 2]) {
        self.layers[state.layer.unwrap_or(layer) as usize] += state.throughput * radiance;
        self.halves.iter_mut().zip(halves).for_each(|(sum, half)| *sum += state.throughput * half);
    }
}

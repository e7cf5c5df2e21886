//! The state of one camera path, the light that it gathers, and the memory of its thread.

use crate::{
    counts::Counts,
    estimator::Scratch,
    pixel_numbers::{NearNumbers, SurfaceNumbers, WalkStarts},
};
use scene::{DVec3, SurfacePoint, random::Item, sequence::turned};
use sums::drawn::ShardPick;

/// The index of a path.
#[derive(Clone, Copy, Debug)]
pub struct PathIndex {
    pub pixel: u64,
    /// Index in the pixel. Even paths gather from the first half of the cloud, odd ones from the second.
    pub path: u32,
    /// Whether its pixel is an edge pixel.
    pub edge: bool,
    /// The first numbers of the walks that it begins at its first interface, one for each channel, if it begins any.
    pub walks: Option<WalkStarts>,
    /// The numbers of its points around the first exitant point, if it draws any.
    pub near: Option<NearNumbers>,
    /// The numbers at its first surface with many directions, if there may be one.
    pub surface: Option<SurfaceNumbers>,
}

/// Counts and memory of one thread.
#[derive(Debug, Default)]
pub struct ThreadContext {
    pub counts: Counts,
    /// The buffers of the cut, for each material.
    pub scratch: Vec<Scratch>,
    pub near: near_field::Scratch,
}

impl ThreadContext {
    /// The context for a scene with this number of materials.
    pub fn new(materials: usize) -> ThreadContext {
        ThreadContext { scratch: vec![Scratch::default(); materials], ..ThreadContext::default() }
    }
}

/// The light of a path that is followed, and the branch that is left to follow after a split.
#[derive(Default)]
pub struct Trace {
    pub light: PathLight,
    pub mirrored: Option<PathState>,
}

/// A point of a rough surface that a path has left in a direction which lights were sampled for, too.
#[derive(Clone, Copy)]
pub struct Drawn {
    pub at: SurfacePoint,
    /// Density of the direction over the number of directions towards each light, 1/sr.
    pub density: f64,
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
    /// Where the direction was drawn from, if the light at that point was sampled as well.
    pub drawn: Option<Drawn>,
    /// The share that is left to this path of the light which the next surface mirrors of lamps and the environment.
    pub mirrored_share: f64,
    /// The share that is left to this path of the light which the next surface emits, or which comes from afar.
    pub emitted_share: f64,
    /// The layer of all further light, after the first event.
    pub layer: Option<Layer>,
    pub events: u32,
    /// Whether it follows both branches at the next interface that it meets from outside.
    pub splits: bool,
    /// The half of the cloud that it gathers from, if paths alternate between the halves.
    pub half: usize,
    /// The shard that it gathers from, if paths alternate between the shards.
    pub shard_pick: ShardPick,
    /// The first numbers of the walks at the path's first interface, until they are used.
    pub walks: Option<WalkStarts>,
    /// The numbers of the points around the first exitant point, until they are used.
    pub near: Option<NearNumbers>,
    /// The share of its light that a smooth first interface mirrored; 0 of all other branches.
    pub mirrors: f64,
    /// Whether its pixel is an edge pixel.
    pub edge: bool,
    /// The relative error of its gathers, if it is not that of the image.
    pub accuracy: Option<f64>,
    /// The numbers at the first surface with many directions, until they are used.
    pub light: Option<SurfaceNumbers>,
    pub mirrored: Option<SurfaceNumbers>,
    /// Random numbers of its other points around exitant points.
    pub near_points: Item,
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

    /// The number of directions towards each light, and the numbers that choose them, one pair for each call. They are
    /// many at the first surface alone: shadow rays cost less than paths, and what later surfaces reflect is less.
    pub fn light_numbers(&mut self) -> (usize, impl FnMut() -> [f64; 2] + use<'_>) {
        let (first, mut index) = (self.light.take().map(|numbers| numbers.lights()), 0);
        let tries = first.map_or(1, |first| first.len());
        let xi = move || match first {
            None => [self.uniform(), self.uniform()],
            Some(first) => {
                index += 1;
                turned(first[(index - 1) % tries], (index - 1) / tries)
            }
        };
        (tries, xi)
    }

    /// Sends the path on from a surface point. The layer of its light becomes `event` if this is its first event.
    pub fn leave(&mut self, point: &SurfacePoint, direction: DVec3, event: Layer) {
        self.origin = point.position;
        self.direction = direction;
        self.from = Some(point.triangle);
        self.drawn = None;
        (self.mirrored_share, self.emitted_share) = (1.0, 1.0);
        self.layer.get_or_insert(event);
    }
}

/// The layer of a path's light is its first event.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(usize)]
pub enum Layer {
    /// Light sources and the environment, seen directly or through the first interface.
    Emission = 0,
    /// Light that crosses the first interface and leaves again without being scattered.
    Transmission = 1,
    /// Light that is scattered below the first interface.
    Subsurface = 2,
    /// Light that the first interface mirrors.
    Specular = 3,
    /// Light that an opaque surface reflects.
    Diffuse = 4,
}

/// The names of the layers in the channels of an image.
pub const LAYERS: [&str; 5] = ["emission", "transmission", "subsurface", "specular", "diffuse"];

/// Light of one path, by layer, W/(m² sr).
pub type Layers = [DVec3; 5];

/// Light of one path, W/(m² sr).
#[derive(Clone, Copy, Debug, Default)]
pub struct PathLight {
    pub layers: Layers,
    /// The sum of the layers as each half of the cloud alone estimates it; without scattered light for a half that the
    /// path did not gather from.
    pub halves: [DVec3; 2],
    /// The part of the scattered light that is known without it, by [`Way`], W/(m² sr), in an edge pixel.
    pub known: [DVec3; 2],
}

/// A way in which a path sees light that is scattered below a surface.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(usize)]
pub enum Way {
    /// Below the first interface.
    Direct = 0,
    /// Below the surface that the first interface mirrors, if that is smooth.
    Mirrored = 1,
}

/// The first surface that the ray through a pixel's center meets; zero where there is none.
#[derive(Clone, Copy, Debug, Default)]
pub struct Guide {
    pub normal: DVec3,
    /// World position, m.
    pub position: DVec3,
    /// Distance along the view direction, m.
    pub depth: f64,
    /// Color of an opaque surface, or of the medium below a translucent one.
    pub albedo: DVec3,
    /// The number of its material, from 1.
    pub id: u32,
}

impl PathLight {
    /// Adds light to the path's layer, or to `layer` before its first event.
    pub fn add(&mut self, state: &PathState, layer: Layer, radiance: DVec3) {
        self.add_halves(state, layer, radiance, [radiance; 2]);
    }

    /// Adds light that each half of the cloud estimates separately.
    pub fn add_halves(&mut self, state: &PathState, layer: Layer, radiance: DVec3, halves: [DVec3; 2]) {
        self.layers[state.layer.unwrap_or(layer) as usize] += state.throughput * radiance;
        self.halves.iter_mut().zip(halves).for_each(|(sum, half)| *sum += state.throughput * half);
    }
}

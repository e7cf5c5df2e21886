//! Phase two: a cloud, media and a camera to an image.
//!
//! Never samples a light for a translucent surface: their light is the cloud's. Parallel over pixels, never within a
//! sum, so the image is the same for any number of threads.

mod calibration;
pub mod counts;
mod edge;
pub mod film;
mod freedom;
pub mod media;
mod passes;
mod path;
pub mod path_light;
pub mod path_state;
pub mod preview;
pub mod renderer;
pub mod shards;
mod subsurface;

pub use passes::Passes;
pub use sums::{Summation, estimator, samples};

use bssrdf::{Medium, Model};
use counts::Counts;
use estimator::Estimator;
use film::Pixel;
use formats::cloud::Cloud;
use scene::{Camera, NormalKind, Rays, Scene};

/// Over what part of a pixel its paths are spread.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Filter {
    /// All of it, evenly.
    Box,
    /// Its centre.
    Point,
}

/// A part of an image, pixels: its left column, its upper row, columns, rows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Crop {
    pub x: usize,
    pub y: usize,
    pub width: usize,
    pub height: usize,
}

/// How to render.
#[derive(Clone, Debug)]
pub struct Settings {
    /// Of the whole image, of which a crop is a part.
    pub width: usize,
    pub height: usize,
    /// What is rendered of it, inside it, if not all: the same to the last bit as in the whole image.
    pub crop: Option<Crop>,
    pub paths_per_pixel: u32,
    pub filter: Filter,
    pub estimator: Estimator,
    pub model: Model,
    pub normals: NormalKind,
    pub max_depth: u32,
    pub seed: u64,
}

impl Settings {
    /// What is rendered of the image.
    pub fn part(&self) -> Crop {
        self.crop.unwrap_or(Crop { x: 0, y: 0, width: self.width, height: self.height })
    }
}

impl Crop {
    pub fn pixels(&self) -> usize {
        self.width * self.height
    }

    /// Column and row in the whole image of pixel `place` of the part, which are counted row by row.
    pub fn pixel(&self, place: usize) -> [usize; 2] {
        [self.x + place % self.width, self.y + place / self.width]
    }
}

/// What to render.
pub struct Input<'a> {
    pub scene: &'a Scene,
    pub rays: &'a Rays<'a>,
    /// One or more of this scene, see [`shards::join`].
    pub clouds: &'a [Cloud],
    /// The medium of each material that the clouds sampled, in their order.
    pub media: &'a [Medium],
    pub camera: &'a Camera,
}

/// A rendered image.
pub struct Rendered {
    /// Those of [`Settings::part`], rows from top to bottom.
    pub pixels: Vec<Pixel>,
    pub paths_per_pixel: u32,
    pub counts: Counts,
    /// Indices of pixels with a number that is not finite; the first few.
    pub non_finite: Vec<usize>,
    pub non_finite_count: u64,
}

/// Renders an image of `settings.paths_per_pixel` paths; `progress` is called with numbers of pixels that are done.
pub fn render(input: &Input, settings: &Settings, progress: impl Fn(u64) + Sync) -> Rendered {
    let mut passes = Passes::new(input, settings);
    passes.pass(settings.paths_per_pixel, progress);
    passes.finish()
}

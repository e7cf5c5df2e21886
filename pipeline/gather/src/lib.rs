//! Phase two: a cloud, media and a camera to an image.
//!
//! Never samples a light for a translucent surface: their light is the cloud's. Parallel over pixels, never within a
//! sum, so the image is the same for any number of threads.

mod calibration;
pub mod counts;
mod crop;
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

pub use crop::Crop;
pub use sums::{estimator, samples};

use bssrdf::{LaneVisitor, Medium, Model, lanes::LaneModel};
use counts::Counts;
use estimator::Estimator;
use film::{Errors, Pixel};
use formats::cloud::Cloud;
use passes::Passes;
use scene::{Camera, NormalKind, Rays, Scene, light::Environment};

/// Over what part of a pixel its paths are spread.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Filter {
    /// All of it, evenly.
    Box,
    /// Its centre.
    Point,
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
    /// What rays that escape see.
    pub environment: Environment,
    pub max_depth: u32,
    pub seed: u64,
}

impl Settings {
    /// What is rendered of the image.
    pub fn part(&self) -> Crop {
        self.crop.unwrap_or(Crop { x: 0, y: 0, width: self.width, height: self.height })
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

/// An image on its way: paths are added to all pixels in passes.
pub trait Session {
    /// Adds so many paths to every pixel; `progress` is told how many pixels were done.
    fn pass(&mut self, paths: u32, progress: &(dyn Fn(u64) + Sync));

    /// The image's errors so far; none of a black image.
    fn errors(&self) -> Option<Errors>;

    /// The image.
    fn finish(self: Box<Self>) -> Rendered;
}

/// Prepares an image. Its cut is as accurate as `settings.paths_per_pixel` paths need.
pub fn start<'a>(input: &Input<'a>, settings: &Settings) -> Box<dyn Session + 'a> {
    struct Start<'a, 'b>(&'b Input<'a>, &'b Settings);
    impl<'a> LaneVisitor for Start<'a, '_> {
        type Output = Box<dyn Session + 'a>;

        fn visit<M: LaneModel>(self) -> Self::Output {
            Box::new(Passes::<M>::new(self.0, self.1))
        }
    }
    settings.model.visit_lanes(Start(input, settings))
}

/// Renders an image of `settings.paths_per_pixel` paths; `progress` is told how many pixels were done.
pub fn render(input: &Input, settings: &Settings, progress: impl Fn(u64) + Sync) -> Rendered {
    let mut session = start(input, settings);
    session.pass(settings.paths_per_pixel, &progress);
    session.finish()
}

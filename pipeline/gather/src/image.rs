//! The input, the settings and the result of rendering an image.

use crate::{counts::Counts, crop::Crop, estimator::Estimator, film::Pixel};
use bssrdf::{Medium, Model};
use formats::{calibration::Calibration, cloud::Cloud};
use glam::{DVec2, DVec3};
use scene::{Camera, NormalKind, Rays, Scene};
use tint::Tinted;

/// How paths are spread over a pixel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Filter {
    /// Paths are spread evenly over the whole pixel.
    Box,
    /// All paths go through the pixel's center.
    Point,
}

impl Filter {
    pub const ALL: [Filter; 2] = [Filter::Box, Filter::Point];

    /// The word that users type.
    pub fn name(self) -> &'static str {
        match self {
            Filter::Box => "box",
            Filter::Point => "point",
        }
    }
}

/// The input of an image.
#[derive(Clone, Copy)]
pub struct Input<'a> {
    pub scene: &'a Scene,
    pub rays: &'a Rays<'a>,
    /// One cloud of this scene, or several that are gathered as one, see [`formats::cloud::shards::join`].
    pub clouds: &'a [Cloud],
    /// The medium of each material that the clouds sampled, in their order.
    pub media: &'a [Medium],
    /// The tinted samples of each of these materials that has a texture; empty if none has.
    pub tints: &'a [Option<Tinted>],
    /// The factors of the media on this shape, if it is calibrated.
    pub calibration: Option<&'a Calibration>,
    pub camera: &'a Camera,
}

/// The settings of an image.
#[derive(Clone, Debug)]
pub struct Settings {
    /// Size of the whole image, pixels.
    pub width: usize,
    pub height: usize,
    /// The part of the image that is rendered, if not all of it. Its pixels have the same bits as in the whole image.
    pub crop: Option<Crop>,
    pub paths_per_pixel: u32,
    pub filter: Filter,
    pub estimator: Estimator,
    /// Whether the noise of the paths decides the accuracy of the cut, if the image has enough pixels.
    pub balances: bool,
    pub model: Model,
    /// Light that enters near an exitant point is sampled around it, if the samples are too far apart to carry it.
    pub near_field: bool,
    /// Random walks take the place of the sum over the cloud.
    pub reference: bool,
    pub normals: NormalKind,
    pub max_depth: u32,
    pub seed: u64,
    /// Radiance that the camera sees in place of the environment, W/(m² sr), if it does not see that itself.
    pub backdrop: Option<DVec3>,
}

impl Settings {
    /// Width and height of the whole image, pixels.
    pub fn size(&self) -> DVec2 {
        DVec2::new(self.width as f64, self.height as f64)
    }

    /// The part of the image that is rendered.
    pub fn part(&self) -> Crop {
        self.crop.unwrap_or(Crop { x: 0, y: 0, width: self.width, height: self.height })
    }
}

/// A rendered image.
pub struct Rendered {
    /// The pixels of [`Settings::part`], row by row from the top.
    pub pixels: Vec<Pixel>,
    /// Paths of each pixel; where pixels share them, the mean over the pixels whose neighbors have noise.
    pub paths_per_pixel: u32,
    /// The fewest and the most paths of a pixel.
    pub fewest_and_most: [u32; 2],
    pub counts: Counts,
    /// Indices of the first few pixels with a value that is not finite.
    pub non_finite: Vec<usize>,
    /// The number of all such pixels.
    pub non_finite_count: u64,
}

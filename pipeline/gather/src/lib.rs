//! Phase two: a cloud, media and a camera to an image.
//!
//! Never samples a light for a translucent surface: their light is the cloud's. Parallel over pixels, never within a
//! sum, so the image is the same for any number of threads.

pub mod estimator;
pub mod film;
pub mod media;
pub mod path;
pub mod preview;
pub mod samples;

use bssrdf::{
    Medium, Model,
    lanes::{BetterLanes, DirectionalLanes, LaneModel, StandardLanes},
};
use estimator::{Estimator, Rule};
use film::{Pixel, PixelSum};
use formats::cloud::Cloud;
use path::{Body, Counts, Renderer};
use rayon::prelude::*;
use samples::LitSamples;
use scene::{
    Camera, DVec3, NormalKind, Rays, Scene,
    random::{Purpose, Stream},
};

/// Pixels that one task renders.
const TILE: usize = 64;

/// Share of the scene's diagonal that a ray skips when it passes a surface straight.
const CLEARANCE: f64 = 1e-9;

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
    pub width: usize,
    pub height: usize,
    pub paths_per_pixel: u32,
    pub filter: Filter,
    pub estimator: Estimator,
    pub model: Model,
    pub normals: NormalKind,
    /// Radiance of rays that escape, W/(m² sr).
    pub environment: DVec3,
    pub max_depth: u32,
    pub seed: u64,
}

/// What to render.
pub struct Input<'a> {
    pub scene: &'a Scene,
    pub rays: &'a Rays,
    pub cloud: &'a Cloud,
    /// The medium of each material that the cloud sampled, in the cloud's order.
    pub media: &'a [Medium],
    pub camera: &'a Camera,
}

/// A rendered image.
pub struct Rendered {
    /// Rows from top to bottom.
    pub pixels: Vec<Pixel>,
    pub counts: Counts,
    /// Indices of pixels with a number that is not finite; the first few.
    pub non_finite: Vec<usize>,
    pub non_finite_count: u64,
}

/// Renders an image; `progress` is told how many pixels were done.
pub fn render(input: &Input, settings: &Settings, progress: impl Fn(u64) + Sync) -> Rendered {
    match settings.model {
        Model::DirectionalDipole => render_with::<DirectionalLanes>(input, settings, progress),
        Model::BetterDipole => render_with::<BetterLanes>(input, settings, progress),
        Model::StandardDipole => render_with::<StandardLanes>(input, settings, progress),
    }
}

fn render_with<M: LaneModel>(input: &Input, settings: &Settings, progress: impl Fn(u64) + Sync) -> Rendered {
    let renderer = Renderer {
        scene: input.scene,
        rays: input.rays,
        camera: input.camera,
        bodies: bodies::<M>(input, settings),
        environment: settings.environment,
        normals: settings.normals,
        estimator: settings.estimator,
        samples_drawn: input.cloud.meta().samples_drawn as f64,
        max_depth: settings.max_depth,
        clearance: CLEARANCE * input.scene.mesh.diagonal(),
        paths: Stream::new(settings.seed, Purpose::CameraPath),
        roulette: Stream::new(settings.seed, Purpose::Roulette),
    };
    let count = settings.width * settings.height;
    let tile = |first: usize| {
        let mut counts = Counts::default();
        let pixels: Vec<Pixel> =
            (first..(first + TILE).min(count)).map(|p| render_pixel(&renderer, settings, p, &mut counts)).collect();
        progress(pixels.len() as u64);
        (pixels, counts)
    };
    let tiles: Vec<_> = (0..count.div_ceil(TILE)).into_par_iter().map(|t| tile(t * TILE)).collect();
    let mut counts = Counts::default();
    tiles.iter().for_each(|(_, c)| counts.add(c));
    let pixels: Vec<Pixel> = tiles.into_iter().flat_map(|(pixels, _)| pixels).collect();
    let bad = || pixels.iter().enumerate().filter(|(_, p)| !p.is_finite()).map(|(k, _)| k);
    let (non_finite, non_finite_count) = (bad().take(8).collect(), bad().count() as u64);
    Rendered { pixels, counts, non_finite, non_finite_count }
}

fn bodies<M: LaneModel>(input: &Input, settings: &Settings) -> Vec<Option<Body<M>>> {
    let mut bodies: Vec<Option<Body<M>>> = input.scene.materials.iter().map(|_| None).collect();
    for (sampled, medium) in input.cloud.meta().materials.iter().zip(input.media) {
        let transport = settings.model.of(medium).transport();
        let rule = match settings.estimator {
            Estimator::Roulette(rule) => rule,
            Estimator::Exhaustive => Rule::Mixture,
        };
        bodies[sampled.index as usize] = Some(Body {
            model: M::new(medium),
            unscattered: settings.model.unscattered_extinction(medium),
            rates: rule.rates(transport),
            samples: LitSamples::new(input.cloud.samples(sampled.first, sampled.count), medium.eta),
            medium: medium.clone(),
        });
    }
    bodies
}

fn render_pixel<M: LaneModel>(renderer: &Renderer<M>, settings: &Settings, pixel: usize, counts: &mut Counts) -> Pixel {
    let size = glam::DVec2::new(settings.width as f64, settings.height as f64);
    let corner = glam::DVec2::new((pixel % settings.width) as f64, (pixel / settings.width) as f64);
    let ray = |offset: glam::DVec2| {
        let (origin, direction) = renderer.camera.ray(corner + offset, size);
        (origin - renderer.scene.origin, direction)
    };
    let centre = glam::DVec2::splat(0.5);
    let mut sum = PixelSum::default();
    for path in 0..settings.paths_per_pixel {
        let index = pixel as u64 * u64::from(settings.paths_per_pixel) + u64::from(path);
        let offset = match settings.filter {
            Filter::Point => centre,
            Filter::Box => {
                let random = renderer.paths.item(index);
                glam::DVec2::new(random.uniform(0), random.uniform(1))
            }
        };
        let (origin, direction) = ray(offset);
        sum.add(&renderer.trace(index, origin, direction, counts));
    }
    let (origin, direction) = ray(centre);
    sum.pixel(renderer.guide(origin, direction))
}

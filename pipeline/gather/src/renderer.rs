//! The data that all camera paths of an image share: the scene, and translucent objects with their media and samples.

use crate::{
    highlights::Highlights,
    image::{Input, Settings},
    known::Known,
    reference::Walks,
};
use bsdf::{SMOOTH_BELOW, Surface};
use bssrdf::Medium;
use calibration::Factors;
use glam::DVec2;
use near_field::{NearField, Surroundings};
use scene::{DVec3, Hit, Scene, light::LightTree, random::Stream};
use std::ops::Range;
use sums::{Summation, drawn::DrawnCounts};
use tint::{Share, Tint};
use walks::Roughness;

/// The data of an image, shared by all threads.
pub struct Renderer<'a> {
    pub input: Input<'a>,
    pub settings: Settings,
    pub lights: LightTree<'a>,
    /// What lights near fields; none if there is no near field.
    pub surroundings: Option<Surroundings<'a>>,
    /// Where surfaces mirror lights towards rough ones.
    pub highlights: Highlights,
    /// What is known of the light at the centers of pixels.
    pub known: Known,
    /// The translucent object of each material; none for opaque materials.
    pub objects: Vec<Option<TranslucentObject<'a>>>,
    /// Samples of each cloud, the unlit ones included.
    pub drawn: DrawnCounts,
    /// Paths of each pixel by the end of the current pass, or of the last one that is expected; where pixels share them,
    /// the mean that decides what the cut adds to the image's error.
    pub paths_per_pixel: f64,
    /// Paths of each pixel that the current pass adds.
    pub pass: Range<u32>,
    /// Whether random walks can meet light where they leave.
    pub meets_light: bool,
    /// Distance beyond a surface at which a ray continues that crosses it straight, m.
    pub clearance: f64,
    pub paths: Stream,
    pub gathers: Stream,
    pub shard_picks: Stream,
    pub walk_starts: Stream,
    pub near_points: Stream,
}

impl Renderer<'_> {
    /// Origin, m from the scene's, and unit direction of the ray through a point of the image, pixels, and through the
    /// place on the camera's lens that `lens` chooses, or its middle.
    pub fn camera_ray(&self, point: DVec2, lens: Option<[f64; 2]>) -> (DVec3, DVec3) {
        let Renderer { input, settings, .. } = self;
        let (origin, direction) = match lens {
            None => input.camera.ray(point, settings.size()),
            Some(xi) => input.camera.ray_through(point, settings.size(), xi),
        };
        (origin - input.scene.origin, direction)
    }
}

/// Light of some samples that one medium scatters.
pub struct Scattering<'a> {
    pub summation: Summation<'a>,
    /// The near part, if the samples are too far apart for it; the summation then has the far part alone.
    pub near: Option<NearField>,
    /// What the texture does to light that enters and leaves; the samples are tinted.
    pub tint: Option<Tint>,
}

impl Scattering<'_> {
    fn is_dark(&self) -> bool {
        self.near.is_none() && self.summation.is_empty()
    }
}

/// A translucent material with its medium and its samples.
pub struct TranslucentObject<'a> {
    pub medium: Medium,
    /// Color for compositors: what a half-space of the medium scatters back.
    pub color: DVec3,
    /// Extinction `σ̃_t` of unscattered light, 1/m (docs/method.md 5.11).
    pub unscattered: [f64; 3],
    /// The roughness of its surface, if it has any.
    pub rough: Option<Roughness>,
    /// `a` and `b` of the light that leaves in proportion to `T21 (a + b μ)`, for each channel (docs/method.md 15.8).
    pub lobe: [[f64; 2]; 3],
    /// How light scatters below: one part or, of two media that a texture blends, four. The light of the first medium that
    /// leaves from it comes first, then that of the second which leaves from the first, and both for the second.
    pub parts: Vec<Scattering<'a>>,
    /// The factors of its surface, if it is calibrated.
    pub factors: Option<Factors>,
    /// Random walks, if they take the place of the summation.
    pub walks: Option<Walks<'a>>,
}

impl TranslucentObject<'_> {
    /// Whether it mirrors in many directions.
    pub fn is_rough(&self) -> bool {
        self.rough.is_some()
    }

    /// What happens to light at a point of its surface.
    pub fn surface(&self, scene: &Scene, hit: &Hit) -> Surface<'_> {
        let Some(rough) = &self.rough else { return Surface::dielectric(self.medium.eta) };
        match rough.at(scene, hit.triangle, hit.weights) {
            smooth if smooth * smooth < SMOOTH_BELOW => Surface::dielectric(self.medium.eta),
            roughness => Surface::RoughDielectric(rough.boundary.surface(roughness)),
        }
    }

    /// The shares of the parts of its light at a point: of two media, alpha is that of what leaves from the first.
    pub fn shares(&self, scene: &Scene, hit: &Hit) -> [f64; 4] {
        if self.parts.len() == 1 {
            return [1.0, 0.0, 0.0, 0.0];
        }
        let color = scene.texture_color(hit.triangle, hit.weights);
        let [first, second] = [Share::First, Share::Second].map(|share| share.of(&color));
        [first, first, second, second]
    }

    /// The factors `a + b μ` of the channels for a view whose cosine outside is `cosine`.
    pub fn exit_lobe(&self, cosine: f64) -> DVec3 {
        DVec3::from_array(self.lobe.map(|[a, b]| a + b * cosine))
    }

    /// True if no scattered light leaves it.
    pub fn is_dark(&self) -> bool {
        self.medium.is_clear() || self.walks.is_none() && self.parts.iter().all(Scattering::is_dark)
    }
}

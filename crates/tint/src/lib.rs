//! Textured media: what the texture of a translucent surface does to light that enters and leaves (docs/method.md section
//! 19).
//!
//! A texture says how much light its places reflect, relative to the medium below. Half of that, as a factor, acts where
//! light enters and half where it leaves: the square root at each crossing. The samples of a cloud do not know their
//! texture coordinates; [`Tinted`] finds them on the mesh and keeps tinted copies.

mod mean;
mod samples;

pub use samples::{Half, Tinted};

use bssrdf::{Medium, Model};
use glam::DVec3;
use mean::Mean;
use scene::{ScatterExtension, Scene};

/// The tint of one material.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tint {
    /// Reflectance over that of the medium, for a texture of 1.
    scale: DVec3,
    /// The largest such ratio: all that enters leaves.
    limit: DVec3,
}

/// What is said of the tint of a material.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TintFacts {
    /// Mean of the texture over the surface.
    pub mean: DVec3,
    /// The share of the surface where a channel would reflect more light than enters, and reflects all of it instead.
    pub limited: f64,
}

impl Tint {
    /// The tint of a translucent material, if it has a base color texture and its medium scatters. A texture that tints a
    /// medium of the file's own colors is taken as it is, any other relative to its mean over the surface, so that the
    /// medium is that of the mean.
    pub fn new(scene: &Scene, material: u16, medium: &Medium, model: Model) -> Option<(Tint, TintFacts)> {
        let textured = scene.materials[usize::from(material)].base_texture.is_some();
        if !textured || medium.is_clear() {
            return None;
        }
        let drafts = [ScatterExtension::Scatter, ScatterExtension::VolumeScatter];
        let is_of_colors = drafts.iter().any(|draft| draft.extension() == medium.name);
        let mean = Mean::new(scene, material);
        let relative = |mean: f64| if mean > 0.0 { 1.0 / mean } else { 1.0 };
        let scale = if is_of_colors { DVec3::ONE } else { mean.color.map(relative) };
        let limit = DVec3::from_array(model.reflectance(medium)).map(|r| if r > 0.0 { 1.0 / r } else { f64::INFINITY });
        let limited = mean.share(|color| (color * scale).cmpgt(limit).any());
        Some((Tint { scale, limit }, TintFacts { mean: mean.color, limited }))
    }

    /// The factor of light that enters or leaves where the texture has this color (docs/method.md 20.1).
    pub fn crossing(&self, color: DVec3) -> DVec3 {
        (color * self.scale).min(self.limit).map(f64::sqrt)
    }

    /// The same at the point of a triangle with these barycentric weights.
    pub fn at(&self, scene: &Scene, triangle: u32, weights: [f64; 3]) -> DVec3 {
        self.crossing(scene.texture_color(triangle, weights))
    }
}

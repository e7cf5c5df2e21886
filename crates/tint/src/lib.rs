//! Textured media: what the texture of a translucent surface does to light that enters and leaves (docs/method.md section
//! 19).
//!
//! A texture says how much light its places reflect, relative to the medium below. Half of that, as a factor, acts where
//! light enters and half where it leaves: the square root at each crossing. The samples of a cloud do not know their
//! texture coordinates; [`Tinted`] finds them on the mesh and keeps tinted copies.
//!
//! The alpha of the texture may blend two media: of the light that enters at a place, the share alpha enters the first.

mod reflectances;
mod samples;

pub use samples::{Blend, Half, Tinted};

use bssrdf::{Medium, Model};
use glam::DVec3;
use reflectances::Reflectances;
use scene::{ScatterExtension, Scene, SurfaceColors, TextureColor};

/// The tint of one material.
#[derive(Clone, Debug, PartialEq)]
pub struct Tint {
    /// Reflectance over that of the medium, for a texture of 1.
    scale: DVec3,
    /// What the color after multiple scattering changes, if the medium is of the file's colors.
    reflectances: Option<Reflectances>,
    /// The largest such ratio: all that enters leaves.
    limit: DVec3,
    /// The medium whose share of the light this is, if there are two.
    share: Option<Share>,
}

/// One of the two media that the alpha of a texture blends.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Share {
    /// The medium where alpha is 1.
    First,
    Second,
}

impl Share {
    /// The share of a place of this color.
    pub fn of(self, color: &TextureColor) -> f64 {
        let alpha = color.base.w.clamp(0.0, 1.0);
        match self {
            Share::First => alpha,
            Share::Second => 1.0 - alpha,
        }
    }
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
    /// The tint of a translucent material, if it has a texture of a color and its medium scatters. A base color texture that
    /// tints a medium of the file's own colors is taken as it is, any other relative to its mean over the surface, so that
    /// the medium is that of the mean. A texture of the color after multiple scattering states that medium: it reflects as
    /// media of its colors do.
    pub fn new(scene: &Scene, material: u16, medium: &Medium, model: Model) -> Option<(Tint, TintFacts)> {
        let stated = &scene.materials[usize::from(material)];
        if !stated.is_tinted() || medium.is_clear() {
            return None;
        }
        let drafts = [ScatterExtension::Scatter, ScatterExtension::VolumeScatter];
        let is_of_colors = drafts.iter().any(|draft| draft.extension() == medium.name);
        let surface = SurfaceColors::new(scene, material);
        let mean = surface.mean.truncate();
        let relative = |mean: f64| if mean > 0.0 { 1.0 / mean } else { 1.0 };
        let scale = if is_of_colors { DVec3::ONE } else { mean.map(relative) };
        let scatter = stated.medium.as_ref().and_then(|medium| medium.scatter.as_ref());
        let scatter = scatter.filter(|_| is_of_colors && stated.scatter_texture.is_some());
        let reflectances = scatter.map(|s| Reflectances::new(s, surface.scatter_mean(), medium.eta, model));
        let limit = DVec3::from_array(model.reflectance(medium)).map(|r| if r > 0.0 { 1.0 / r } else { f64::INFINITY });
        let tint = Tint { scale, reflectances, limit, share: None };
        let limited = surface.mean_of(|color| f64::from(u8::from(tint.factor(color).cmpgt(limit).any())));
        Some((tint, TintFacts { mean, limited }))
    }

    /// The same for the light of one of two media.
    pub fn of(&self, share: Share) -> Tint {
        Tint { share: Some(share), ..self.clone() }
    }

    /// The reflectance where the textures have this color, over that of the medium.
    fn factor(&self, color: &TextureColor) -> DVec3 {
        let scattered = self.reflectances.as_ref().map_or(color.scatter, |of| of.relative(color.scatter));
        color.base.truncate() * scattered * self.scale
    }

    /// The factor of light that leaves where the texture has this color (docs/method.md 20.1).
    pub fn leaving(&self, color: &TextureColor) -> DVec3 {
        self.factor(color).min(self.limit).map(f64::sqrt)
    }

    /// The factor of light that enters there. Of two media it is one's share.
    pub fn entering(&self, color: &TextureColor) -> DVec3 {
        let factor = self.leaving(color);
        self.share.map_or(factor, |share| factor * share.of(color))
    }

    /// The factor of samples whose place is not known.
    fn lost(&self) -> f64 {
        if self.share.is_some() { 0.5 } else { 1.0 }
    }
}

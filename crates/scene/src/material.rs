//! The appearance of surfaces.

use crate::{texture::Texture, volume::Volume};
use glam::{DVec3, DVec4};

/// The appearance of a surface, apart from the medium below it.
#[derive(Clone, Debug, PartialEq)]
pub struct Material {
    pub name: String,
    /// Diffuse albedo of an opaque surface, and alpha: a factor of those of texture and vertices.
    pub base_color: DVec4,
    pub base_texture: Option<Texture>,
    /// Where alpha is less, an opaque surface has a hole.
    pub cutoff: Option<f32>,
    /// Radiance that it emits, W/(m² sr).
    pub emission: DVec3,
    /// Whether the file marks the surface as the boundary of a volume.
    pub volume: bool,
    /// The medium of that volume, if the file describes it.
    pub medium: Option<Volume>,
    /// Whether it emits to both sides.
    pub double_sided: bool,
}

impl Material {
    /// True if any channel emits.
    pub fn emits(&self) -> bool {
        self.emission != DVec3::ZERO
    }
}

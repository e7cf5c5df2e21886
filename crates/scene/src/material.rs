//! The appearance of surfaces, and the media below them, as a glTF file describes them.

use crate::{bumps::NormalMap, texture::Texture};
use glam::{DVec3, DVec4};

/// The appearance of a surface, apart from the medium below it.
#[derive(Clone, Debug, PartialEq)]
pub struct Material {
    pub name: String,
    /// Diffuse albedo of an opaque surface, and alpha: a factor of those of texture and vertices.
    pub base_color: DVec4,
    pub base_texture: Option<Texture>,
    pub normal_map: Option<NormalMap>,
    /// What the alpha of an opaque surface means.
    pub alpha: Alpha,
    /// Radiance that it emits, W/(m² sr): a factor of that of the texture.
    pub emission: DVec3,
    pub emission_texture: Option<Texture>,
    /// How the surface mirrors, if the file states a roughness or a metal.
    pub gloss: Option<GlossStated>,
    /// Whether the file marks the surface as translucent: light enters it, or it bounds a volume.
    pub volume: bool,
    /// Whether the file gives it walls without thickness that light crosses: transmission without a volume.
    pub thin: bool,
    /// How those walls scatter light to both sides, if they do.
    pub wall: Option<Wall>,
    /// The medium that its `extras` state; it takes precedence over that of extensions.
    pub stated: Option<StatedMedium>,
    /// The medium where the alpha of its texture is 0, by its `extras`; that of the material is where it is 1.
    pub blend: Option<StatedMedium>,
    /// The medium of that volume, if the file describes it.
    pub medium: Option<Volume>,
    /// A texture of the color after multiple scattering. The color of that medium is then the mean over the surface.
    pub scatter_texture: Option<Texture>,
    /// Whether it emits to both sides.
    pub double_sided: bool,
}

impl Material {
    /// True if any channel emits anywhere.
    pub fn emits(&self) -> bool {
        self.emission != DVec3::ZERO
    }

    /// Whether a texture changes how much light its places reflect, if it is translucent.
    pub fn is_tinted(&self) -> bool {
        self.base_texture.is_some() || self.scatter_texture.is_some()
    }

    /// True if it emits all over or, by its texture, on half of it or more. A surface with a few lights on it is no lamp.
    pub fn is_lamp(&self) -> bool {
        /// A texel of a lower code of sRGB is dark: it has 1.4 % of the light of a white one.
        const BRIGHT: u8 = 32;
        let Some(texture) = &self.emission_texture else { return self.emits() };
        let texels = &texture.picture.texels;
        let is_bright = |texel: &&[u8; 4]| (0..3).any(|c| self.emission[c] > 0.0 && texel[c] >= BRIGHT);
        2 * texels.iter().filter(is_bright).count() >= texels.len()
    }
}

/// How a surface mirrors, by the metallic-roughness model of glTF.
#[derive(Clone, Debug, PartialEq)]
pub struct GlossStated {
    /// 0 to 1: a factor of the texture's blue.
    pub metallic: f64,
    /// 0 to 1: a factor of the texture's green.
    pub roughness: f64,
    pub texture: Option<Texture>,
    /// What the part that is no metal reflects.
    pub dielectric: bsdf::Schlick,
}

impl GlossStated {
    /// Metallic and roughness where the texture has this texel.
    pub(crate) fn with(&self, texel: DVec4) -> [f64; 2] {
        [self.metallic * texel.z, self.roughness * texel.y]
    }

    /// Whether any roughness is left where a surface is no mirror.
    pub fn is_rough(&self) -> bool {
        self.mean_roughness().powi(2) >= bsdf::SMOOTH_BELOW
    }

    /// The mean roughness over all texels.
    pub fn mean_roughness(&self) -> f64 {
        let Some(texture) = &self.texture else { return self.roughness };
        let texels = &texture.picture.texels;
        let sum: u64 = texels.iter().map(|texel| u64::from(texel[1])).sum();
        self.roughness * sum as f64 / (255.0 * texels.len().max(1) as f64)
    }
}

/// A wall without thickness that scatters light, as an extension states it. All numbers are from 0 to 1, but the anisotropy,
/// which is from -1 to 1.
#[derive(Clone, Debug, PartialEq)]
pub struct Wall {
    /// The share of light that enters by transmission.
    pub transmission: f64,
    /// The anisotropy of KHR_materials_scatter; none for KHR_materials_diffuse_transmission.
    pub anisotropy: Option<f64>,
    /// The share that is scattered: of all light with diffuse transmission, else of what enters.
    pub share: f64,
    pub color: DVec3,
    /// A texture whose alpha is a factor of the share, and one whose color is a factor of the color.
    pub textures: [Option<Texture>; 2],
}

/// How a wall without thickness scatters the light that does not cross it straight (docs/method.md 13.8).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WallShares {
    /// The share of the base color in what leaves on the side where the light came from.
    pub base: f64,
    /// What leaves there besides, and what leaves on the other side: shares for each channel.
    pub back: DVec3,
    pub through: DVec3,
    /// The share of rays that cross it straight.
    pub clear: f64,
}

impl Wall {
    /// Its shares where the textures are this alpha and this color. A wall that all light crosses scatters nothing.
    pub fn shares(&self, alpha: f64, color: DVec3) -> WallShares {
        let (entering, share, color) = (self.transmission, self.share * alpha, self.color * color);
        let Some(g) = self.anisotropy else {
            return WallShares { base: 1.0 - share, back: DVec3::ZERO, through: share * color, clear: entering };
        };
        let scattered = entering * share;
        let clear = entering - scattered;
        if clear >= 1.0 {
            return WallShares { base: 0.0, back: DVec3::ZERO, through: DVec3::ZERO, clear };
        }
        let color = color * (scattered / (1.0 - clear));
        let [back, through] = [color * 0.5 * (1.0 - g), color * 0.5 * (1.0 + g)];
        WallShares { base: (1.0 - entering) / (1.0 - clear), back, through, clear }
    }

    /// Its shares without its textures.
    pub fn plain(&self) -> WallShares {
        self.shares(1.0, DVec3::ONE)
    }

    /// Whether the share of rays that cross it straight varies.
    pub(crate) fn clear_varies(&self) -> bool {
        self.anisotropy.is_some() && self.textures[0].is_some()
    }

    /// All numbers that define it, but those of textures.
    pub(crate) fn numbers(&self) -> [f64; 8] {
        let WallShares { base, back, through, clear } = self.plain();
        [base, back.x, back.y, back.z, through.x, through.y, through.z, clear]
    }
}

/// What alpha below 1 means.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Alpha {
    /// Nothing.
    Ignored,
    /// A hole where it is less than this.
    Cutoff(f32),
    /// The share of rays that meet the surface.
    Coverage,
}

/// A medium as the `extras` of a material state it, not read yet: this crate knows no media.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum StatedMedium {
    /// The name of a built-in one.
    Name(String),
    /// The text of a medium's file, JSON.
    Json(String),
}

/// The medium below a surface, by KHR_materials_volume, KHR_materials_ior and the two draft extensions for scattering.
#[derive(Clone, Debug, PartialEq)]
pub struct Volume {
    /// `σ_t` per channel, 1/m: absorption and scattering together.
    pub extinction: DVec3,
    /// Relative index, inside over outside.
    pub ior: f64,
    /// None if the medium only absorbs.
    pub scatter: Option<Scatter>,
}

/// How the medium scatters.
#[derive(Clone, Debug, PartialEq)]
pub struct Scatter {
    pub draft: ScatterExtension,
    /// Color after multiple scattering, 0 to 1.
    pub color: DVec3,
    /// Mean cosine of the phase function, between -1 and 1.
    pub asymmetry: f64,
}

impl Scatter {
    /// The mean cosine that the albedo depends on beside the color: in the older draft it depends on none.
    pub fn asymmetry_of_color(&self) -> f64 {
        if self.draft == ScatterExtension::Scatter { self.asymmetry } else { 0.0 }
    }
}

/// The draft extension that the numbers come from: the two give different albedos for the same numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ScatterExtension {
    VolumeScatter,
    Scatter,
}

impl ScatterExtension {
    /// The extension's name.
    pub fn extension(self) -> &'static str {
        match self {
            ScatterExtension::VolumeScatter => "KHR_materials_volume_scatter",
            ScatterExtension::Scatter => "KHR_materials_scatter",
        }
    }
}

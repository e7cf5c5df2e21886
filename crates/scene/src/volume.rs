//! The medium below a surface, as a glTF file describes it.

use glam::DVec3;

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

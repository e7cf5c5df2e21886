//! Units of the numbers in a file.

/// Units of the numbers in a file.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ImportOptions {
    /// Size of one unit of the file, m.
    pub metres_per_unit: f64,
    /// Unit of directional, point and spot lights; none if the file decides it.
    pub light_unit: Option<LightUnit>,
    /// Unit of emitting materials; none if the file decides it.
    pub emission_unit: Option<LightUnit>,
}

/// The unit of the lights or of the emitting materials. The two may differ: Blender multiplies its lights by 683 lm/W,
/// and writes its emission as it is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LightUnit {
    /// W/m², W/sr, W/(m² sr).
    Radiometric,
    /// Lux, candela, nit: divided by 683 lm/W.
    Photometric,
}

impl LightUnit {
    /// Factor that turns the file's numbers into watts.
    pub(super) fn watts(self) -> f64 {
        match self {
            LightUnit::Radiometric => 1.0,
            LightUnit::Photometric => 1.0 / 683.0,
        }
    }
}

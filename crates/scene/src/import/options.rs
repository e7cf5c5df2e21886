//! How a file is read.

/// Units of the numbers in a file, and the pose of what moves.
#[derive(Clone, Debug, PartialEq)]
pub struct ImportOptions {
    /// Size of one unit of the file, m.
    pub metres_per_unit: f64,
    /// Unit of directional, point and spot lights; none if the file decides it.
    pub light_unit: Option<LightUnit>,
    /// Unit of emitting materials; none if the file decides it.
    pub emission_unit: Option<LightUnit>,
    /// A time of an animation; without one, everything is as the file has it at rest.
    pub pose: Option<Pose>,
}

/// A time of an animation.
#[derive(Clone, Debug, PartialEq)]
pub struct Pose {
    /// The name of the animation, which is `animationK` for one without a name. None for the only one.
    pub animation: Option<String>,
    /// Seconds on the clock of the animation.
    pub seconds: f64,
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

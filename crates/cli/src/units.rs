//! The unit of a file's lights or emitting materials, as a command line gives it.

use formats::cloud::LightUnit;

/// A unit, or the choice to leave it to the scene's file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum UnitChoice {
    /// As the program that wrote the file means its numbers.
    Auto,
    Given(LightUnit),
}

impl UnitChoice {
    /// All choices.
    pub const ALL: &'static [UnitChoice] =
        &[UnitChoice::Auto, UnitChoice::Given(LightUnit::Radiometric), UnitChoice::Given(LightUnit::Photometric)];

    /// The word on a command line.
    pub fn name(self) -> &'static str {
        match self {
            UnitChoice::Auto => "auto",
            UnitChoice::Given(unit) => unit.name(),
        }
    }

    /// The choice, or this unit if it is left open.
    pub(crate) fn or(self, unit: LightUnit) -> UnitChoice {
        if self == UnitChoice::Auto { UnitChoice::Given(unit) } else { self }
    }

    /// The unit in the terms of the importer; none if the file decides it.
    pub(crate) fn of_scene(self) -> Option<scene::LightUnit> {
        match self {
            UnitChoice::Auto => None,
            UnitChoice::Given(LightUnit::Radiometric) => Some(scene::LightUnit::Radiometric),
            UnitChoice::Given(LightUnit::Photometric) => Some(scene::LightUnit::Photometric),
        }
    }
}

/// The unit of the importer as clouds store it.
pub fn stored_unit(unit: scene::LightUnit) -> LightUnit {
    match unit {
        scene::LightUnit::Radiometric => LightUnit::Radiometric,
        scene::LightUnit::Photometric => LightUnit::Photometric,
    }
}

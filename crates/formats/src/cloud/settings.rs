//! Settings that a cloud was made with. Files and command lines know them by name.

use serde::{Deserialize, Deserializer, Serialize, Serializer, de::Error};
use std::fmt;

/// The rule by which triangles are chosen.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Choice {
    /// In proportion to area.
    Area,
    /// Every triangle with the same probability, as in the note.
    Uniform,
}

/// How samples are spread over the surface.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Pattern {
    /// Evenly: a lattice along ribbons of triangles, and a scrambled sequence for the light.
    Stratified,
    /// Independently, as in the note.
    Independent,
}

/// The normals with which cosines are taken.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Normals {
    /// Interpolated from the vertices.
    Shading,
    /// Those of the triangles, as in the note.
    Geometric,
}

/// The unit of a scene file's lights or emitting materials.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LightUnit {
    /// Watts.
    Radiometric,
    /// Lumens, divided by 683 lm/W.
    Photometric,
}

/// Names the values of a setting, in files too.
macro_rules! names {
    ($type:ident: $($value:ident = $name:literal),+) => {
        impl $type {
            pub const ALL: &'static [$type] = &[$($type::$value),+];

            pub fn name(self) -> &'static str {
                match self {
                    $($type::$value => $name,)+
                }
            }
        }

        impl fmt::Display for $type {
            fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
                f.write_str(self.name())
            }
        }

        impl Serialize for $type {
            fn serialize<S: Serializer>(&self, to: S) -> Result<S::Ok, S::Error> {
                to.serialize_str(self.name())
            }
        }

        impl<'de> Deserialize<'de> for $type {
            fn deserialize<D: Deserializer<'de>>(from: D) -> Result<Self, D::Error> {
                match <&str>::deserialize(from)? {
                    $($name => Ok($type::$value),)+
                    other => Err(D::Error::unknown_variant(other, &[$($name),+])),
                }
            }
        }
    };
}

names!(Choice: Area = "area", Uniform = "uniform");
names!(Pattern: Stratified = "stratified", Independent = "independent");
names!(Normals: Shading = "shading", Geometric = "geometric");
names!(LightUnit: Radiometric = "radiometric", Photometric = "photometric");

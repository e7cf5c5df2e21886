//! The units of the numbers in a file, where the user leaves them to the file.

use super::{
    nodes::SceneNode,
    options::{ImportOptions, LightUnit},
};
use crate::unhonoured::quoted;
use gltf::json::Root;

/// The units of a file's lights and of its emitting materials, each given or decided.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FileUnits {
    pub light: LightUnit,
    pub emission: LightUnit,
    /// What was decided and why, in one line, if anything was.
    pub note: Option<String>,
}

/// How writers of files mean their numbers.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Writer {
    /// A file that names none, or one of our own programs: watts.
    Watts,
    /// Lights are multiplied by 683 lm/W, and emission is not.
    Blender,
    /// Lux, candela and nits, as glTF says.
    Specification,
}

impl Writer {
    fn of(generator: Option<&str>) -> Writer {
        match generator.map(str::trim) {
            None | Some("" | "make-scenes") => Writer::Watts,
            Some(name) if name.to_lowercase().contains("blender") => Writer::Blender,
            Some(_) => Writer::Specification,
        }
    }
}

/// Lamps of which none is as bright as this are in watts, whoever wrote them: sunlight is 10^5 lux and lamps of a room
/// have hundreds of candela, and the same in watts are 683 times less. A sun of Blender's strength 1 is written as 683, or
/// as 1 by its lighting mode "Unitless".
const BRIGHT: f32 = 100.0;

/// Decides what the options leave open, by the generator of the file and by how bright its lights are. Without lights
/// nothing tells how bright emission is meant, which viewers show as it is: it is taken as watts.
pub(super) fn decide(root: &Root, nodes: &[SceneNode], options: &ImportOptions) -> FileUnits {
    let has_light = |n: &SceneNode| n.node.extensions.as_ref().is_some_and(|e| e.khr_lights_punctual.is_some());
    let generator = root.asset.generator.as_deref();
    let lights = root.extensions.as_ref().and_then(|e| e.khr_lights_punctual.as_ref());
    let is_bright = lights.is_some_and(|l| l.lights.iter().any(|light| light.intensity >= BRIGHT));
    let named = if nodes.iter().any(has_light) { Writer::of(generator) } else { Writer::Watts };
    let writer = if is_bright { named } else { Writer::Watts };
    let of_file = match writer {
        Writer::Watts => [LightUnit::Radiometric; 2],
        Writer::Blender => [LightUnit::Photometric, LightUnit::Radiometric],
        Writer::Specification => [LightUnit::Photometric; 2],
    };
    let [light, emission] = [options.light_unit.unwrap_or(of_file[0]), options.emission_unit.unwrap_or(of_file[1])];
    let decided = named != Writer::Watts && (options.light_unit.is_none() || options.emission_unit.is_none());
    let note = decided.then(|| {
        let why = match writer {
            Writer::Blender => "as the exporter of Blender writes them",
            Writer::Watts => "since no light is as bright as 100, as those in lux or candela are",
            Writer::Specification => "as glTF says",
        };
        let [lights, emitters] = [words(light, "lux and candela", "watts"), words(emission, "nits", "watts")];
        let by = quoted(generator.unwrap_or_default());
        format!(
            "units: lights in {lights}, emission in {emitters}, {why} ({by}); --light-unit and --emission-unit say otherwise"
        )
    });
    FileUnits { light, emission, note }
}

/// The name of a unit: `lumens` stands for those that are divided by 683 lm/W.
fn words<'a>(unit: LightUnit, lumens: &'a str, watts: &'a str) -> &'a str {
    match unit {
        LightUnit::Radiometric => watts,
        LightUnit::Photometric => lumens,
    }
}

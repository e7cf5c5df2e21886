//! The environment as it is named on a command line.

use crate::{Common, Failure, Need, parse_rgb, require_memory};
use formats::Panorama;
use scene::{
    DVec3, Vec3,
    light::{Environment, EnvironmentMap},
};
use std::{
    fmt::{self, Display, Formatter},
    path::{Path, PathBuf},
    sync::Arc,
};

/// The value of `--environment`.
#[derive(Clone, Debug, PartialEq)]
pub enum EnvironmentSource {
    /// A constant radiance, W/(m² sr).
    Constant(DVec3),
    /// One of the panoramas that the programs bring along.
    BuiltIn(BuiltIn),
    /// A panorama.
    File(PathBuf),
}

/// A panorama that the programs bring along: a picture of data/environments.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BuiltIn {
    /// Soft boxes before a dark backdrop, which light a scene that has no light.
    Studio,
    Sky,
}

impl BuiltIn {
    const ALL: [BuiltIn; 2] = [BuiltIn::Studio, BuiltIn::Sky];

    /// The word that users type.
    pub fn name(self) -> &'static str {
        match self {
            BuiltIn::Studio => "studio",
            BuiltIn::Sky => "sky",
        }
    }

    fn file(self) -> &'static [u8] {
        match self {
            BuiltIn::Studio => {
                include_bytes!(concat!(env!("CARGO_MANIFEST_DIR"), "/../../data/environments/studio.hdr"))
            }
            BuiltIn::Sky => include_bytes!(concat!(env!("CARGO_MANIFEST_DIR"), "/../../data/environments/sky.hdr")),
        }
    }
}

/// Parses the name of a built-in panorama, a file, which is known by its extension, or a color.
pub fn parse_environment(text: &str) -> Result<EnvironmentSource, String> {
    if let Some(one) = BuiltIn::ALL.into_iter().find(|one| one.name() == text) {
        return Ok(EnvironmentSource::BuiltIn(one));
    }
    if [".exr", ".hdr"].iter().any(|end| text.to_lowercase().ends_with(end)) {
        return Ok(EnvironmentSource::File(text.into()));
    }
    let color = parse_rgb(text).map_err(|e| format!("{e}; or studio, sky, or a picture, FILE.exr or FILE.hdr"))?;
    Ok(EnvironmentSource::Constant(DVec3::from_array(color)))
}

impl EnvironmentSource {
    /// Reads the environment, with its radiance multiplied by `scale` and turned about +Y; prints the warnings of the
    /// reader.
    pub fn read(&self, scale: f64, rotation_degrees: f64, common: &Common) -> Result<Environment, Failure> {
        let fault = |e: &dyn Display| Failure::usage(format!("--environment: {e}"));
        let (picture, name) = match self {
            EnvironmentSource::Constant(radiance) => return Ok((*radiance * scale).into()),
            EnvironmentSource::BuiltIn(one) => {
                (Panorama::decode(one.file()).map_err(|e| fault(&e))?, one.name().to_owned())
            }
            EnvironmentSource::File(path) => {
                check_memory(path)?;
                (Panorama::read(path).map_err(|e| fault(&e))?, path.display().to_string())
            }
        };
        picture.warnings.iter().for_each(|w| common.warn(format_args!("--environment: {name}: {w}")));
        let pixels = picture.pixels.into_iter().map(Vec3::from_array).collect();
        let map = EnvironmentMap::new((picture.width, picture.height), pixels, scale, rotation_degrees);
        Ok(Environment::Map(Arc::new(map.map_err(|e| fault(&format_args!("{name}: {e}")))?)))
    }
}

/// As it is typed.
impl Display for EnvironmentSource {
    fn fmt(&self, f: &mut Formatter) -> fmt::Result {
        match self {
            EnvironmentSource::Constant(c) => write!(f, "{},{},{}", c.x, c.y, c.z),
            EnvironmentSource::BuiltIn(one) => f.write_str(one.name()),
            EnvironmentSource::File(path) => path.display().fmt(f),
        }
    }
}

/// Refuses a panorama that does not fit into memory, before its pixels are read.
fn check_memory(path: &Path) -> Result<(), Failure> {
    let size = Panorama::size(path).map_err(|e| Failure::usage(format!("--environment: {e}")))?;
    let map = EnvironmentMap::bytes((size.width, size.height));
    let what = format!("--environment: {}: a picture of {} x {} pixels", path.display(), size.width, size.height);
    require_memory(&what, Need { held: size.reading_bytes.max(map), mapped: 0 }, "scale it down")
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What is typed is said again, and what the programs bring along can be read.
    #[test]
    fn words_are_environments() {
        for word in ["studio", "sky", "1,0.5,2", "studio.hdr", "a/sky.exr"] {
            assert_eq!(parse_environment(word).map(|source| source.to_string()), Ok(word.to_owned()));
        }
        assert!(parse_environment("stage").is_err_and(|message| message.contains("studio")));
        for one in BuiltIn::ALL {
            let picture = Panorama::decode(one.file()).expect("a picture");
            assert!(picture.warnings.is_empty() && picture.width == 2 * picture.height, "{}", one.name());
        }
    }
}

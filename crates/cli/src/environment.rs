//! The environment as it is named on a command line.

use crate::{Common, Failure, Need, parse_rgb, require_memory};
use formats::Panorama;
use scene::{
    DVec3, Vec3,
    light::{Environment, EnvironmentMap},
};
use std::{
    path::{Path, PathBuf},
    sync::Arc,
};

/// The value of `--environment`.
#[derive(Clone, Debug, PartialEq)]
pub enum EnvironmentSource {
    /// A constant radiance, W/(m² sr).
    Constant(DVec3),
    /// A panorama.
    File(PathBuf),
}

/// Parses a file, which is known by its extension, or a color.
pub fn parse_environment(text: &str) -> Result<EnvironmentSource, String> {
    if [".exr", ".hdr"].iter().any(|end| text.to_lowercase().ends_with(end)) {
        return Ok(EnvironmentSource::File(text.into()));
    }
    let color = parse_rgb(text).map_err(|e| format!("{e}; or a picture, FILE.exr or FILE.hdr"))?;
    Ok(EnvironmentSource::Constant(DVec3::from_array(color)))
}

impl EnvironmentSource {
    /// Reads the environment, with its radiance multiplied by `scale` and turned about +Y; prints the warnings of the
    /// reader.
    pub fn read(&self, scale: f64, rotation_degrees: f64, common: &Common) -> Result<Environment, Failure> {
        let path = match self {
            EnvironmentSource::Constant(radiance) => return Ok((*radiance * scale).into()),
            EnvironmentSource::File(path) => path,
        };
        check_memory(path)?;
        let picture = Panorama::read(path).map_err(|e| Failure::usage(format!("--environment: {e}")))?;
        picture.warnings.iter().for_each(|w| common.warn(format_args!("--environment: {}: {w}", path.display())));
        let pixels = picture.pixels.into_iter().map(Vec3::from_array).collect();
        let map = EnvironmentMap::new((picture.width, picture.height), pixels, scale, rotation_degrees)
            .map_err(|e| Failure::usage(format!("--environment: {}: {e}", path.display())))?;
        Ok(Environment::Map(Arc::new(map)))
    }
}

/// Refuses a panorama that does not fit into memory, before its pixels are read.
fn check_memory(path: &Path) -> Result<(), Failure> {
    let size = Panorama::size(path).map_err(|e| Failure::usage(format!("--environment: {e}")))?;
    let map = EnvironmentMap::bytes((size.width, size.height));
    let what = format!("--environment: {}: a picture of {} x {} pixels", path.display(), size.width, size.height);
    require_memory(&what, Need { held: size.reading_bytes.max(map), mapped: 0 }, "scale it down")
}

//! Light from all around as it is named on a command line.

use crate::{Failure, parse_rgb};
use formats::Panorama;
use scene::{
    DVec3, Vec3,
    light::{Environment, EnvironmentMap},
};
use std::{path::PathBuf, sync::Arc};

/// What `--environment` is.
#[derive(Clone, Debug, PartialEq)]
pub enum EnvironmentSource {
    /// W/(m² sr).
    Constant(DVec3),
    File(PathBuf),
}

/// A file by the end of its name, else a colour.
pub fn parse_environment(text: &str) -> Result<EnvironmentSource, String> {
    if [".exr", ".hdr"].iter().any(|end| text.to_lowercase().ends_with(end)) {
        return Ok(EnvironmentSource::File(text.into()));
    }
    let color = parse_rgb(text).map_err(|e| format!("{e}; or a picture, FILE.exr or FILE.hdr"))?;
    Ok(EnvironmentSource::Constant(DVec3::from_array(color)))
}

impl EnvironmentSource {
    /// The light, with its radiance multiplied and turned about +Y.
    pub fn read(&self, scale: f64, rotation_degrees: f64) -> Result<Environment, Failure> {
        let path = match self {
            EnvironmentSource::Constant(radiance) => return Ok((*radiance * scale).into()),
            EnvironmentSource::File(path) => path,
        };
        let picture = Panorama::read(path).map_err(|e| Failure::usage(format!("--environment: {e}")))?;
        let pixels = picture.pixels.into_iter().map(Vec3::from_array).collect();
        let map = EnvironmentMap::new((picture.width, picture.height), pixels, scale, rotation_degrees)
            .map_err(|e| Failure::usage(format!("--environment: {}: {e}", path.display())))?;
        Ok(Environment::Map(Arc::new(map)))
    }
}

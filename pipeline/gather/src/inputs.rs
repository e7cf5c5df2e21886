//! The inputs of a run: declared, read, and checked against each other.

use crate::{
    calibrated,
    settings::{CalibrationSource, CameraSource, Request},
};
use cli::{Failure, Files, LitScene, Media, declare_inputs};
use formats::calibration::Calibration;

/// Declares the files that the run reads, as far as the arguments name them.
pub fn declare(request: &Request) -> Result<Files, Failure> {
    let mut files = declare_inputs(&request.clouds, &request.scene, &request.media)?;
    if let CalibrationSource::File(path) = &request.calibration {
        files.reads("--calibration", path)?;
    }
    if let CameraSource::View(path) = &request.camera {
        files.reads("--view", path)?;
    }
    Ok(files)
}

/// Reads all inputs except the samples of the clouds, and the cameras; refuses inputs that do not fit each other.
pub fn read(request: &Request, kept: Option<&Calibration>, files: &mut Files) -> Result<LitScene, Failure> {
    let media = match kept {
        Some(kept) if request.media.is_empty() => Media::Known(calibrated::media(kept)?),
        _ => Media::Named(&request.media),
    };
    let lit = LitScene::read(&request.clouds, &request.scene, media, &request.common, files)?;
    kept.map_or(Ok(()), |kept| calibrated::check_fit(request, &lit, kept))?;
    Ok(lit)
}

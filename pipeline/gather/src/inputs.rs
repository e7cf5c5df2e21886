//! The inputs of a run: declared, read, and checked against each other.

use crate::{
    calibrated,
    image_jobs::ImageJob,
    settings::{CalibrationSource, CameraSource, Request},
    sums_file,
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

/// Declares the images that are continued, with their sums.
pub fn declare_continued(files: &mut Files, request: &Request, jobs: &[ImageJob]) -> Result<(), Failure> {
    for path in jobs.iter().filter_map(|job| Some(job.file(request.continued.as_ref()?))) {
        files.reads("--continue", &path)?;
        files.reads("--continue", &sums_file::path_of(&path))?;
    }
    Ok(())
}

/// Reads all inputs except the samples of the clouds, and the cameras; refuses inputs that do not fit each other.
pub fn read(request: &Request, kept: Option<&Calibration>, files: &mut Files) -> Result<LitScene, Failure> {
    let media = match kept {
        Some(kept) if request.media.is_empty() => Media::Known(calibrated::media(kept)?),
        _ => Media::Named(&request.media),
    };
    let lit = LitScene::read(&request.clouds, &request.scene, media, &request.common, files, request.verbose)?;
    kept.map_or(Ok(()), |kept| calibrated::check_fit(request, &lit, kept))?;
    Ok(lit)
}

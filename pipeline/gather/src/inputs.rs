//! The inputs of a run: declared, read, and checked against each other.

use crate::settings::{CameraSource, Request};
use cli::{Failure, Files, LitScene, declare_inputs};

/// Declares the files that the run reads, as far as the arguments name them.
pub fn declare(request: &Request) -> Result<Files, Failure> {
    let mut files = declare_inputs(&request.clouds, &request.scene, &request.media)?;
    if let CameraSource::View(path) = &request.camera {
        files.reads("--view", path)?;
    }
    Ok(files)
}

/// Reads all inputs except the samples of the clouds, and the cameras; refuses inputs that do not fit each other.
pub fn read(request: &Request, files: &mut Files) -> Result<LitScene, Failure> {
    LitScene::read(&request.clouds, &request.scene, &request.media, &request.common, files)
}

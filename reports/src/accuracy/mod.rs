//! Errors of the models against random walks: `accuracy.md` and its pictures.

mod picture;
mod sphere;
mod tables;

use std::{error::Error, fs, path::Path};

/// Measures, and writes the report into a folder.
pub fn write(folder: &Path) -> Result<(), Box<dyn Error>> {
    let text = tables::document(&picture::spheres(folder)?)?;
    Ok(fs::write(folder.join("accuracy.md"), text)?)
}

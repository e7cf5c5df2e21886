//! `accuracy FOLDER`: what the models are worth, against random walks. Writes `accuracy.md` and its pictures.

mod picture;
mod sphere;
mod tables;

use std::{error::Error, fs, path::Path};

fn main() -> Result<(), Box<dyn Error>> {
    let folder = std::env::args().nth(1).ok_or("usage: accuracy FOLDER")?;
    let folder = Path::new(&folder);
    let text = tables::document(&picture::spheres(folder)?)?;
    fs::write(folder.join("accuracy.md"), text)?;
    Ok(())
}

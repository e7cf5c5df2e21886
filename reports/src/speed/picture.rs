//! Images as lists of numbers.

use crate::error::Error;
use formats::Image;
use std::path::Path;

/// The beauty of an image.
#[derive(Clone, Debug)]
pub struct Picture {
    /// Red, green and blue of each pixel, W/(m² sr).
    pub values: Vec<f64>,
    /// True where the ray through the pixel's center meets something.
    pub object: Vec<bool>,
}

impl Picture {
    /// Reads what `gather` wrote.
    pub fn read(path: &Path) -> Result<Picture, Error> {
        let unreadable = |message: String| Error::Unreadable { path: path.to_owned(), message };
        let bytes = std::fs::read(path).map_err(Error::file(path))?;
        let image = Image::decode(&bytes).map_err(|e| unreadable(e.to_string()))?;
        let plane = |name: &str| image.channel(name).ok_or_else(|| unreadable(format!("no channel {name}")));
        let [r, g, b, z] = [plane("R")?, plane("G")?, plane("B")?, plane("Z")?];
        let pixels = r.iter().zip(g).zip(b);
        let values = pixels.flat_map(|((r, g), b)| [*r, *g, *b].map(f64::from)).collect();
        Ok(Picture { values, object: z.iter().map(|z| *z > 0.0).collect() })
    }
}

//! How large an image is, from its header alone.

use std::fs::File;
use std::io::BufReader;
use std::path::Path;

use super::{Image, ImageError};

/// Unpacked bytes of blocks that reading holds besides the samples.
const BLOCK_BYTES: u64 = 12 << 20;

/// What the header of an OpenEXR file says about its size.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Dimensions {
    /// Pixels per row of the data window.
    pub width: usize,
    /// Rows of the data window.
    pub height: usize,
    /// Channels of all parts.
    pub channels: usize,
    /// Most bytes that [`Image::read`] fills at a time, those of the file included. Each further thread of
    /// [`Image::read_with`] fills 12 MiB or three blocks more.
    pub reading_bytes: u64,
}

impl Image {
    /// Reads the header of an OpenEXR file. That the pixels can be read is not known by it.
    pub fn dimensions(path: &Path) -> Result<Dimensions, ImageError> {
        dimensions(path).map_err(|source| ImageError::File { path: path.to_owned(), source: Box::new(source) })
    }
}

fn dimensions(path: &Path) -> Result<Dimensions, ImageError> {
    let facts = std::fs::metadata(path)?;
    if !facts.is_file() {
        return Err(ImageError::NotAFile);
    }
    let reader = exr::block::read(BufReader::new(File::open(path)?), false);
    let reader = reader.map_err(|error| ImageError::Damaged(error.to_string()))?;
    let parts = reader.headers();
    let first = parts.first().ok_or_else(|| ImageError::Damaged("it has no part".to_owned()))?;
    let channels = parts.iter().map(|part| part.channels.list.len()).sum();
    let (width, height) = (first.layer_size.0, first.layer_size.1);
    let samples = (width as u64).saturating_mul(height as u64).saturating_mul(channels as u64);
    let reading_bytes = samples.saturating_mul(4).saturating_add(facts.len()).saturating_add(BLOCK_BYTES);
    Ok(Dimensions { width, height, channels, reading_bytes })
}

#[cfg(test)]
mod tests {
    use super::super::Channel;
    use super::*;

    #[test]
    fn the_header_tells_the_size() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("image.exr");
        let channel = |name: &str| Channel { name: name.to_owned(), samples: vec![0.0; 35] };
        let image = Image { width: 7, height: 5, channels: ["R", "Z"].map(channel).into(), ..Image::default() };
        std::fs::write(&path, image.encode().unwrap()).unwrap();
        let found = Image::dimensions(&path).unwrap();
        assert_eq!((found.width, found.height, found.channels), (7, 5, 2));
        assert!(found.reading_bytes > 4 * 7 * 5 * 2);
        std::fs::write(&path, "garbage").unwrap();
        assert!(Image::dimensions(&path).unwrap_err().to_string().contains("image.exr"));
        assert!(Image::dimensions(folder.path()).unwrap_err().to_string().contains("not a regular file"));
    }
}

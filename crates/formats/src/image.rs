//! OpenEXR files.
//!
//! Samples are float32 and scene-linear; a channel is one plane, with rows from top to bottom. Channels of a layer
//! share a prefix (`subsurface.R`) and lie in one part, because more readers know layers than know several parts. Which
//! layers and attributes a renderer writes is not known here.

use std::num::NonZeroUsize;
use std::path::Path;

pub(crate) mod decode;
mod encode;
mod header;
pub(crate) mod parallel;
mod types;

pub use decode::Dimensions;
pub use types::{Attribute, Channel, Image, ImageError, Window};

impl Image {
    /// The image as an OpenEXR file: one part, float32, scan lines from top to bottom, ZIP over 16 lines.
    ///
    /// The same image gives the same bytes, whatever the order of its channels.
    pub fn encode(&self) -> Result<Vec<u8>, ImageError> {
        self.encode_with(NonZeroUsize::MIN)
    }

    /// As [`Image::encode`], with the same bytes for any number of threads.
    pub fn encode_with(&self, threads: NonZeroUsize) -> Result<Vec<u8>, ImageError> {
        encode::encode(self, threads)
    }

    /// Reads a flat OpenEXR file: half, float or uint samples; scan lines or tiles, with the largest level of a mip
    /// map; one part, or several with the same data window; uncompressed or by RLE, ZIP, PIZ or PXR24.
    ///
    /// Channels of several parts get the name of their part as layer. Where parts disagree about an attribute, that of
    /// the later part is added as `view of part 2`. A uint that float32 cannot represent is refused.
    pub fn decode(bytes: &[u8]) -> Result<Image, ImageError> {
        Image::decode_with(bytes, NonZeroUsize::MIN)
    }

    /// As [`Image::decode`], with the same result for any number of threads.
    pub fn decode_with(bytes: &[u8], threads: NonZeroUsize) -> Result<Image, ImageError> {
        decode::decode(bytes, threads)
    }

    /// Reads an OpenEXR file as [`Image::decode`] does; errors name the file.
    pub fn read(path: &Path) -> Result<Image, ImageError> {
        let read = || {
            let is_file = std::fs::metadata(path)?.is_file();
            if is_file { Image::decode(&std::fs::read(path)?) } else { Err(ImageError::NotAFile) }
        };
        read().map_err(|e: ImageError| e.of_file(path))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn errors_name_the_file() {
        let folder = tempfile::tempdir().unwrap();
        let message = |path: &Path| Image::read(path).unwrap_err().to_string();
        let missing = folder.path().join("missing.exr");
        assert!(message(&missing).starts_with(&missing.display().to_string()));
        assert!(message(folder.path()).contains("not a regular file"));
        let garbage = folder.path().join("garbage.exr");
        std::fs::write(&garbage, "garbage").unwrap();
        assert!(message(&garbage).contains("not an OpenEXR file"));
    }
}

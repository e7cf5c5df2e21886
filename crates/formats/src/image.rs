//! Images as plain data, and as OpenEXR files.
//!
//! Samples are float32 and scene-linear; a channel is one plane, rows from top to bottom. Layers are
//! channels that share a prefix (`subsurface.R`), all in one part, because more readers group those than
//! understand several parts. Who the layers belong to, and which attributes are expected, is not known here.

use std::collections::BTreeMap;
use std::num::NonZeroUsize;
use std::path::{Path, PathBuf};

pub(crate) mod decode;
mod encode;
mod header;
pub(crate) mod parallel;

pub use decode::Dimensions;

/// Most samples of an image (pixels times channels), both ways: 8 GiB as float32.
const MAX_SAMPLES: u64 = 1 << 31;

/// A value of the header. Standard attributes keep their standard type: `worldToCamera` is a `Matrix`.
#[derive(Clone, Debug, PartialEq)]
pub enum Attribute {
    /// UTF-8 text (`string`).
    Text(String),
    /// `float`.
    Float(f32),
    /// `double`.
    Double(f64),
    /// `int`.
    Int(i32),
    /// Three floats, as of a color (`v3f`).
    Vector([f32; 3]),
    /// Row after row, for points as row vectors: a translation lies in elements 12 to 14 (`m44f`).
    Matrix([f32; 16]),
    /// CIE x and y of red, green, blue and white, in this order (`chromaticities`).
    Chromaticities([f32; 8]),
    /// A list of UTF-8 texts, as of arguments (`stringvector`).
    Texts(Vec<String>),
    /// Any other type, as it lies in the file: `envmap`, `v2f`.
    Other {
        /// Name of the type.
        kind: String,
        /// The bytes of the value, little-endian.
        value: Vec<u8>,
    },
}

/// One plane of samples.
#[derive(Clone, Debug, PartialEq)]
pub struct Channel {
    /// Name with its layer: `R`, `subsurface.R`.
    pub name: String,
    /// `width * height` samples, row after row, top row first.
    pub samples: Vec<f32>,
}

/// An image of any channels.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Image {
    /// Pixels per row.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// In order of name when read; in any order when written.
    pub channels: Vec<Channel>,
    /// Facts about the image, by name. Those that describe the layout of the file are not among them, nor are
    /// `pixelAspectRatio`, `screenWindowCenter` and `screenWindowWidth` with their usual values 1, (0, 0) and 1.
    pub attributes: BTreeMap<String, Attribute>,
    /// Column and row of the top left pixel in the data window.
    pub window: [i32; 2],
    /// The display window, if it is another than the data window: a crop knows of what it is a part.
    pub display: Option<Window>,
}

/// A rectangle of pixels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Window {
    /// Column and row of its top left pixel.
    pub position: [i32; 2],
    /// Columns and rows.
    pub size: [usize; 2],
}

/// Why an image could not be read or written.
#[derive(Debug, thiserror::Error)]
pub enum ImageError {
    /// Any of the others, with the file.
    #[error("{}: {source}", path.display())]
    File {
        /// The image.
        path: PathBuf,
        /// What is wrong with it.
        source: Box<ImageError>,
    },
    /// The operating system refused.
    #[error("cannot be read: {0}")]
    Io(#[from] std::io::Error),
    /// A directory, pipe or device: reading it could wait for ever.
    #[error("cannot be read: not a regular file; give the name of an OpenEXR file")]
    NotAFile,
    /// Another format, or no format.
    #[error("not an OpenEXR file: it does not begin with the bytes 76 2f 31 01")]
    NotOpenExr,
    /// The file contradicts itself or ends early.
    #[error("damaged or truncated OpenEXR file: {0}; make it again")]
    Damaged(String),
    /// A valid file of a kind that is not read here.
    #[error(
        "OpenEXR file of an unsupported kind: {0}; convert it to a flat image of float samples with ZIP compression"
    )]
    Unsupported(String),
    /// More samples than fit, or than the file can hold.
    #[error("{width} x {height} pixels with {channels} channels are more than {limit}")]
    TooLarge {
        /// Pixels per row.
        width: usize,
        /// Rows.
        height: usize,
        /// Channels of all parts.
        channels: usize,
        /// The limit, in words.
        limit: String,
    },
    /// The system has no memory for the samples.
    #[error("not enough memory for {width} x {height} pixels with {channels} channels; make the image smaller")]
    OutOfMemory {
        /// Pixels per row.
        width: usize,
        /// Rows.
        height: usize,
        /// Channels of one part.
        channels: usize,
    },
    /// The image in memory is not one that a file can hold.
    #[error("image cannot be written: {0}")]
    Unwritable(String),
}

impl Image {
    /// The samples of a channel, row after row.
    pub fn channel(&self, name: &str) -> Option<&[f32]> {
        let found = self.channels.iter().find(|channel| channel.name == name)?;
        Some(&found.samples)
    }

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

    /// Reads a flat OpenEXR file: half, float or uint samples, scan lines or tiles (of mip maps the largest),
    /// one part or several of the same data window; no, RLE, ZIP, PIZ or PXR24 compression.
    ///
    /// Channels of several parts get the name of their part as layer; an attribute about which parts disagree is also there
    /// as that of the later one, `view of part 2`. A uint that float32 does not hold (not all
    /// beyond 2^24 are held) is refused.
    pub fn decode(bytes: &[u8]) -> Result<Image, ImageError> {
        Image::decode_with(bytes, NonZeroUsize::MIN)
    }

    /// As [`Image::decode`], with the same result for any number of threads.
    pub fn decode_with(bytes: &[u8], threads: NonZeroUsize) -> Result<Image, ImageError> {
        decode::decode(bytes, threads)
    }

    /// Reads an OpenEXR file as [`Image::decode`] does; errors name the file.
    pub fn read(path: &Path) -> Result<Image, ImageError> {
        Image::read_with(path, NonZeroUsize::MIN)
    }

    /// As [`Image::read`], with the same result for any number of threads.
    ///
    /// Memory: the file, the samples, and 4 MiB or one block for each thread; then the samples alone.
    pub fn read_with(path: &Path, threads: NonZeroUsize) -> Result<Image, ImageError> {
        read_file(path, threads).map_err(|source| ImageError::File { path: path.to_owned(), source: Box::new(source) })
    }
}

fn read_file(path: &Path, threads: NonZeroUsize) -> Result<Image, ImageError> {
    if !std::fs::metadata(path)?.is_file() {
        return Err(ImageError::NotAFile);
    }
    decode::decode(&std::fs::read(path)?, threads)
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

//! An image as plain data, and what can be wrong with one.

use std::{
    collections::BTreeMap,
    path::{Path, PathBuf},
};

/// Most samples (pixels times channels) of an image that is read or written: 8 GiB as float32.
pub(super) const MAX_SAMPLES: u64 = 1 << 31;

/// A value of the header. A standard attribute has its standard type: `worldToCamera` is a `Matrix`.
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
    /// Three floats (`v3f`).
    Vector([f32; 3]),
    /// Row by row, for points as row vectors: elements 12 to 14 are the translation (`m44f`).
    Matrix([f32; 16]),
    /// CIE x and y of red, green, blue and white, in this order (`chromaticities`).
    Chromaticities([f32; 8]),
    /// A list of UTF-8 texts (`stringvector`).
    Texts(Vec<String>),
    /// Any other type, as its bytes in the file: `envmap`, `v2f`.
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
    /// Name with the layer: `R`, `subsurface.R`.
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
    /// Attributes by name, without those that describe the layout of the file, and without `pixelAspectRatio`,
    /// `screenWindowCenter` and `screenWindowWidth` where these have their usual values 1, (0, 0) and 1.
    pub attributes: BTreeMap<String, Attribute>,
    /// Column and row of the top left pixel in the data window.
    pub window: [i32; 2],
    /// The display window, if it differs from the data window, as for a crop.
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
    /// Another error, with the file.
    #[error("{}: {source}", path.display())]
    File {
        /// The image.
        path: PathBuf,
        /// The fault.
        source: Box<ImageError>,
    },
    /// The operating system refused.
    #[error("cannot be read: {0}")]
    Io(#[from] std::io::Error),
    /// A directory, pipe or device, which reading could wait for.
    #[error("cannot be read: not a regular file; give the name of an OpenEXR file")]
    NotAFile,
    /// The file has another format.
    #[error("not an OpenEXR file: it does not begin with the bytes 76 2f 31 01")]
    NotOpenExr,
    /// The file contradicts itself or ends early.
    #[error("damaged or truncated OpenEXR file: {0}; make it again")]
    Damaged(String),
    /// The file is valid, and of a kind that is not supported.
    #[error(
        "OpenEXR file of an unsupported kind: {0}; convert it to a flat image of float samples with ZIP compression"
    )]
    Unsupported(String),
    /// There are more samples than the limit, or than the file can hold.
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
    /// The system has not enough memory for the samples.
    #[error("not enough memory for {width} x {height} pixels with {channels} channels; make the image smaller")]
    OutOfMemory {
        /// Pixels per row.
        width: usize,
        /// Rows.
        height: usize,
        /// Channels of one part.
        channels: usize,
    },
    /// A file cannot hold the image.
    #[error("image cannot be written: {0}")]
    Unwritable(String),
}

impl ImageError {
    pub(super) fn of_file(self, path: &Path) -> ImageError {
        ImageError::File { path: path.to_owned(), source: Box::new(self) }
    }
}

impl Image {
    /// The samples of a channel, row after row.
    pub fn channel(&self, name: &str) -> Option<&[f32]> {
        let found = self.channels.iter().find(|channel| channel.name == name)?;
        Some(&found.samples)
    }
}

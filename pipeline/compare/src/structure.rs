//! Whether two images can be compared.

use formats::image::Image;
use serde::Serialize;

use crate::layer::Layer;
use crate::meaning::{Difference, Meaning, words};

/// The attributes that hold hashes of what an image was made from.
const HASHES: [&str; 2] = ["pcsss/cloud", "pcsss/scene"];

/// One of the hashes in both headers.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Input {
    /// The name of the attribute.
    pub name: &'static str,
    /// Its value in the reference, if it has one.
    pub reference: Option<String>,
    /// Its value in the test image, if it has one.
    pub test: Option<String>,
}

impl Input {
    /// A remark for the reader, unless both images have the same value or none.
    pub(crate) fn note(&self) -> Option<String> {
        let Input { name, reference, test } = self;
        let only = |image| Some(format!("{name} is in the {image} only, so that other inputs would not be noticed"));
        match (reference, test) {
            (Some(reference), Some(test)) if reference != test => {
                Some(format!("{name} differs and is ignored: {reference} in the reference, {test} in the test image"))
            }
            (Some(_), None) => only("reference"),
            (None, Some(_)) => only("test image"),
            (Some(_), Some(_)) | (None, None) => None,
        }
    }
}

/// Why two images cannot be compared. The messages are about the test image.
#[derive(Debug, PartialEq, thiserror::Error)]
pub enum Mismatch {
    /// The images have different resolutions: width and height in pixels.
    #[error("the image has {} x {} pixels, but the reference has {} x {}; render both at one size", test[0], test[1], reference[0], reference[1])]
    Size { reference: [usize; 2], test: [usize; 2] },
    /// The images show different parts of the picture, which begin at these top left pixels.
    #[error(
        "the data window starts at {test:?}, but that of the reference at {reference:?}; render both without cropping"
    )]
    Window { reference: [i32; 2], test: [i32; 2] },
    /// The images have different channels: those of the reference only are missing, those of the test image only are
    /// additional.
    #[error(
        "the image has other channels than the reference (missing: {missing}; additional: {additional}); write both with one version of the renderer"
    )]
    Channels { missing: String, additional: String },
    /// The same numbers mean different pictures.
    #[error(transparent)]
    Meaning(#[from] Difference),
    /// The images were made from different inputs: the attribute of this name has different values.
    #[error("the image was made from other inputs ({name} is {test}, but {reference} in the reference)")]
    Inputs { name: &'static str, reference: String, test: String },
    /// The layer that a gate judges, or that was asked for, does not exist: `present` lists those of both images.
    #[error("there is no layer `{name}`; there are {present}")]
    NoLayer { name: String, present: String },
}

impl Mismatch {
    pub(crate) fn no_layer(name: &str, layers: &[Layer<'_>]) -> Mismatch {
        let present = layers.iter().map(|layer| layer.name.as_str()).collect::<Vec<_>>().join(", ");
        Mismatch::NoLayer { name: name.to_owned(), present }
    }
}

/// The structure that two images must share.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Structure {
    /// Width and height in pixels.
    pub size: [usize; 2],
    /// The top left pixel.
    pub window: [i32; 2],
    /// The names of the channels in alphabetical order.
    pub channels: Vec<String>,
    pub meaning: Meaning,
}

impl Structure {
    pub(crate) fn of(image: &Image) -> Structure {
        let mut channels: Vec<String> = image.channels.iter().map(|channel| channel.name.clone()).collect();
        channels.sort();
        let (size, meaning) = ([image.width, image.height], Meaning::of(image).judged());
        Structure { size, window: image.window, channels, meaning }
    }

    /// Checks whether an image of this structure can be compared with a reference.
    pub(crate) fn check(&self, reference: &Structure) -> Result<(), Mismatch> {
        if self.size != reference.size {
            return Err(Mismatch::Size { reference: reference.size, test: self.size });
        }
        if self.window != reference.window {
            return Err(Mismatch::Window { reference: reference.window, test: self.window });
        }
        if self.channels != reference.channels {
            let only = |names: &[String], others: &[String]| {
                names.iter().filter(|name| !others.contains(name)).map(String::as_str).collect::<Vec<_>>().join(" ")
            };
            let missing = only(&reference.channels, &self.channels);
            return Err(Mismatch::Channels { missing, additional: only(&self.channels, &reference.channels) });
        }
        self.meaning.difference(&reference.meaning).map_or(Ok(()), |difference| Err(difference.into()))
    }
}

/// Checks whether two images can be compared, and returns what the hashes say.
pub(crate) fn check(reference: &Image, test: &Image, ignore_meta: bool) -> Result<Vec<Input>, Mismatch> {
    Structure::of(test).check(&Structure::of(reference))?;
    let inputs = HASHES.map(|name| {
        let value = |image: &Image| image.attributes.get(name).map(words);
        Input { name, reference: value(reference), test: value(test) }
    });
    if !ignore_meta {
        inputs.iter().try_for_each(check_input)?;
    }
    Ok(inputs.into())
}

/// An image without the hash, such as one of another renderer, can be compared with any other.
fn check_input(Input { name, reference, test }: &Input) -> Result<(), Mismatch> {
    match (reference.clone(), test.clone()) {
        (Some(reference), Some(test)) if reference != test => Err(Mismatch::Inputs { name, reference, test }),
        _ => Ok(()),
    }
}

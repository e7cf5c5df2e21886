//! Whether two images can be compared at all.

use std::collections::BTreeSet;

use formats::image::Image;
use serde::Serialize;

use crate::layer::Layer;
use crate::meaning::{Difference, Meaning, words};

/// Hashes that say what an image was made of.
const HASHES: [&str; 2] = ["pcsss/cloud", "pcsss/scene"];

/// What one of the hashes says of both images.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Input {
    /// The attribute.
    pub name: &'static str,
    /// Its value in the reference, if it has one.
    pub reference: Option<String>,
    /// Its value in the test image, if it has one.
    pub test: Option<String>,
}

impl Input {
    /// What a reader should know: nothing if both images have the same value, or none.
    pub(crate) fn note(&self) -> Option<String> {
        let Input { name, reference, test } = self;
        match (reference, test) {
            (Some(reference), Some(test)) if reference != test => {
                Some(format!("{name} differs and is ignored: {reference} in the reference, {test} in the test image"))
            }
            (Some(_), None) => Some(format!("{name} is in the reference only: other inputs would not be noticed")),
            (None, Some(_)) => Some(format!("{name} is in the test image only: other inputs would not be noticed")),
            (Some(_), Some(_)) | (None, None) => None,
        }
    }
}

/// Why two images cannot be compared; said of the test image.
#[derive(Debug, PartialEq, thiserror::Error)]
pub enum Mismatch {
    /// Different resolution.
    #[error("{} x {} pixels, but the reference has {} x {}; render both at one size", test[0], test[1], reference[0], reference[1])]
    Size {
        /// Width and height, pixels.
        reference: [usize; 2],
        /// Width and height, pixels.
        test: [usize; 2],
    },
    /// Different part of the picture.
    #[error("data window starts at {test:?}, but that of the reference at {reference:?}; render both without cropping")]
    Window {
        /// Top left pixel.
        reference: [i32; 2],
        /// Top left pixel.
        test: [i32; 2],
    },
    /// Different channels.
    #[error(
        "other channels than the reference (missing: {missing}; additional: {additional}); write both with one version of the renderer"
    )]
    Channels {
        /// Only in the reference.
        missing: String,
        /// Only in the test image.
        additional: String,
    },
    /// The same numbers would mean another picture.
    #[error("{name} is {test}, but {reference} in the reference, so that equal numbers are not the same; {way_out}")]
    Meaning {
        /// The attribute of the header.
        name: &'static str,
        /// What it says, or means by its absence.
        reference: String,
        /// What it says, or means by its absence.
        test: String,
        /// What to do about it.
        way_out: &'static str,
    },
    /// Different inputs.
    #[error(
        "made from other inputs ({name} is {test}, but {reference} in the reference); give --ignore-meta to compare all the same"
    )]
    Inputs {
        /// The attribute that differs.
        name: &'static str,
        /// Its value.
        reference: String,
        /// Its value.
        test: String,
    },
    /// The gates have nothing to look at.
    #[error("no layer `{name}`; it has {present}; choose with --layer, or in the limits file")]
    NoLayer {
        /// The layer asked for.
        name: String,
        /// Layers of both images.
        present: String,
    },
}

impl Mismatch {
    pub(crate) fn no_layer(name: &str, layers: &[Layer<'_>]) -> Mismatch {
        let present = layers.iter().map(|layer| layer.name.as_str()).collect::<Vec<_>>().join(", ");
        Mismatch::NoLayer { name: name.to_owned(), present }
    }
}

/// What the hashes say, if the images can be compared.
pub(crate) fn check(reference: &Image, test: &Image, ignore_meta: bool) -> Result<Vec<Input>, Mismatch> {
    let sizes = [[reference.width, reference.height], [test.width, test.height]];
    if sizes[0] != sizes[1] {
        return Err(Mismatch::Size { reference: sizes[0], test: sizes[1] });
    }
    if reference.window != test.window {
        return Err(Mismatch::Window { reference: reference.window, test: test.window });
    }
    let names = |image: &Image| image.channels.iter().map(|channel| channel.name.clone()).collect::<BTreeSet<_>>();
    let (expected, found) = (names(reference), names(test));
    if expected != found {
        let list = |names: Vec<&String>| names.into_iter().map(String::as_str).collect::<Vec<_>>().join(" ");
        let missing = list(expected.difference(&found).collect());
        return Err(Mismatch::Channels { missing, additional: list(found.difference(&expected).collect()) });
    }
    if let Some(Difference { name, reference, test, way_out }) = Meaning::of(test).difference(&Meaning::of(reference)) {
        return Err(Mismatch::Meaning { name, reference, test, way_out });
    }
    let inputs = HASHES.map(|name| {
        let value = |image: &Image| image.attributes.get(name).map(words);
        Input { name, reference: value(reference), test: value(test) }
    });
    if !ignore_meta {
        inputs.iter().try_for_each(check_input)?;
    }
    Ok(inputs.into())
}

/// An image without the hash, as of another renderer, can be compared with any.
fn check_input(input: &Input) -> Result<(), Mismatch> {
    match (input.name, &input.reference, &input.test) {
        (name, Some(reference), Some(test)) if reference != test => {
            Err(Mismatch::Inputs { name, reference: reference.clone(), test: test.clone() })
        }
        _ => Ok(()),
    }
}

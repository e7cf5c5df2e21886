//! Whether two images can be compared at all.

use std::collections::BTreeSet;

use formats::image::{Attribute, Image};

/// Hashes that say what an image was made of.
const HASHES: [&str; 2] = ["pcsss/cloud", "pcsss/scene"];

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
    #[error("no layer `{name}`; it has {present}; choose with --layer")]
    NoLayer {
        /// The layer asked for.
        name: String,
        /// Layers of both images.
        present: String,
    },
}

pub(crate) fn check(reference: &Image, test: &Image, ignore_meta: bool) -> Result<(), Mismatch> {
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
    if ignore_meta { Ok(()) } else { check_inputs(reference, test) }
}

/// An image without the hash, as of another renderer, can be compared with any.
fn check_inputs(reference: &Image, test: &Image) -> Result<(), Mismatch> {
    for name in HASHES {
        if let (Some(expected), Some(found)) = (reference.attributes.get(name), test.attributes.get(name))
            && expected != found
        {
            return Err(Mismatch::Inputs { name, reference: show(expected), test: show(found) });
        }
    }
    Ok(())
}

fn show(value: &Attribute) -> String {
    match value {
        Attribute::Text(text) => text.clone(),
        Attribute::Float(_)
        | Attribute::Double(_)
        | Attribute::Int(_)
        | Attribute::Vector(_)
        | Attribute::Matrix(_)
        | Attribute::Chromaticities(_)
        | Attribute::Texts(_) => format!("{value:?}"),
    }
}

//! The report as one HTML file that needs no other: numbers, both images as float32, and the page that shows them.
//!
//! Names, paths and attributes come from files and are not trusted. They reach the page as JSON only (`embed.rs`), and
//! the page shows them as text nodes only; nothing is pasted into markup.

mod color;
mod embed;
mod fit;
mod index;
mod reduce;
mod thumbnail;

use formats::image::Image;
use serde::Serialize;

use crate::report::Report;
use crate::{layer, meaning};
use embed::COMMON;
use fit::LayerData;

pub use index::{IndexError, index};

/// The further scripts of the report, in the order of their use.
const SCRIPT: &str = concat!(
    include_str!("page/data.js"),
    include_str!("page/color.js"),
    include_str!("page/numbers.js"),
    include_str!("page/state.js"),
    include_str!("page/paint.js"),
    include_str!("page/stage.js"),
    include_str!("page/labels.js"),
    include_str!("page/readout.js"),
    include_str!("page/histogram.js"),
    include_str!("page/tables.js"),
    include_str!("page/controls.js"),
    include_str!("page/pointer.js"),
    include_str!("page/keys.js"),
    include_str!("page/page.js"),
);

/// The data of the page about the pixels.
#[derive(Serialize)]
struct Picture<'a> {
    width: usize,
    height: usize,
    /// The column and row of the top left pixel.
    window: [i32; 2],
    layers: &'a [LayerData],
    attributes: Vec<AttributePair<'a>>,
    /// The reductions and omissions, in words.
    notes: Vec<String>,
    colors: color::Maps,
}

/// An attribute of either header, in words.
#[derive(Serialize)]
struct AttributePair<'a> {
    name: &'a str,
    reference: Option<String>,
    test: Option<String>,
}

/// The report on two images as an HTML page. `document` is what the page shows in its tables, with at least the keys of
/// `report`.
///
/// The page is under 100 MB: beyond 2^21 pixels it holds means of blocks of pixels, and if that is still too long,
/// larger blocks of the layers after the first; the page says so. The same input gives the same bytes for any number of
/// threads.
pub fn page(
    document: &impl Serialize,
    report: &Report,
    reference: &Image,
    test: &Image,
) -> Result<Vec<u8>, serde_json::Error> {
    let layers = layer::layers(reference, test);
    let fitted = fit::fit(report, &layers, reference, fit::BUDGET);
    let picture = Picture {
        width: reference.width,
        height: reference.height,
        window: reference.window,
        layers: &fitted.layers,
        attributes: attributes(reference, test),
        notes: fitted.notes,
        colors: color::MAPS,
    };
    let thumbnails = thumbnail::thumbnails(&layers, reference.width, reference.height);
    let mut data = embed::json("report", document)? + &embed::json("thumbnails", &thumbnails)?;
    data += &embed::json("picture", &picture)?;
    let planes = fitted.layers.iter().flat_map(LayerData::planes);
    planes.for_each(|plane| data += &embed::plane(plane));
    Ok(embed::page(include_str!("page/page.html"), &[COMMON, SCRIPT].concat(), &data))
}

/// The attributes of both headers, by name.
fn attributes<'a>(reference: &'a Image, test: &'a Image) -> Vec<AttributePair<'a>> {
    let mut names: Vec<&'a String> = reference.attributes.keys().chain(test.attributes.keys()).collect();
    names.sort_unstable();
    names.dedup();
    let text = |image: &Image, name: &String| image.attributes.get(name).map(meaning::words);
    let pair = |name: &'a String| AttributePair { name, reference: text(reference, name), test: text(test, name) };
    names.into_iter().map(pair).collect()
}

#[cfg(test)]
mod tests;

//! Chooses the samples that the page holds, so that it stays under 100 MB.

use formats::image::Image;
use rayon::prelude::*;
use serde::Serialize;

use super::embed::{self, Plane};
use super::reduce::{Rectangle, block_for, means};
use crate::layer::Layer;
use crate::report::{LayerReport, Report};

/// The largest number of bytes for the text of all planes. The code and the numbers of the page fit into the rest of
/// 100 MB.
pub(super) const BUDGET: usize = 96_000_000;

/// The largest number of pixels of a layer that is embedded pixel by pixel.
pub(super) const FULL: usize = 1 << 21;

/// Half the side of the area around a worst pixel that is embedded pixel by pixel in a reduced layer, in pixels.
const SURROUNDINGS: usize = 32;

/// The largest number of such areas of a layer.
const MAX_SURROUNDINGS: usize = 4;

/// A layer as the page holds it.
#[derive(Clone, Debug, Serialize)]
pub(super) struct LayerData {
    name: String,
    channels: Vec<String>,
    /// The whole image, and, if it is reduced, areas of it pixel by pixel.
    grids: Vec<Grid>,
}

/// An area of a layer, as means over blocks.
#[derive(Clone, Debug, Serialize)]
struct Grid {
    /// The left end, in pixels from that of the image.
    x: usize,
    /// The top end, in pixels from that of the image.
    y: usize,
    /// The number of blocks in a row.
    width: usize,
    /// The number of rows of blocks.
    height: usize,
    /// The side of a block in pixels; a block of one pixel is the pixel itself.
    block: usize,
    /// The numbers of the planes of reference and test for each channel, which are the same if the images have the same
    /// bits.
    planes: Vec<[usize; 2]>,
    #[serde(skip)]
    encoded: Vec<Plane>,
}

/// The samples that the page holds.
pub(super) struct Fitted {
    pub layers: Vec<LayerData>,
    /// The reductions and omissions, in words.
    pub notes: Vec<String>,
}

impl LayerData {
    /// The planes of the layer, each one once.
    pub fn planes(&self) -> impl Iterator<Item = &Plane> {
        self.grids.iter().flat_map(|grid| &grid.encoded)
    }

    fn size(&self) -> usize {
        self.planes().map(|plane| plane.text.len()).sum()
    }

    fn block(&self) -> usize {
        self.grids[0].block
    }

    /// Numbers the planes from `next` on.
    fn number(&mut self, next: &mut usize) {
        for grid in &mut self.grids {
            let first = *next;
            grid.encoded.iter_mut().for_each(|plane| plane.id += first);
            grid.planes.iter_mut().flatten().for_each(|id| *id += first);
            *next += grid.encoded.len();
        }
    }
}

/// Embeds all layers with at most [`FULL`] blocks each. While the text is longer than the budget, the longest layer
/// after the first gets blocks that are twice as wide; if they cannot be wider, the first does; at last the last layer
/// is left out.
pub(super) fn fit(report: &Report, layers: &[Layer<'_>], image: &Image, budget: usize) -> Fitted {
    let encode = |index: usize, block: usize| encode(&layers[index], &report.layers[index], image, block);
    let block = block_for([image.width, image.height], FULL);
    let mut fitted: Vec<LayerData> = (0..layers.len()).map(|index| encode(index, block)).collect();
    while fitted.iter().map(LayerData::size).sum::<usize>() > budget {
        let reducible = |index: &usize| fitted[*index].block() < image.width.max(image.height);
        let longest = (1..fitted.len()).filter(reducible).rev().max_by_key(|index| fitted[*index].size());
        match longest.or_else(|| (0..fitted.len().min(1)).find(reducible)) {
            Some(index) => fitted[index] = encode(index, 2 * fitted[index].block()),
            None => drop(fitted.pop()),
        }
    }
    let mut next = 0;
    fitted.iter_mut().for_each(|layer| layer.number(&mut next));
    let notes = notes(&fitted, layers);
    Fitted { layers: fitted, notes }
}

fn encode(layer: &Layer<'_>, report: &LayerReport, image: &Image, block: usize) -> LayerData {
    let whole = Rectangle { x: 0, y: 0, width: image.width, height: image.height };
    let mut areas = vec![(whole, block)];
    if block > 1 {
        areas.extend(surroundings(report, image).into_iter().map(|area| (area, 1)));
    }
    let grids = areas.into_iter().map(|(area, block)| grid(layer, image.width, area, block)).collect();
    LayerData {
        name: layer.name.clone(),
        channels: layer.channels.iter().map(|(name, _)| name.clone()).collect(),
        grids,
    }
}

/// The areas around the worst pixels of the layer's channels.
fn surroundings(report: &LayerReport, image: &Image) -> Vec<Rectangle> {
    let offset = |pixel: [i64; 2], i: usize| usize::try_from(pixel[i] - i64::from(image.window[i])).unwrap_or(0);
    let pixels = report.channels.iter().map(|channel| channel.metrics.max.pixel);
    let mut areas: Vec<Rectangle> = Vec::new();
    for pixel in pixels.map(|pixel| [offset(pixel, 0), offset(pixel, 1)]) {
        let area = Rectangle::around(pixel, SURROUNDINGS, [image.width, image.height]);
        if !areas.contains(&area) && areas.len() < MAX_SURROUNDINGS {
            areas.push(area);
        }
    }
    areas
}

fn grid(layer: &Layer<'_>, row: usize, area: Rectangle, block: usize) -> Grid {
    let texts: Vec<(String, Option<String>)> = layer
        .samples()
        .par_iter()
        .map(|(reference, test)| {
            let [reference, test] = [reference, test].map(|samples| means(samples, row, area, block));
            let differs = !embed::same_bits(&reference, &test);
            (embed::encode(&reference), differs.then(|| embed::encode(&test)))
        })
        .collect();
    let mut encoded = Vec::new();
    let mut push = |text: String| {
        encoded.push(Plane { id: encoded.len(), text });
        encoded.len() - 1
    };
    let planes = texts.into_iter().map(|(reference, test)| {
        let reference = push(reference);
        [reference, test.map_or(reference, &mut push)]
    });
    let planes = planes.collect();
    let (width, height) = (area.width.div_ceil(block), area.height.div_ceil(block));
    Grid { x: area.x, y: area.y, width, height, block, planes, encoded }
}

fn notes(fitted: &[LayerData], layers: &[Layer<'_>]) -> Vec<String> {
    let mut notes = Vec::new();
    let mut blocks: Vec<usize> = fitted.iter().map(LayerData::block).filter(|block| *block > 1).collect();
    blocks.sort_unstable();
    blocks.dedup();
    for block in blocks {
        let names: Vec<&str> =
            fitted.iter().filter(|layer| layer.block() == block).map(|layer| layer.name.as_str()).collect();
        notes.push(format!(
            "The image is too large to embed whole. The pictures and histograms of {} show means of {block} x {block} \
             pixels; single pixels are shown only around the worst ones. The numbers in the tables are those of the whole image.",
            names.join(", ")
        ));
    }
    let dropped: Vec<&str> = layers.iter().skip(fitted.len()).map(|layer| layer.name.as_str()).collect();
    if !dropped.is_empty() {
        notes.push(format!(
            "These layers are only in the tables, because the page would be too large: {}.",
            dropped.join(", ")
        ));
    }
    notes
}

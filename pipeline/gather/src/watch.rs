//! What is told of a pass while it runs, from all of its threads.

use crate::{crop::Crop, pixel_sum::PixelSum};

/// A listener of a pass.
pub trait Watch: Sync {
    /// A tile has its paths.
    fn done(&self, tile: &Tile);

    /// Whether to stop: tiles that have not begun are left out, and the pass is lost.
    fn stops(&self) -> bool {
        false
    }
}

impl<F: Fn(u64) + Sync> Watch for F {
    fn done(&self, tile: &Tile) {
        self(tile.pixels());
    }
}

/// The pixels of a tile, row by row.
pub struct Tile<'a> {
    /// The part of the image that is rendered.
    pub(crate) part: Crop,
    /// The indices of its pixels in the part, and their sums.
    pub(crate) sums: &'a [(usize, PixelSum)],
    /// The paths that were added to all of them.
    pub paths: u64,
}

impl Tile<'_> {
    /// The number of its pixels.
    pub fn pixels(&self) -> u64 {
        self.sums.len() as u64
    }

    /// Where it lies in the part of the image that is rendered.
    pub fn place(&self) -> Crop {
        let at = |index: usize| (index % self.part.width, index / self.part.width);
        let (first, last) = (self.sums.first(), self.sums.last());
        let [(x, y), (right, lower)] = [first, last].map(|entry| entry.map_or((0, 0), |(index, _)| at(*index)));
        Crop { x, y, width: right + 1 - x, height: lower + 1 - y }
    }

    /// The light of its pixels: red, green and blue of each, W/(m² sr).
    pub fn light(&self) -> Vec<f32> {
        let light = |sum: &PixelSum| sum.light().to_array().map(|x| x as f32);
        self.sums.iter().flat_map(|(_, sums)| light(sums)).collect()
    }
}

//! How bright a texture is over boxes of its coordinates, in a time that does not depend on their size.

use super::contract::channel_sum;
use crate::texture::{Picture, Texture, Wrap};
use glam::{DVec2, DVec3};

/// Most cells along an axis; a larger picture has several texels in a cell.
const MAX_CELLS: usize = 1024;

/// Coordinates beyond this many pictures are not resolved.
const FAR: f64 = 1e6;

/// The brightest texel, as an integer: sums of integers are exact, and 0 only where all is black.
const ONE: f64 = (1u64 << 20) as f64;

/// The sums of the texels of a texture.
pub(super) struct TexelSums {
    /// Texels along each axis, cells along each axis.
    texels: [usize; 2],
    cells: [usize; 2],
    wrap: [Wrap; 2],
    /// The channel sum that [`ONE`] stands for.
    scale: f64,
    /// Sums over all cells to the left of and above a corner, row after row.
    sums: Vec<u64>,
}

impl TexelSums {
    /// The sums of a texture that `color` is multiplied by.
    pub fn new(texture: &Texture, color: DVec3) -> TexelSums {
        let Picture { width, texels } = &*texture.picture;
        let size = [*width, texels.len() / width];
        let cells = size.map(|n| n.min(MAX_CELLS));
        let (stride, scale) = (cells[0] + 1, channel_sum(color));
        let mut sums = vec![0u64; stride * (cells[1] + 1)];
        for (y, row) in texels.chunks_exact(size[0]).enumerate() {
            let base = (cell(y, size[1], cells[1]) + 1) * stride + 1;
            for (x, texel) in row.iter().enumerate() {
                let value = channel_sum(color * Texture::linear(*texel).truncate()) / scale;
                sums[base + cell(x, size[0], cells[0])] += (value * ONE).ceil() as u64;
            }
        }
        for k in stride..sums.len() {
            if k % stride != 0 {
                sums[k] = sums[k] + sums[k - 1] + sums[k - stride] - sums[k - stride - 1];
            }
        }
        TexelSums { texels: size, cells, wrap: texture.wrap, scale, sums }
    }

    /// Cells along each axis.
    pub fn cells(&self) -> DVec2 {
        DVec2::from_array(self.cells.map(|n| n as f64))
    }

    /// An estimate of the mean channel sum between two corners of a box of texture coordinates: the mean of all cells
    /// that a texel there may lie in. It is 0 only if the box is black.
    pub fn mean(&self, low: DVec2, high: DVec2) -> f64 {
        let [(left, right), (top, bottom)] = [0, 1].map(|axis| self.span(axis, low[axis], high[axis]));
        let at = |x: usize, y: usize| self.sums[y * (self.cells[0] + 1) + x];
        let sum = at(right, bottom) + at(left, top) - at(left, bottom) - at(right, top);
        let count = |axis: usize, from: usize, to: usize| self.start(axis, to) - self.start(axis, from);
        let texels = count(0, left, right) * count(1, top, bottom);
        sum as f64 / ONE * self.scale / texels as f64
    }

    /// The first texel of a cell.
    fn start(&self, axis: usize, cell: usize) -> usize {
        (cell * self.texels[axis]).div_ceil(self.cells[axis])
    }

    /// The cells, from the first to one after the last, of all texels that interpolation between these coordinates may
    /// touch; all cells where they wrap around.
    fn span(&self, axis: usize, low: f64, high: f64) -> (usize, usize) {
        let (texels, cells) = (self.texels[axis], self.cells[axis]);
        if !(low > -FAR && high < FAR) {
            return (0, cells);
        }
        // Rounding of the coordinates must not hide a texel.
        let margin = 0.501;
        let count = texels as i64;
        let first = (low * texels as f64 - margin).floor() as i64;
        let last = (high * texels as f64 - 1.0 + margin).ceil() as i64;
        let (first, last) = match self.wrap[axis] {
            Wrap::Clamp => (first.clamp(0, count - 1), last.clamp(0, count - 1)),
            _ if first.div_euclid(count) != last.div_euclid(count) => return (0, cells),
            Wrap::Mirror if first.div_euclid(count) % 2 != 0 => {
                (count - 1 - last.rem_euclid(count), count - 1 - first.rem_euclid(count))
            }
            Wrap::Repeat | Wrap::Mirror => (first.rem_euclid(count), last.rem_euclid(count)),
        };
        (cell(first as usize, texels, cells), cell(last as usize, texels, cells) + 1)
    }
}

/// The cell of a texel.
fn cell(texel: usize, texels: usize, cells: usize) -> usize {
    texel * cells / texels
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::Arc;

    /// Every texel that a point in a box of coordinates may show is counted, whatever the wrap.
    ///
    /// Seen to catch: no margin for interpolation; a mirror that is not turned.
    #[test]
    fn a_box_is_black_only_if_all_of_its_points_are() {
        for wrap in [Wrap::Repeat, Wrap::Mirror, Wrap::Clamp] {
            for bright in 0..35 {
                let texels = (0..35).map(|k| if k == bright { [0, 9, 0, 255] } else { [255, 0, 255, 0] }).collect();
                let picture = Arc::new(Picture { width: 7, texels });
                let texture = Texture { picture, wrap: [wrap; 2], nearest: false };
                let sums = TexelSums::new(&texture, DVec3::Y);
                for k in 0..400 {
                    let low = DVec2::new(f64::from(k % 20) * 0.193 - 1.7, f64::from(k / 20) * 0.217 - 2.1);
                    let size = DVec2::new(0.11, 0.07);
                    let seen = (0..25).any(|p| {
                        let at = low + size * DVec2::new(f64::from(p % 5), f64::from(p / 5)) / 4.0;
                        texture.at(at.to_array()).y > 0.0
                    });
                    let mean = sums.mean(low, low + size);
                    assert!(!seen || mean > 0.0, "{wrap:?} {bright} {low}");
                }
            }
        }
    }

    /// The mean of a whole picture, and that of a part of it.
    #[test]
    fn means_of_known_pictures() {
        let texels = (0..1 << 22).map(|k: u32| if k % 2048 < 1024 { [255; 4] } else { [0; 4] }).collect();
        let picture = Arc::new(Picture { width: 2048, texels });
        let texture = Texture { picture, wrap: [Wrap::Repeat; 2], nearest: true };
        let sums = TexelSums::new(&texture, DVec3::new(1.0, 2.0, 0.0));
        let close = |low: [f64; 2], high: [f64; 2], expected: f64| {
            let mean = sums.mean(low.into(), high.into());
            assert!((mean - expected).abs() < 0.02, "{mean}, not {expected}");
        };
        close([0.1, 0.1], [0.4, 0.2], 3.0);
        close([0.6, 0.1], [0.9, 0.2], 0.0);
        close([0.25, 0.1], [0.75, 0.2], 1.5);
        close([0.6, 0.1], [1.4, 0.2], 1.5);
        close([1e30, f64::NAN], [1e30, 0.0], 1.5);
        assert_eq!(sums.mean(DVec2::new(0.6, 0.1), DVec2::new(0.9, 0.2)), 0.0);
    }
}

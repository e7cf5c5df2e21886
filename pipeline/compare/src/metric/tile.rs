//! Tiles of the picture, which are so small that everything computed from them stays in the processor's cache.
//!
//! A tile is a square of pixels with a margin that is wide enough for every filter. Beyond the edges of the picture the
//! margin repeats the outermost pixels.

/// The side of a tile in pixels.
pub(super) const SIDE: usize = 128;
/// The rows of the margin above and below, which are the largest radius of a filter in pixels.
pub(super) const HALO: usize = 10;
/// The columns of the margin on the left and on the right: the halo, rounded up to whole vectors.
pub(super) const MARGIN: usize = 16;
/// The number of samples from one row to the next.
pub(super) const PITCH: usize = SIDE + 2 * MARGIN;
/// The number of rows with both margins.
pub(super) const ROWS: usize = SIDE + 2 * HALO;

/// The number of samples that are computed together. Loops over arrays of this length become vector instructions; loops
/// over planes do not, because the compiler has to assume that planes overlap.
pub(super) const LANES: usize = 32;

/// One channel of a tile with its margin, row after row.
pub(super) type Plane = [f32; PITCH * ROWS];

/// Planes of zeroes.
pub(super) fn planes<const N: usize>() -> [Box<Plane>; N] {
    std::array::from_fn(|_| Box::new([0.0; PITCH * ROWS]))
}

/// The [`LANES`] samples from an index on.
#[inline(always)]
pub(super) fn lanes(plane: &Plane, at: usize) -> &[f32; LANES] {
    match plane[at..].first_chunk() {
        Some(lanes) => lanes,
        None => unreachable!("no filter reaches beyond the margin"),
    }
}

/// The number of groups of [`LANES`] samples in a tile without its margin.
pub(super) const GROUPS: usize = SIDE * SIDE / LANES;

/// The index of the first sample of a group.
#[inline(always)]
pub(super) fn group(number: usize) -> usize {
    const PER_ROW: usize = SIDE / LANES;
    (HALO + number / PER_ROW) * PITCH + MARGIN + number % PER_ROW * LANES
}

/// The position of a tile in the picture.
#[derive(Clone, Copy, Debug)]
pub(super) struct Tile {
    /// Width and height of the picture in pixels; neither is zero.
    pub picture: [usize; 2],
    /// Column and row of the tile's first pixel.
    pub first: [usize; 2],
}

impl Tile {
    /// The tiles of a band, from left to right; band n begins at row n * [`SIDE`].
    pub fn of_band(picture: [usize; 2], band: usize) -> impl Iterator<Item = Tile> {
        (0..picture[0]).step_by(SIDE).map(move |x| Tile { picture, first: [x, band * SIDE] })
    }

    /// The numbers of columns and rows that lie in the picture, without the margin.
    pub fn size(self) -> [usize; 2] {
        [0, 1].map(|axis| SIDE.min(self.picture[axis] - self.first[axis]))
    }

    /// Fills a plane from a channel of the picture. Negative values, NaN and infinity become 0, because one of them
    /// would spoil the filtered tile.
    pub fn load(self, from: &[f32], to: &mut Plane) {
        let [width, height] = self.picture;
        for (row, line) in to.as_chunks_mut::<PITCH>().0.iter_mut().enumerate() {
            let y = (self.first[1] + row).saturating_sub(HALO).min(height - 1);
            let source = &from[y * width..(y + 1) * width];
            // Column `column` of the tile is column `first + column - MARGIN` of the picture.
            let begin = MARGIN.saturating_sub(self.first[0]);
            let end = PITCH.min(width + MARGIN - self.first[0]);
            let start = self.first[0] + begin - MARGIN;
            line[begin..end].copy_from_slice(&source[start..start + end - begin]);
            line[..begin].fill(source[0]);
            line[end..].fill(source[width - 1]);
            for value in line {
                *value = if value.is_finite() { value.max(0.0) } else { 0.0 };
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn margins_repeat_the_edge_and_inner_tiles_see_their_neighbors() {
        let picture = [300, 150];
        let from: Vec<f32> = (0..picture[0] * picture[1]).map(|i| i as f32).collect();
        let [mut plane] = planes();
        for first in [[0, 0], [SIDE, 0], [2 * SIDE, SIDE]] {
            let tile = Tile { picture, first };
            tile.load(&from, &mut plane);
            for (i, found) in plane.iter().enumerate() {
                let clamped = |at: usize, margin: usize, axis: usize| {
                    (at + first[axis]).saturating_sub(margin).min(picture[axis] - 1)
                };
                let (x, y) = (clamped(i % PITCH, MARGIN, 0), clamped(i / PITCH, HALO, 1));
                assert_eq!(*found, (y * picture[0] + x) as f32, "{first:?} {i}");
            }
        }
        assert_eq!(Tile { picture, first: [2 * SIDE, SIDE] }.size(), [44, 22]);
    }

    #[test]
    fn values_that_are_no_light_are_dark() {
        let [mut plane] = planes();
        let from = [-1.0, f32::NAN, f32::INFINITY, 2.0];
        Tile { picture: [4, 1], first: [0, 0] }.load(&from, &mut plane);
        assert_eq!(plane[MARGIN..MARGIN + 4], [0.0, 0.0, 0.0, 2.0]);
    }
}

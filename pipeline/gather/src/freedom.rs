//! The degrees of freedom of an image's error: how many independent values it is estimated from.
//!
//! The paths of different pixels are independent, but all pixels use the same cloud. The difference between its two
//! halves may be one value that every pixel shows, or as many values as there are pixels. The correlation of the
//! differences tells which: the image is divided into cells, and `ρ(r)` is the mean product of the differences of cells
//! at distance `r`, over the mean product of their lengths. It is near 1 or -1 where the differences are one value, and
//! near zero where they are many. With cells of lengths `s`, `tr C = Σ s²` and `tr C² = Σ Σ ρ² s² s'²` give the degrees
//! of freedom `ν = (tr C)²/tr C²` of the sum of squares (Satterthwaite 1946). Noise in `ρ` makes `ν` too small, never
//! too large.

use scene::DVec3;

/// The largest number of cells on a side of the image.
const MAX_CELLS: usize = 16;

/// Sums of the differences of pixels over the cells of an image.
pub struct Cells {
    /// Width and height of the image, pixels.
    size: [usize; 2],
    sums: Vec<DVec3>,
}

impl Cells {
    /// The cells of an image of this width and height, pixels.
    pub fn new(size: [usize; 2]) -> Cells {
        let [columns, rows] = size.map(|n| n.min(MAX_CELLS));
        Cells { size, sums: vec![DVec3::ZERO; columns * rows] }
    }

    /// Adds the difference between the halves of a pixel, whose index counts row by row.
    pub fn add(&mut self, pixel: usize, difference: DVec3) {
        let [width, height] = self.size;
        let [columns, rows] = self.size.map(|n| n.min(MAX_CELLS));
        let (x, y) = (pixel % width * columns / width, pixel / width * rows / height);
        self.sums[y * columns + x] += difference;
    }

    /// Degrees of freedom of the sum of squares of the differences, at least one.
    pub fn freedom(&self) -> f64 {
        let columns = self.size[0].min(MAX_CELLS);
        let lengths: Vec<f64> = self.sums.iter().map(|v| v.length()).collect();
        let mut shells = vec![Shell::default(); 2 * MAX_CELLS];
        for a in 0..self.sums.len() {
            for b in 0..=a {
                let [dx, dy] = [(a % columns).abs_diff(b % columns), (a / columns).abs_diff(b / columns)];
                let shell = &mut shells[((dx * dx + dy * dy) as f64).sqrt().round() as usize];
                // The double sum contains each pair twice, and a cell with itself once.
                let (count, product) = (if a == b { 1.0 } else { 2.0 }, lengths[a] * lengths[b]);
                shell.products += count * self.sums[a].dot(self.sums[b]);
                shell.lengths += count * product;
                shell.squares += count * product * product;
            }
        }
        let trace: f64 = lengths.iter().map(|s| s * s).sum();
        let squares: f64 = shells.iter().filter(|s| s.lengths > 0.0).map(Shell::shared).sum();
        if squares > 0.0 { (trace * trace / squares).max(1.0) } else { 1.0 }
    }
}

/// Sums over the pairs of cells at one distance.
#[derive(Clone, Copy, Default)]
struct Shell {
    products: f64,
    lengths: f64,
    squares: f64,
}

impl Shell {
    /// The part of these pairs in `tr C²`.
    fn shared(&self) -> f64 {
        (self.products / self.lengths).powi(2) * self.squares
    }
}

/// Degrees of freedom of the sum of two independent variances, each given with its own (Welch 1947).
pub fn of_sum(parts: [(f64, f64); 2]) -> f64 {
    let sum: f64 = parts.iter().map(|(variance, _)| variance).sum();
    let squares: f64 = parts.iter().map(|(variance, freedom)| variance * variance / freedom).sum();
    if squares > 0.0 { (sum * sum / squares).max(1.0) } else { 1.0 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use scene::random::{Purpose, Stream};

    fn freedom(size: [usize; 2], seed: u64, difference: impl Fn(usize, f64) -> f64) -> f64 {
        let stream = Stream::new(seed, Purpose::CutCorrection);
        let mut cells = Cells::new(size);
        for pixel in 0..size[0] * size[1] {
            let normal = (0..12).map(|d| stream.item(pixel as u64).uniform(d)).sum::<f64>() - 6.0;
            cells.add(pixel, DVec3::splat(difference(pixel, normal)));
        }
        cells.freedom()
    }

    /// Differences that are one value, or a slope, have one or two degrees of freedom in an image of any size. Those of
    /// independent pixels have as many as there are cells, less the effect of noise and of the normal distribution.
    ///
    /// Seen to catch: the sum of squares alone; correlations not squared.
    #[test]
    fn a_difference_that_all_pixels_share_is_one_value() {
        for size in [[4, 4], [32, 20]] {
            let one = freedom(size, 1, |_, _| 0.3);
            let slope = freedom(size, 1, |pixel, _| (pixel % size[0]) as f64 - 0.5 * (size[0] - 1) as f64);
            assert!((1.0..1.01).contains(&one) && (1.0..4.0).contains(&slope), "{size:?}: {one}, {slope}");
        }
        let mean = |size| (0..20).map(|seed| freedom(size, seed, |_, normal| normal)).sum::<f64>() / 20.0;
        let (few, many) = (mean([4, 4]), mean([32, 32]));
        assert!((2.0..12.0).contains(&few) && (40.0..200.0).contains(&many), "{few}, {many}");
    }

    #[test]
    fn the_larger_of_two_variances_decides() {
        assert!((of_sum([(1.0, 10.0), (0.0, 1.0)]) - 10.0).abs() < 1e-12);
        assert!((of_sum([(1.0, 10.0), (1.0, 10.0)]) - 20.0).abs() < 1e-12);
        assert!((of_sum([(1.0, 1e6), (1.0, 1.0)]) - 4.0).abs() < 1e-4);
    }
}

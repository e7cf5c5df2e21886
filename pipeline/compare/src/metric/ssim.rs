//! Structural similarity: Wang, Bovik, Sheikh and Simoncelli, *Image quality assessment: from error visibility to
//! structural similarity*, 2004.
//!
//! It is computed of display values with the paper's constants and Gaussian window (standard deviation 1.5 pixels, cut
//! off at 5) and weighted moments, and averaged over the windows that lie in the picture and over the three channels.
//! This is what scikit-image computes with `gaussian_weights=True, use_sample_covariance=False, data_range=1`.

use simd::Kernel;

use super::convolve::{INNER, blur, gaussian};
use super::displayed::{DisplayedMetric, Scratch};
use super::tile::{GROUPS, HALO, LANES, MARGIN, PITCH, Plane, SIDE, Tile, group, lanes};

/// The mean similarity over windows and channels; it is 1 for equal pictures.
pub(super) const METRIC: DisplayedMetric = DisplayedMetric {
    key: "ssim",
    sum: similarity,
    value: |sum, size| match windows(size) {
        Some(windows) => Ok(sum / (3 * windows) as f64),
        None => Err(format!("the picture is smaller than its window of {WINDOW} x {WINDOW} pixels")),
    },
    words: |ssim| format!("SSIM {ssim:.6}"),
};

/// The radius of the window in pixels.
const RADIUS: usize = 5;
/// The side of the window in pixels.
const WINDOW: usize = 2 * RADIUS + 1;
/// C1 and C2 stabilize the quotients where there is no light or no structure; they are the paper's K1 and K2, squared.
const C1: f32 = 0.01 * 0.01;
const C2: f32 = 0.03 * 0.03;

/// The number of windows that lie in a picture, or `None` if none does.
fn windows([width, height]: [usize; 2]) -> Option<usize> {
    let fit = |length: usize| (length + 1).checked_sub(WINDOW).filter(|count| *count > 0);
    Some(fit(width)? * fit(height)?)
}

/// The sum of the similarities over the windows of a tile that lie in the picture.
fn similarity(tile: Tile, scratch: &mut Scratch) -> f64 {
    let taps: Vec<f32> = gaussian(1.5, RADIUS).iter().map(|weight| *weight as f32).collect();
    simd::dispatch(Similarity { scratch, taps: &taps });
    sum(tile, &scratch.work[0])
}

/// Writes the similarity of the window around each pixel into the first plane of `work`.
struct Similarity<'a> {
    scratch: &'a mut Scratch,
    taps: &'a [f32],
}

impl Kernel for Similarity<'_> {
    type Output = ();

    #[inline(always)]
    fn run(self) {
        let Scratch { reference, test, work } = self.scratch;
        let [similarity, product, across, mean_reference, mean_test, mean_squares, mean_product] = work;
        let wanted = (INNER.start - RADIUS) * PITCH..(INNER.end + RADIUS) * PITCH;
        blur(self.taps, self.taps, reference, across, mean_reference);
        blur(self.taps, self.taps, test, across, mean_test);
        for at in wanted.clone() {
            product[at] = reference[at] * reference[at] + test[at] * test[at];
        }
        blur(self.taps, self.taps, product, across, mean_squares);
        for at in wanted {
            product[at] = reference[at] * test[at];
        }
        blur(self.taps, self.taps, product, across, mean_product);
        for at in (0..GROUPS).map(group) {
            let (x, y) = (lanes(mean_reference, at), lanes(mean_test, at));
            let (squares, product) = (lanes(mean_squares, at), lanes(mean_product, at));
            let mut result = [0.0; LANES];
            for i in 0..LANES {
                result[i] = similar([x[i], y[i]], squares[i], product[i]);
            }
            similarity[at..at + LANES].copy_from_slice(&result);
        }
    }
}

/// Equation 13 of the paper, of weighted means.
#[inline(always)]
fn similar([x, y]: [f32; 2], squares: f32, product: f32) -> f32 {
    let (means, covariance) = (x * y, product - x * y);
    let (mean_squares, variances) = (x * x + y * y, squares - (x * x + y * y));
    (2.0 * means + C1) * (2.0 * covariance + C2) / ((mean_squares + C1) * (variances + C2))
}

/// The sum over the windows of the tile that lie in the picture.
fn sum(tile: Tile, similarity: &Plane) -> f64 {
    let [columns, rows] = [0, 1].map(|axis| {
        let begin = RADIUS.saturating_sub(tile.first[axis]);
        let end = (tile.picture[axis] - tile.first[axis]).saturating_sub(RADIUS).min(SIDE);
        begin..end.max(begin)
    });
    let mut sum = 0.0;
    for row in rows {
        let start = (row + HALO) * PITCH + MARGIN;
        sum += similarity[start + columns.start..start + columns.end].iter().copied().map(f64::from).sum::<f64>();
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn windows_must_lie_in_the_picture() {
        assert_eq!(
            [windows([11, 11]), windows([20, 12]), windows([10, 400]), windows([1, 1])],
            [Some(1), Some(20), None, None]
        );
    }

    #[test]
    fn two_numbers_by_hand() {
        // x is 0.2 or 0.6 and y is 0.4: their means are 0.4, their variances 0.04 and 0, and their covariance is 0.
        let found = similar([0.4, 0.4], (0.04 + 0.36) / 2.0 + 0.16, 0.4 * 0.4);
        assert!((found - C2 / (0.04 + C2)).abs() < 1e-6, "{found}");
    }
}

//! Structural similarity: Wang, Bovik, Sheikh and Simoncelli, *Image quality assessment: from error visibility to
//! structural similarity*, 2004.
//!
//! Of display values, with the paper's constants and Gaussian window (standard deviation 1.5 pixels, cut off at 5),
//! weighted moments, the mean over the windows that lie in the picture and over the three channels. This is what
//! scikit-image computes with `gaussian_weights=True, use_sample_covariance=False, data_range=1`.

use simd::Kernel;

use super::convolve::{Along, Even, INNER, convolve, gaussian};
use super::display::display;
use super::tile::{GROUPS, HALO, LANES, MARGIN, PITCH, Plane, SIDE, Tile, group, lanes, plane};

/// Radius of the window, pixels.
const RADIUS: usize = 5;
/// Side of the window, pixels.
pub(super) const WINDOW: usize = 2 * RADIUS + 1;
/// Stabilise the quotients where there is no light or no structure; the paper's K1 and K2, squared.
const C1: f32 = 0.01 * 0.01;
const C2: f32 = 0.03 * 0.03;

/// One channel of a tile.
pub(super) struct Scratch {
    /// Linear light as loaded, then display values.
    pub reference: Box<Plane>,
    pub test: Box<Plane>,
    /// Of the window around each pixel.
    pub similarity: Box<Plane>,
    product: Box<Plane>,
    across: Box<Plane>,
    /// Moments: means of reference, test, the sum of their squares, and their product.
    moments: [Box<Plane>; 4],
}

impl Default for Scratch {
    fn default() -> Scratch {
        let [reference, test, similarity, product, across] = std::array::from_fn(|_| plane());
        Scratch { reference, test, similarity, product, across, moments: std::array::from_fn(|_| plane()) }
    }
}

/// Weights of the window.
pub(super) fn taps() -> Vec<f32> {
    gaussian(1.5, RADIUS).iter().map(|weight| *weight as f32).collect()
}

/// Windows that lie in a picture; None if none does.
pub(super) fn windows([width, height]: [usize; 2]) -> Option<usize> {
    let fit = |length: usize| (length + 1).checked_sub(WINDOW).filter(|count| *count > 0);
    Some(fit(width)? * fit(height)?)
}

/// Turns the loaded planes into display values, and these into similarities.
pub(super) fn compute(scratch: &mut Scratch, taps: &[f32]) {
    simd::dispatch(Compute { scratch, taps });
}

struct Compute<'a> {
    scratch: &'a mut Scratch,
    taps: &'a [f32],
}

impl Kernel for Compute<'_> {
    type Output = ();

    #[inline(always)]
    fn run(self) {
        let Scratch { reference, test, similarity, product, across, moments } = self.scratch;
        let wanted = (INNER.start - RADIUS) * PITCH..(INNER.end + RADIUS) * PITCH;
        show(&mut reference[wanted.clone()]);
        show(&mut test[wanted.clone()]);
        let [mean_reference, mean_test, mean_squares, mean_product] = moments;
        blur(reference, self.taps, across, mean_reference);
        blur(test, self.taps, across, mean_test);
        for at in wanted.clone() {
            product[at] = reference[at] * reference[at] + test[at] * test[at];
        }
        blur(product, self.taps, across, mean_squares);
        for at in wanted {
            product[at] = reference[at] * test[at];
        }
        blur(product, self.taps, across, mean_product);
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

#[inline(always)]
fn show(values: &mut [f32]) {
    for value in values {
        *value = display(*value);
    }
}

#[inline(always)]
fn blur(from: &Plane, taps: &[f32], across: &mut Plane, to: &mut Plane) {
    convolve::<Even>(Along::Rows(RADIUS), taps, from, across);
    convolve::<Even>(Along::Columns, taps, across, to);
}

/// The paper's equation 13, of weighted means.
#[inline(always)]
fn similar([x, y]: [f32; 2], squares: f32, product: f32) -> f32 {
    let (means, covariance) = (x * y, product - x * y);
    let (mean_squares, variances) = (x * x + y * y, squares - (x * x + y * y));
    (2.0 * means + C1) * (2.0 * covariance + C2) / ((mean_squares + C1) * (variances + C2))
}

/// Over the tile's windows that lie in the picture.
pub(super) fn sum(tile: Tile, similarity: &Plane) -> f64 {
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
        // x is 0.2 or 0.6, y is 0.4 or 0.4: means 0.4 and 0.4, variance 0.04 and 0, no covariance.
        let found = similar([0.4, 0.4], (0.04 + 0.36) / 2.0 + 0.16, 0.4 * 0.4);
        assert!((found - C2 / (0.04 + C2)).abs() < 1e-6, "{found}");
    }
}

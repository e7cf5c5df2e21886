//! One-dimensional filters over a tile, along its rows or its columns. One after the other, two make a separable
//! filter.

use std::ops::Range;

use super::tile::{HALO, LANES, MARGIN, PITCH, Plane, ROWS, SIDE, lanes};

/// The direction of a filter.
#[derive(Clone, Copy, Debug)]
pub(super) enum Along {
    /// The filter runs from left to right, over all rows that a following filter of this radius along columns needs.
    Rows(usize),
    /// The filter runs from top to bottom.
    Columns,
}

/// The symmetry of a filter about its middle.
#[derive(Clone, Copy, Debug)]
pub(super) enum Symmetry {
    /// Both sides have the same weights.
    Even,
    /// Both sides have the same weights with opposite signs, and the middle has none.
    Odd,
    /// Both sides have the same weights, and the weight of the middle makes their sum zero. The result is exactly zero
    /// where nothing varies.
    EvenOfSumZero,
}

impl Symmetry {
    /// The value that is multiplied by the tap of a distance.
    #[inline(always)]
    fn pair(self, before: f32, middle: f32, after: f32) -> f32 {
        match self {
            Symmetry::Even => before + after,
            Symmetry::Odd => after - before,
            Symmetry::EvenOfSumZero => (before - middle) + (after - middle),
        }
    }
}

/// The rows of a tile without its margin.
pub(super) const INNER: Range<usize> = HALO..ROWS - HALO;

/// Filters the columns without margin. `taps` are the weights at distance 0, 1, 2, up to [`HALO`] samples.
#[inline(always)]
pub(super) fn convolve(symmetry: Symmetry, along: Along, taps: &[f32], from: &Plane, to: &mut Plane) {
    let (rows, spacing) = match along {
        Along::Rows(radius) => (INNER.start - radius..INNER.end + radius, 1),
        Along::Columns => (INNER, PITCH),
    };
    let middle_tap = if matches!(symmetry, Symmetry::Even) { taps[0] } else { 0.0 };
    for row in rows {
        for block in 0..SIDE / LANES {
            let at = row * PITCH + MARGIN + block * LANES;
            let middle = lanes(from, at);
            let mut sum = [0.0; LANES];
            for i in 0..LANES {
                sum[i] = middle_tap * middle[i];
            }
            for distance in 1..taps.len() {
                let before = lanes(from, at - distance * spacing);
                let after = lanes(from, at + distance * spacing);
                for i in 0..LANES {
                    sum[i] += taps[distance] * symmetry.pair(before[i], middle[i], after[i]);
                }
            }
            to[at..at + LANES].copy_from_slice(&sum);
        }
    }
}

/// Filters the columns without margin by an even filter along both dimensions, whose taps are given for each. `across`
/// is overwritten.
#[inline(always)]
pub(super) fn blur(rows: &[f32], columns: &[f32], from: &Plane, across: &mut Plane, to: &mut Plane) {
    convolve(Symmetry::Even, Along::Rows(columns.len() - 1), rows, from, across);
    convolve(Symmetry::Even, Along::Columns, columns, across, to);
}

/// The weights of a Gaussian with a standard deviation of `sigma` pixels, from the middle to `radius`. With both sides
/// they sum to 1.
pub(super) fn gaussian(sigma: f64, radius: usize) -> Vec<f64> {
    let weight = |distance: usize| (-0.5 * (distance as f64 / sigma).powi(2)).exp();
    let weights: Vec<f64> = (0..=radius).map(weight).collect();
    let sum = 2.0 * weights.iter().sum::<f64>() - weights[0];
    weights.iter().map(|weight| weight / sum).collect()
}

#[cfg(test)]
mod tests {
    use super::super::tile::planes;
    use super::*;

    /// A plane whose samples are a polynomial of column x and row y, counted without the margin.
    fn polynomial(of: impl Fn(f32, f32) -> f32) -> Box<Plane> {
        let [mut plane] = planes();
        for (i, sample) in plane.iter_mut().enumerate() {
            *sample = of((i % PITCH) as f32 - MARGIN as f32, (i / PITCH) as f32 - HALO as f32);
        }
        plane
    }

    fn check(
        symmetry: Symmetry,
        along: Along,
        taps: &[f32],
        of: impl Fn(f32, f32) -> f32,
        expected: impl Fn(f32, f32) -> f32,
    ) {
        let [mut to] = planes();
        convolve(symmetry, along, taps, &polynomial(of), &mut to);
        for (x, y) in [(0, 0), (SIDE - 1, 5), (70, SIDE - 1)] {
            let found = to[(y + HALO) * PITCH + MARGIN + x];
            assert_eq!(found, expected(x as f32, y as f32), "{x} {y}");
        }
    }

    #[test]
    fn polynomials_on_paper() {
        // f(x-1) + 2 f(x) + f(x+1) of x^2 + y is 4 x^2 + 2 + 4 y.
        check(Symmetry::Even, Along::Rows(0), &[2.0, 1.0], |x, y| x * x + y, |x, y| 4.0 * x * x + 2.0 + 4.0 * y);
        check(Symmetry::Even, Along::Columns, &[0.0, 0.0, 1.0], |x, y| x + y * y, |x, y| 2.0 * x + 2.0 * y * y + 8.0);
        // f(y+3) - f(y-3) of y^2 is 12 y.
        check(Symmetry::Odd, Along::Columns, &[7.0, 0.0, 0.0, 1.0], |_, y| y * y, |_, y| 12.0 * y);
        // f(x-2) - 2 f(x) + f(x+2) of x^2 is 8.
        check(Symmetry::EvenOfSumZero, Along::Rows(0), &[9.0, 0.0, 1.0], |x, _| x * x, |_, _| 8.0);
    }

    #[test]
    fn gaussian_weights_sum_to_one() {
        let weights = gaussian(1.5, 5);
        assert!((weights[0] + 2.0 * weights[1..].iter().sum::<f64>() - 1.0).abs() < 1e-15);
        assert!((weights[3] / weights[0] - (-2.0f64).exp()).abs() < 1e-15);
    }
}

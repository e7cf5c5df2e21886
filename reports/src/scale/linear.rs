//! Fits of sums of several parts, each proportional to something known.

/// `y = Σ coefficient x`, with no coefficient negative.
#[derive(Clone, Debug, PartialEq)]
pub struct Linear {
    pub coefficients: Vec<f64>,
}

impl Linear {
    /// Least squares of the relative errors of the points `(x, y)`, with `y` positive, over coefficients that are not
    /// negative, by coordinate descent, which always converges here.
    pub fn fit(points: &[(Vec<f64>, f64)]) -> Linear {
        let rows: Vec<Vec<f64>> = points.iter().map(|(x, y)| x.iter().map(|x| x / y).collect()).collect();
        let parts = rows.first().map_or(0, Vec::len);
        let squares: Vec<f64> = (0..parts).map(|k| rows.iter().map(|row| row[k] * row[k]).sum()).collect();
        let mut coefficients = vec![0.0; parts];
        let mut left = vec![1.0; rows.len()];
        for _ in 0..SWEEPS {
            for k in (0..parts).filter(|k| squares[*k] > 0.0) {
                let step: f64 = rows.iter().zip(&left).map(|(row, left)| row[k] * left).sum::<f64>() / squares[k];
                let step = step.max(-coefficients[k]);
                coefficients[k] += step;
                rows.iter().zip(&mut left).for_each(|(row, left)| *left -= step * row[k]);
            }
        }
        Linear { coefficients }
    }

    pub fn at(&self, x: &[f64]) -> f64 {
        self.coefficients.iter().zip(x).map(|(c, x)| c * x).sum()
    }
}

/// Coordinate descent of half a dozen coefficients settles within thousands of sweeps.
const SWEEPS: usize = 100_000;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_are_found_again_and_none_is_negative() {
        let points =
            |y: fn(f64) -> f64| [1.0, 10.0, 100.0, 1000.0].map(|x: f64| (vec![1.0, x, x * x.ln()], y(x))).to_vec();
        let found = Linear::fit(&points(|x| 3.0 + 0.5 * x + 0.25 * x * x.ln()));
        for (c, wanted) in found.coefficients.iter().zip([3.0, 0.5, 0.25]) {
            assert!((c - wanted).abs() < 1e-6, "{found:?}");
        }
        assert!((found.at(&[1.0, 2.0, 4.0]) - 5.0).abs() < 1e-5);
        let falling = Linear::fit(&points(|x| 5.0 + x - 1e-4 * x * x));
        assert!(falling.coefficients.iter().all(|c| *c >= 0.0), "{falling:?}");
    }
}

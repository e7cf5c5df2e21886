//! Tables over the cosine of a direction and over roughness, and integrals over the cosine.

/// Intervals between the cosines of a table, whose square roots are evenly spaced: albedos vary most near grazing.
const COSINES: usize = 64;

/// Numbers at the cosines of a table, from 0 to 1, linear in the root of the cosine.
#[derive(Clone, Debug)]
pub(crate) struct Row([f64; COSINES + 1]);

impl Row {
    /// The rows of several functions of the cosine that are computed together.
    pub fn of<const N: usize>(values: impl Fn(f64) -> [f64; N]) -> [Row; N] {
        let mut rows = [const { Row([0.0; COSINES + 1]) }; N];
        for k in 0..=COSINES {
            let root = (k as f64 / COSINES as f64).max(1e-3);
            rows.iter_mut().zip(values(root * root)).for_each(|(row, x)| row.0[k] = x);
        }
        rows
    }

    pub fn at(&self, cosine: f64) -> f64 {
        let x = cosine.clamp(0.0, 1.0).sqrt() * COSINES as f64;
        let k = (x as usize).min(COSINES - 1);
        self.0[k] + (self.0[k + 1] - self.0[k]) * (x - k as f64)
    }

    /// The largest number of the row.
    pub fn largest(&self) -> f64 {
        self.0.iter().copied().fold(0.0, f64::max)
    }

    /// `2 ∫ f(μ) μ dμ`, the mean over directions of diffuse light: exact for what [`Row::at`] returns.
    pub fn mean(&self) -> f64 {
        // With x = √μ it is ∫ 4 x³ f dx, and f is linear in each interval.
        let width = 1.0 / COSINES as f64;
        let interval = |k: usize| {
            let (a, b) = (k as f64 * width, (k + 1) as f64 * width);
            let slope = (self.0[k + 1] - self.0[k]) / width;
            let constant = self.0[k] - slope * a;
            constant * (b.powi(4) - a.powi(4)) + 0.8 * slope * (b.powi(5) - a.powi(5))
        };
        (0..COSINES).map(interval).sum()
    }
}

/// The two entries around a roughness of a list from 0 to 1, and the weight of the second.
pub(crate) fn around(roughness: f64, intervals: usize) -> (usize, f64) {
    let x = roughness.clamp(0.0, 1.0) * intervals as f64;
    let k = (x as usize).min(intervals - 1);
    (k, x - k as f64)
}

pub(crate) fn lerp(a: f64, b: f64, t: f64) -> f64 {
    a + (b - a) * t
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn means_of_powers_of_the_root() {
        let [one, root] = Row::of(|cosine| [1.0, cosine.sqrt()]);
        assert!((one.mean() - 1.0).abs() < 1e-14);
        assert!((root.mean() - 0.8).abs() < 1e-8);
        assert!((root.at(0.36) - 0.6).abs() < 1e-12);
    }
}

//! Confidence intervals of errors that were estimated from few independent values.
//!
//! An error that is estimated from few values may be small by chance, and a program that stops at the first small one
//! favors that chance. Student's distribution says by how much the interval that contains the true value in 95 of 100
//! cases must be wider.

/// Pairs `(ν, t)`: Student's t with `ν` degrees of freedom lies outside `±t` in 5 of 100 cases.
const QUANTILES: [(f64, f64); 14] = [
    (1.0, 12.7062),
    (1.5, 6.0167),
    (2.0, 4.3027),
    (3.0, 3.1824),
    (4.0, 2.7764),
    (5.0, 2.5706),
    (7.0, 2.3646),
    (10.0, 2.2281),
    (15.0, 2.1314),
    (20.0, 2.0860),
    (30.0, 2.0423),
    (60.0, 2.0003),
    (120.0, 1.9799),
    (f64::INFINITY, 1.959_964),
];

/// The `t` such that Student's t with `freedom` degrees of freedom, of which there is at least one, lies outside `±t`
/// in 5 of 100 cases. Between the entries of the table, `ln t` is interpolated linearly in `1/ν`, which is at most 2 %
/// too large and never too small.
pub fn student(freedom: f64) -> f64 {
    // NaN counts as one degree of freedom.
    let inverse = if freedom > 1.0 { 1.0 / freedom } else { 1.0 };
    let above = QUANTILES.partition_point(|(freedom, _)| 1.0 / freedom > inverse).clamp(1, QUANTILES.len() - 1);
    let [(a, low), (b, high)] = [QUANTILES[above - 1], QUANTILES[above]].map(|(f, t)| (1.0 / f, f64::ln(t)));
    (low + (high - low) * (inverse - a) / (b - a)).exp()
}

/// A relative standard error that was estimated, and how well it is known.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Estimate {
    pub error: f64,
    /// Degrees of freedom of the estimate: the number of independent values, less one for their mean.
    pub freedom: f64,
}

impl Estimate {
    /// The bound of the relative error with 95 % confidence.
    pub fn within(&self) -> f64 {
        self.error * student(self.freedom)
    }

    /// The standard error that, known exactly, would have the same interval. Compared with a target, it makes an error
    /// above twice the target as rare as it is for a known standard error.
    pub fn safe(&self) -> f64 {
        self.within() / student(f64::INFINITY)
    }
}

/// A relative error in percent, with two significant digits where two decimals would show 0.
pub fn percent(error: f64) -> String {
    if error == 0.0 || error >= 1e-4 { format!("{:.2} %", 100.0 * error) } else { format!("{:.1e} %", 100.0 * error) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn few_values_make_wide_intervals() {
        for (freedom, t) in [(1.0, 12.7062), (2.5, 3.5747), (8.5, 2.2826), (45.0, 2.0141), (1e9, 1.959_964)] {
            let found = student(freedom);
            assert!(found > 0.999_99 * t && found < 1.03 * t, "{freedom}: {found} for {t}");
        }
        assert_eq!([f64::NAN, 0.5, -1.0].map(student), [student(1.0); 3]);
        let one = Estimate { error: 0.01, freedom: 1.0 };
        assert!((one.within() - 0.127_062).abs() < 1e-9 && (one.safe() - 0.064_83).abs() < 1e-5);
        assert_eq!((percent(0.0123), percent(1.23e-6)), ("1.23 %".into(), "1.2e-4 %".into()));
    }
}

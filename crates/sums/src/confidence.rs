//! What an estimated standard error is worth, by how many independent values it was estimated from.
//!
//! An error that is estimated from few values may be small by luck, and whoever stops at the first small one is lucky
//! often. Student's law says how much wider the interval must be that holds the true value in 95 of 100 cases.

/// `(ν, t)`: Student's t of `ν` degrees of freedom is beyond `±t` in 5 of 100 cases.
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

/// The t that Student's t of `freedom` degrees of freedom, at least one, is beyond in 5 of 100 cases, either way. Between
/// the values of the table its logarithm is taken as linear in `1/ν`, which is at most 2 % too large and never too small.
pub fn student(freedom: f64) -> f64 {
    // NaN counts as the least that is possible.
    let inverse = if freedom > 1.0 { 1.0 / freedom } else { 1.0 };
    let place = QUANTILES.partition_point(|(freedom, _)| 1.0 / freedom > inverse).clamp(1, QUANTILES.len() - 1);
    let [(a, low), (b, high)] = [QUANTILES[place - 1], QUANTILES[place]].map(|(f, t)| (1.0 / f, f64::ln(t)));
    (low + (high - low) * (inverse - a) / (b - a)).exp()
}

/// A standard error, relative to what it is the error of, and what is known of it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Estimate {
    /// Estimated relative standard error.
    pub error: f64,
    /// Degrees of freedom that it was estimated with: independent values, less their mean.
    pub freedom: f64,
}

impl Estimate {
    /// The relative error is below this with 95 % confidence.
    pub fn within(&self) -> f64 {
        self.error * student(self.freedom)
    }

    /// The standard error that would have this interval were it known exactly: what a target is compared with, so that an
    /// error beyond twice the target is as rare as it is for a known one.
    pub fn safe(&self) -> f64 {
        self.within() / student(f64::INFINITY)
    }
}

/// A relative error in per cent; a small one is not said to be zero.
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

//! Tests of means whose error is estimated from the scatter of independent runs: the deviation in standard errors
//! follows the distribution of Student, since the error is estimated too.

use crate::significance;
use compare::distribution::student_two_sided;

/// Mean of independent runs, and its error.
#[derive(Clone, Copy, Debug)]
pub struct Estimate {
    pub mean: f64,
    /// Standard error of the mean.
    pub error: f64,
    /// Degrees of freedom of the estimated error.
    pub freedom: f64,
}

impl Estimate {
    /// The mean of independent, equally distributed runs.
    pub fn of(runs: &[f64]) -> Estimate {
        let n = runs.len() as f64;
        assert!(n >= 2.0, "one run has no scatter");
        let mean = runs.iter().sum::<f64>() / n;
        let scatter: f64 = runs.iter().map(|x| (x - mean) * (x - mean)).sum();
        Estimate { mean, error: (scatter / (n * (n - 1.0))).sqrt(), freedom: n - 1.0 }
    }

    /// The difference of two independent estimates (Welch 1947).
    pub fn minus(self, other: Estimate) -> Estimate {
        let (a, b) = (self.error * self.error, other.error * other.error);
        let freedom = (a + b) * (a + b) / (a * a / self.freedom + b * b / other.freedom);
        Estimate { mean: self.mean - other.mean, error: (a + b).sqrt(), freedom }
    }

    /// The sum of two independent estimates.
    pub fn plus(self, other: Estimate) -> Estimate {
        self.minus(other.scaled(-1.0))
    }

    /// The estimate times a constant.
    pub fn scaled(self, factor: f64) -> Estimate {
        Estimate { mean: self.mean * factor, error: self.error * factor.abs(), ..self }
    }

    /// Number of standard errors by which the mean exceeds `expected`.
    pub fn deviation(self, expected: f64) -> f64 {
        (self.mean - expected) / self.error
    }

    /// Standard error relative to the mean.
    pub fn relative_error(self) -> f64 {
        (self.error / self.mean).abs()
    }

    /// Probability of a mean as far from `expected`, or farther.
    pub fn p_value(self, expected: f64) -> f64 {
        student_two_sided(self.deviation(expected), self.freedom)
    }
}

/// Fails if the mean is farther from `expected` than the common significance level allows.
pub fn assert_mean(what: &str, estimate: Estimate, expected: f64) {
    let (z, p) = (estimate.deviation(expected), estimate.p_value(expected));
    println!("{what}: {:.5e} ± {:.1e} for {expected:.5e}, z = {z:.2}", estimate.mean, estimate.error);
    assert!(p >= significance(), "{what}: {estimate:?} is not {expected}: z = {z:.2}, p = {p:.2e}");
}

/// Fails if two independent means differ by more than that level allows; reports their ratio.
pub fn assert_equal(what: &str, a: Estimate, b: Estimate) {
    let difference = a.minus(b).scaled(1.0 / b.mean);
    assert_mean(what, Estimate { mean: 1.0 + difference.mean, ..difference }, 1.0);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn mean_and_error_of_four_runs() {
        let estimate = Estimate::of(&[1.0, 2.0, 3.0, 6.0]);
        assert_eq!((estimate.mean, estimate.freedom), (3.0, 3.0));
        // Σ(x − 3)² = 14; 14/(4·3)
        assert!((estimate.error - (14.0f64 / 12.0).sqrt()).abs() < 1e-15);
        let doubled = estimate.plus(estimate);
        assert!((doubled.mean - 6.0).abs() < 1e-15 && (doubled.freedom - 6.0).abs() < 1e-12);
    }
}

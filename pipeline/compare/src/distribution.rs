//! Student's and Fisher's distributions by the regularized incomplete beta function.

use std::f64::consts::TAU;

/// The probability that Student's t with `freedom` degrees of freedom is as far from zero as `t`, or farther.
pub fn student_two_sided(t: f64, freedom: f64) -> f64 {
    incomplete_beta(0.5 * freedom, 0.5, freedom / (freedom + t * t))
}

/// The probability that Student's t is `t` or more.
pub fn student_upper(t: f64, freedom: f64) -> f64 {
    let half = 0.5 * student_two_sided(t, freedom);
    if t > 0.0 { half } else { 1.0 - half }
}

/// The t of at least zero that is exceeded with the probability `upper`, which is at most one half.
pub fn student_quantile(upper: f64, freedom: f64) -> f64 {
    bisect(|t| student_upper(t, freedom) > upper)
}

/// The probability that the ratio of two estimates of the same variance is `ratio` or more. `numerator` and
/// `denominator` are their degrees of freedom.
pub fn fisher_upper(ratio: f64, numerator: f64, denominator: f64) -> f64 {
    incomplete_beta(0.5 * denominator, 0.5 * numerator, denominator / (denominator + numerator * ratio))
}

/// The ratio of variances that is exceeded with the probability `upper`.
pub fn fisher_quantile(upper: f64, numerator: f64, denominator: f64) -> f64 {
    bisect(|ratio| fisher_upper(ratio, numerator, denominator) > upper)
}

/// The number between 0 and 1e9 where `below` turns from true to false. Bisection by the geometric mean keeps all
/// digits of small numbers.
fn bisect(below: impl Fn(f64) -> bool) -> f64 {
    let (mut low, mut high) = (1e-9_f64, 1e9_f64);
    // A range of e^42, halved 100 times, is below the last digit of a float64.
    for _ in 0..100 {
        let middle = (low * high).sqrt();
        *(if below(middle) { &mut low } else { &mut high }) = middle;
    }
    low
}

/// The regularized incomplete beta function `I_x(a, b)` by its continued fraction (Lentz's method).
pub fn incomplete_beta(a: f64, b: f64, x: f64) -> f64 {
    if x <= 0.0 || x >= 1.0 {
        return if x <= 0.0 { 0.0 } else { 1.0 };
    }
    if x > (a + 1.0) / (a + b + 2.0) {
        return 1.0 - incomplete_beta(b, a, 1.0 - x);
    }
    let front = (a * x.ln() + b * (1.0 - x).ln() + ln_gamma(a + b) - ln_gamma(a) - ln_gamma(b)).exp() / a;
    let (mut c, mut d) = (1.0, 1.0 / (1.0 - (a + b) * x / (a + 1.0)));
    let mut fraction = d;
    for m in 1..10_000 {
        let m = f64::from(m);
        let even = m * (b - m) * x / ((a + 2.0 * m - 1.0) * (a + 2.0 * m));
        let odd = -(a + m) * (a + b + m) * x / ((a + 2.0 * m) * (a + 2.0 * m + 1.0));
        for numerator in [even, odd] {
            d = 1.0 / (1.0 + numerator * d);
            c = 1.0 + numerator / c;
            fraction *= c * d;
        }
        if (c * d - 1.0).abs() < 1e-15 {
            break;
        }
    }
    front * fraction
}

/// `ln Γ(x)` for `x > 0` by Stirling's series after a shift to `x ≥ 10`.
pub fn ln_gamma(x: f64) -> f64 {
    let (mut x, mut shift) = (x, 0.0);
    while x < 10.0 {
        shift += x.ln();
        x += 1.0;
    }
    let series = 1.0 / (12.0 * x) - 1.0 / (360.0 * x.powi(3)) + 1.0 / (1260.0 * x.powi(5));
    (x - 0.5) * x.ln() - x + 0.5 * TAU.ln() + series - shift
}

#[cfg(test)]
mod tests {
    use super::*;

    #[track_caller]
    fn close(found: f64, expected: f64, tolerance: f64) {
        assert!((found / expected - 1.0).abs() < tolerance, "{found} is not {expected}");
    }

    /// The tolerances are the digits of the tables.
    #[test]
    fn tails_have_their_textbook_values() {
        for (freedom, t, p) in [(1.0, 12.706_2, 0.05), (15.0, 2.131_45, 0.05), (15.0, 4.072_77, 0.001)] {
            close(student_two_sided(t, freedom), p, 1e-4);
            close(student_quantile(0.5 * p, freedom), t, 1e-5);
            close(student_upper(t, freedom) + student_upper(-t, freedom), 1.0, 1e-12);
        }
        // With two degrees of freedom of the numerator, the tail has the closed form (1 + 2 F/n)^(-n/2).
        close(fisher_upper(4.256_5, 2.0, 9.0), (1.0f64 + 2.0 * 4.256_5 / 9.0).powf(-4.5), 1e-9);
        close(fisher_quantile(0.05, 2.0, 9.0), 4.256_5, 1e-5);
        close(ln_gamma(5.0), 24f64.ln(), 1e-9);
    }

    /// Student's t squared has Fisher's distribution with one degree of freedom of the numerator. With one degree of
    /// freedom, t has Cauchy's distribution: the probability of |t| > x is 2 atan(1/x)/π.
    #[test]
    fn the_distributions_agree_far_out() {
        for t in [3.0, 6.0, 12.0] {
            close(student_two_sided(t, 70.0), fisher_upper(t * t, 1.0, 70.0), 1e-9);
            close(student_two_sided(t, 1.0), 2.0 * (1.0 / t).atan() / std::f64::consts::PI, 1e-8);
        }
    }
}

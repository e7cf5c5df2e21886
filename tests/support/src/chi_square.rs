//! Tests whether a sampler follows its density: Pearson's chi-square test.

use crate::significance;
use compare::distribution::ln_gamma;

/// Cells with a smaller expected count are pooled: below it the statistic does not follow the chi-square
/// distribution.
const MIN_EXPECTED: f64 = 8.0;

/// Fails if the counts differ from the expected ones by more than the common significance level allows.
pub fn assert_fits(what: &str, observed: &[u64], expected: &[f64]) {
    let p = p_value(observed, expected);
    println!("{what}: p = {p:.4}");
    assert!(p >= significance(), "{what}: the counts do not follow the density, p = {p:.2e}");
}

/// Probability of counts as far from the expected ones, or farther; zero if a count is positive where none is
/// expected.
pub fn p_value(observed: &[u64], expected: &[f64]) -> f64 {
    assert_eq!(observed.len(), expected.len());
    let total: u64 = observed.iter().sum();
    let expected_total: f64 = expected.iter().sum();
    assert!((expected_total / total as f64 - 1.0).abs() < 1e-6, "{expected_total} expected in all, {total} observed");
    if observed.iter().zip(expected).any(|(o, e)| *e == 0.0 && *o > 0) {
        return 0.0;
    }
    let cells = pool(observed, expected);
    let statistic: f64 = cells.iter().map(|(o, e)| (o - e) * (o - e) / e).sum();
    let freedom = (cells.len() - 1) as f64;
    upper_gamma(0.5 * freedom, 0.5 * statistic)
}

/// Joins neighboring cells until each expects enough.
fn pool(observed: &[u64], expected: &[f64]) -> Vec<(f64, f64)> {
    let mut cells: Vec<(f64, f64)> = Vec::new();
    let mut open = (0.0, 0.0);
    for (o, e) in observed.iter().zip(expected) {
        open = (open.0 + *o as f64, open.1 + e);
        if open.1 >= MIN_EXPECTED {
            cells.push(std::mem::take(&mut open));
        }
    }
    if let Some(last) = cells.last_mut() {
        *last = (last.0 + open.0, last.1 + open.1);
    }
    assert!(cells.len() > 1, "too few counts to judge");
    cells
}

/// `Γ(a, x)/Γ(a)`: the power series of its complement below `a + 1`, else the continued fraction (Lentz's method).
pub fn upper_gamma(a: f64, x: f64) -> f64 {
    if x <= 0.0 {
        return 1.0;
    }
    let factor = (a * x.ln() - x - ln_gamma(a)).exp();
    if x < a + 1.0 {
        let (mut term, mut sum) = (1.0 / a, 1.0 / a);
        let mut n = a;
        while term > sum * 1e-16 {
            n += 1.0;
            term *= x / n;
            sum += term;
        }
        return 1.0 - factor * sum;
    }
    let mut b = x + 1.0 - a;
    let (mut c, mut d) = (1e300, 1.0 / b);
    let mut fraction = d;
    for k in 1..10_000 {
        let k = f64::from(k);
        b += 2.0;
        let numerator = -k * (k - a);
        d = 1.0 / (numerator * d + b);
        c = b + numerator / c;
        fraction *= c * d;
        if (c * d - 1.0).abs() < 1e-15 {
            break;
        }
    }
    factor * fraction
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tails_have_their_textbook_values() {
        // Quantiles of the chi-square distribution at 5 % and 0.1 %.
        for (freedom, at, p) in [(1.0, 3.841_459, 0.05), (10.0, 18.307_04, 0.05), (100.0, 149.449_25, 0.001)] {
            assert!((upper_gamma(0.5 * freedom, 0.5 * at) / p - 1.0).abs() < 1e-5, "{freedom}");
        }
    }

    #[test]
    fn a_wrong_density_is_found_and_the_right_one_is_not() {
        assert!(p_value(&[1020, 980, 1010, 990], &[1000.0; 4]) > 0.5);
        assert!(p_value(&[1200, 800, 1000, 1000], &[1000.0; 4]) < 1e-6);
        assert_eq!(p_value(&[1, 1999], &[0.0, 2000.0]), 0.0);
    }
}

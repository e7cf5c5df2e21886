//! Systems of linear equations, and curves through noisy values.

use crate::grid::radius;
use bssrdf::half_space::layout::RINGS;

/// The share of the light with which the value of a ring counts as much as the smoothness. It grows with the square of
/// the distance beyond 4 mean free paths: few walks come so far, and they count much.
fn share_of_doubt(ring: usize) -> f64 {
    3e-4 * (radius(ring) / 4.0).powi(2).max(1.0)
}

/// Below this share a value is noise and does not count.
const NOISE: f64 = 2e-5;

/// Beyond the last value that counts the curve is nearly flat.
const FLATNESS: f64 = 0.01;

/// Minimizes the weighted squares of the distances from the values plus those of the second differences: Whittaker 1923.
/// `shares` of the light are the weights.
pub fn smooth(values: &[f64; RINGS], shares: &[f64; RINGS]) -> [f64; RINGS] {
    let mut matrix = [[0.0; RINGS]; RINGS];
    let mut right = [0.0; RINGS];
    let peak = (0..RINGS).max_by(|a, b| shares[*a].total_cmp(&shares[*b])).unwrap_or(0);
    // The first rings hold little light, but it is known: it has been scattered once.
    let last = (peak..RINGS).find(|b| shares[*b] < NOISE).unwrap_or(RINGS);
    for b in 0..RINGS {
        let doubt = share_of_doubt(b);
        let weight = match b {
            near if near < peak => shares[b].max(doubt) / doubt,
            far if far < last => shares[b] / doubt,
            _ => 0.0,
        };
        if weight > 0.0 {
            matrix[b][b] += weight;
            right[b] += weight * values[b];
        }
    }
    let mut penalize = |pattern: &[(usize, f64)], weight: f64| {
        for (i, a) in pattern {
            for (j, b) in pattern {
                matrix[*i][*j] += weight * a * b;
            }
        }
    };
    for b in 1..RINGS - 1 {
        penalize(&[(b - 1, 1.0), (b, -2.0), (b + 1, 1.0)], 1.0);
    }
    for b in last.saturating_sub(4)..RINGS - 1 {
        penalize(&[(b, 1.0), (b + 1, -1.0)], FLATNESS);
    }
    solve(matrix, right)
}

/// Solves a positive definite system by elimination.
pub fn solve<const N: usize>(mut matrix: [[f64; N]; N], mut right: [f64; N]) -> [f64; N] {
    for i in 0..N {
        let (pivot, value) = (matrix[i], right[i]);
        for j in i + 1..N {
            let factor = matrix[j][i] / pivot[i];
            for c in i..N {
                matrix[j][c] -= factor * pivot[c];
            }
            right[j] -= factor * value;
        }
    }
    let mut solution = [0.0; N];
    for i in (0..N).rev() {
        let known: f64 = (i + 1..N).map(|c| matrix[i][c] * solution[c]).sum();
        solution[i] = (right[i] - known) / matrix[i][i];
    }
    solution
}

//! The smooth factor that brings the model's light to the counted light: penalized Poisson likelihood
//! (docs/method.md 15.3).
//!
//! With the logarithm `f` of the factor at each patch, the counts `n_p` of a patch are Poisson distributed with mean
//! `m_p e^{(B f)_p}`, where `m_p` is what the model predicts and `B` interpolates. The fit minimizes
//!
//! ```text
//! Σ_p [m_p e^{(Bf)_p} − n_p (Bf)_p] + ½ λ ‖L f‖² + ½ ε ‖f‖²
//! ```
//!
//! with a Laplacian `L` over neighboring patches. `λ` is the one with which the fit of either half of the walks predicts
//! the counts of the other half best; an unlimited `λ` stands for no factor at all.

use crate::{
    patches::Patches,
    sparse::{Sparse, solve},
};

/// The counts of one channel.
pub struct Counts {
    /// What the model predicts for each half of the walks.
    pub model: Vec<f64>,
    /// The counts of each half.
    pub halves: [Vec<f64>; 2],
}

/// The fitted logarithms of the factor.
pub struct Fit {
    pub both: Vec<f64>,
    /// The fits of each half alone.
    pub halves: [Vec<f64>; 2],
}

/// The values of `λ` that are tried, from the smoothest.
const LAMBDAS: [f64; 9] = [1e6, 1e5, 3e4, 1e4, 3e3, 1e3, 3e2, 1e2, 1e1];

/// `ε`: it holds the factor at 1 where nothing else determines it, and is nothing against a single count.
const RIDGE: f64 = 1e-3;

/// Newton steps, and the largest change of a logarithm in one step.
const STEPS: usize = 20;
const MAX_CHANGE: f64 = 1.0;

/// The change below which the fit has converged.
const CONVERGED: f64 = 1e-4;

/// What the fits of all channels share.
pub struct Smoothness {
    /// The mean weights of [`Patches::weights`] over the sites of each patch.
    interpolation: Sparse,
    laplacian: Sparse,
}

impl Smoothness {
    pub fn new(patches: &Patches, interpolation: Sparse) -> Smoothness {
        let mut rows = vec![Vec::new(); patches.len()];
        for (i, j, weight) in patches.links() {
            rows[i as usize].push((j, weight));
            rows[j as usize].push((i, weight));
        }
        for (i, row) in rows.iter_mut().enumerate() {
            let sum: f64 = row.iter().map(|(_, weight)| weight).sum();
            row.iter_mut().for_each(|(_, weight)| *weight /= sum);
            if sum > 0.0 {
                row.push((i as u32, -1.0));
            }
        }
        Smoothness { interpolation, laplacian: Sparse(rows) }
    }

    /// A function of position at each patch, as the mean over the patch.
    pub fn at_patches(&self, f: &[f64]) -> Vec<f64> {
        self.interpolation.times(f)
    }

    /// Fits the factor to counts.
    pub fn fit(&self, counts: &Counts) -> Fit {
        let none = vec![0.0; counts.model.len()];
        let score = |f: [&[f64]; 2]| self.likelihood(counts, 1, f[0]) + self.likelihood(counts, 0, f[1]);
        let (mut best, mut best_score) = ((None, [none.clone(), none.clone()]), score([&none, &none]));
        let mut start = [none.clone(), none.clone()];
        for lambda in LAMBDAS {
            start = [0, 1].map(|half| self.minimize(&counts.model, &counts.halves[half], lambda, &start[half]));
            let reached = score([&start[0], &start[1]]);
            if reached > best_score {
                (best, best_score) = ((Some(lambda), start.clone()), reached);
            }
        }
        let (lambda, halves) = best;
        let Some(lambda) = lambda else {
            return Fit { both: none, halves };
        };
        let model: Vec<f64> = counts.model.iter().map(|m| 2.0 * m).collect();
        let all: Vec<f64> = counts.halves[0].iter().zip(&counts.halves[1]).map(|(a, b)| a + b).collect();
        Fit { both: self.minimize(&model, &all, lambda, &halves[0]), halves }
    }

    /// The logarithm of the probability of the counts of one half, less what does not depend on `f`.
    fn likelihood(&self, counts: &Counts, half: usize, f: &[f64]) -> f64 {
        let at = self.interpolation.times(f);
        let terms = at.iter().zip(&counts.model).zip(&counts.halves[half]);
        terms.map(|((f, m), n)| n * f - m * f.exp()).sum()
    }

    /// Newton's method from a start.
    fn minimize(&self, model: &[f64], counts: &[f64], lambda: f64, start: &[f64]) -> Vec<f64> {
        let mut f = start.to_vec();
        let (b, l) = (&self.interpolation, &self.laplacian);
        let bending = l.gram_diagonal(&vec![lambda; f.len()]);
        for _ in 0..STEPS {
            let predicted: Vec<f64> = b.times(&f).iter().zip(model).map(|(f, m)| m * f.exp()).collect();
            let misfit: Vec<f64> = counts.iter().zip(&predicted).map(|(n, p)| n - p).collect();
            let smooth = l.transposed_times(&l.times(&f));
            let downhill: Vec<f64> = (b.transposed_times(&misfit).iter().zip(&smooth).zip(&f))
                .map(|((data, smooth), f)| data - lambda * smooth - RIDGE * f)
                .collect();
            let curvature = |v: &[f64]| -> Vec<f64> {
                let weighted: Vec<f64> = b.times(v).iter().zip(&predicted).map(|(v, w)| v * w).collect();
                let bent = l.transposed_times(&l.times(v));
                (b.transposed_times(&weighted).iter().zip(&bent).zip(v))
                    .map(|((data, bent), v)| data + lambda * bent + RIDGE * v)
                    .collect()
            };
            let diagonal: Vec<f64> =
                b.gram_diagonal(&predicted).iter().zip(&bending).map(|(a, b)| a + b + RIDGE).collect();
            let step = solve(curvature, &diagonal, &downhill);
            let largest = step.iter().fold(0.0f64, |max, x| max.max(x.abs()));
            let damping = if largest > MAX_CHANGE { MAX_CHANGE / largest } else { 1.0 };
            f.iter_mut().zip(&step).for_each(|(f, step)| *f += damping * step);
            if largest < CONVERGED {
                break;
            }
        }
        f
    }
}

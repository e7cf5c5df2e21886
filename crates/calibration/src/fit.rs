//! The smooth factor that brings the model's light to the counted light: penalized Poisson likelihood
//! (docs/method.md 16.3).
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
    patches::{Patches, Site},
    sparse::{Sparse, solve},
};
use std::collections::BTreeMap;

/// The counts of one channel at each patch.
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
const CONVERGED: f64 = 1e-3;

/// What the fits of all channels share.
pub struct Smoothness {
    /// The mean weights of [`Patches::weights`] over the sites of each patch, and of each cell.
    interpolation: Sparse,
    to_cells: Sparse,
    laplacian: Sparse,
}

/// The mean weights of [`Patches::weights`] over the sites of each of `count` parts of the surface.
fn mean_weights(patches: &Patches, sites: &[Site], part_of: impl Fn(usize) -> u32, count: usize) -> Sparse {
    let mut rows: Vec<BTreeMap<u32, f64>> = vec![BTreeMap::new(); count];
    let mut counts = vec![0.0f64; count];
    for (k, site) in sites.iter().enumerate() {
        let part = part_of(k) as usize;
        counts[part] += 1.0;
        patches.weights(site, |j, weight| *rows[part].entry(j).or_default() += weight);
    }
    let mean = |(row, count): (BTreeMap<u32, f64>, &f64)| row.into_iter().map(|(j, w)| (j, w / count)).collect();
    Sparse::new(rows.into_iter().zip(&counts).map(mean).collect())
}

impl Smoothness {
    /// For sites in the cells `cell_of`.
    pub fn new(patches: &Patches, sites: &[Site], cell_of: &[u32]) -> Smoothness {
        let interpolation = mean_weights(patches, sites, |k| patches.patch_of_cell(cell_of[k]), patches.count());
        let to_cells = mean_weights(patches, sites, |k| cell_of[k], patches.cells());
        let mut rows = vec![Vec::new(); patches.count()];
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
        Smoothness { interpolation, to_cells, laplacian: Sparse::new(rows) }
    }

    /// A function of position at each patch, as the mean over the patch.
    pub fn at_patches(&self, f: &[f64]) -> Vec<f64> {
        self.interpolation.times(f)
    }

    /// A function of position at each cell, as the mean over the cell.
    pub fn at_cells(&self, f: &[f64]) -> Vec<f64> {
        self.to_cells.times(f)
    }

    /// Fits the factor to counts.
    pub fn fit(&self, counts: &Counts) -> Fit {
        let none = vec![0.0; counts.model.len()];
        let score = |f: [&[f64]; 2]| self.likelihood(counts, 1, f[0]) + self.likelihood(counts, 0, f[1]);
        let (mut best, mut best_score) = ((None, [none.clone(), none.clone()]), score([&none, &none]));
        let mut start = [none.clone(), none.clone()];
        for lambda in LAMBDAS {
            let of = |half: usize| self.minimize(&counts.model, &counts.halves[half], lambda, &start[half]);
            start = rayon::join(|| of(0), || of(1)).into();
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

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use glam::DVec3;
    use scene::random::{Item, Purpose, Stream};

    const SIDE: usize = 16;

    /// A square of 16 x 16 patches, as they are and as a fit sees them, and the logarithm of a factor at each.
    fn square() -> (Patches, Smoothness, Vec<f64>) {
        let side = 4 * SIDE;
        let at = |k: usize| (k as f64 + 0.5) / side as f64;
        let site = |k: usize| Site { position: DVec3::new(at(k % side), at(k / side), 0.0), normal: DVec3::Z };
        let sites: Vec<Site> = (0..side * side).map(site).collect();
        let (patches, cell_of) = Patches::new(&sites, 1.0, 8);
        let mut truth = vec![0.0; patches.count()];
        for (site, cell) in sites.iter().zip(&cell_of) {
            let p = site.position;
            truth[patches.patch_of_cell(*cell) as usize] += (0.5 + p.x * p.x - 0.8 * p.y) / 16.0;
        }
        let smoothness = Smoothness::new(&patches, &sites, &cell_of);
        (patches, smoothness, truth)
    }

    /// Poisson counts by multiplication of uniform numbers (Knuth).
    pub fn poisson(item: Item, mean: f64) -> f64 {
        let (mut product, mut count) = (1.0, 0);
        while product > (-mean).exp() {
            product *= item.uniform(count);
            count += 1;
        }
        f64::from(count as u32 - 1)
    }

    fn drawn(truth: &[f64], mean: f64, seed: u64) -> Counts {
        let stream = Stream::new(seed, Purpose::LightWalk);
        let half = |half: usize| {
            let one = |(k, f): (usize, &f64)| poisson(stream.item((half * truth.len() + k) as u64), mean * f.exp());
            truth.iter().enumerate().map(one).collect()
        };
        Counts { model: vec![mean; truth.len()], halves: [half(0), half(1)] }
    }

    fn error(smoothness: &Smoothness, fitted: &[f64], truth: &[f64]) -> f64 {
        let at = smoothness.at_patches(fitted);
        (at.iter().zip(truth).map(|(a, b)| (a - b).powi(2)).sum::<f64>() / truth.len() as f64).sqrt()
    }

    /// With 20 counts a patch and half, each patch alone has an error of 0.16. The fit of a smooth factor is three times
    /// as good or more, and its total is that of the counts.
    ///
    /// Seen to catch: a Laplacian with the wrong sign of its diagonal; no penalty; one half for both.
    #[test]
    fn a_smooth_factor_is_found_in_noise() {
        let (_, smoothness, truth) = square();
        for seed in 0..4 {
            let counts = drawn(&truth, 20.0, seed);
            let fit = smoothness.fit(&counts);
            let rms = error(&smoothness, &fit.both, &truth);
            assert!(rms < 0.05, "seed {seed}: {rms}");
            let fitted: f64 = smoothness.at_patches(&fit.both).iter().map(|f| 2.0 * 20.0 * f.exp()).sum();
            let counted: f64 = counts.halves.iter().flatten().sum();
            assert!((fitted / counted - 1.0).abs() < 2e-3, "seed {seed}: {}", fitted / counted);
        }
    }

    /// If the model is right, there is no factor but noise, which either half alone cannot predict.
    #[test]
    fn no_factor_is_found_where_there_is_none() {
        let (patches, smoothness, _) = square();
        for seed in 0..4 {
            let none = vec![0.0; patches.count()];
            let fit = smoothness.fit(&drawn(&none, 20.0, seed));
            let rms = error(&smoothness, &fit.both, &none);
            assert!(rms < 0.05, "seed {seed}: {rms}");
        }
    }

    /// Patches that nothing is known of keep a factor near that of their neighbors.
    #[test]
    fn a_dark_patch_follows_its_neighbors() {
        let (_, smoothness, truth) = square();
        let mut counts = drawn(&truth, 200.0, 1);
        let dark = 77;
        counts.model[dark] = 0.0;
        counts.halves.iter_mut().for_each(|half| half[dark] = 0.0);
        let fit = smoothness.fit(&counts);
        assert!((fit.both[dark] - truth[dark]).abs() < 0.1, "{} {}", fit.both[dark], truth[dark]);
    }
}

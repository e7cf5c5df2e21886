//! Reflectances of a half-space by Chandrasekhar's H function, and reflection at the boundary from inside.
//!
//! Without a boundary, light of power 1 and cosine `μ'` leaves a half-space of isotropic scatterers at the cosine `μ` with the
//! power `ρ(μ|μ') dμ = ½ α μ/(μ + μ') H(μ) H(μ') dμ` (Chandrasekhar 1950). What the boundary reflects comes back:
//! `p = ρ(·|μ12) + ∫ ρ(·|μ') R(μ') p(μ') dμ'`, and `∫ T p dμ` leaves. No random numbers, seven digits.

use bssrdf::{fresnel::transmittance, half_space::critical_cosine};

/// Points in each panel.
const POINTS: usize = 48;

/// A medium of one albedo and index.
pub struct Exact {
    cosines: Vec<f64>,
    widths: Vec<f64>,
    transmitted: Vec<f64>,
    outside: Vec<f64>,
    h: Vec<f64>,
    absorbed: f64,
}

/// What leaves.
pub struct Leaving {
    /// The share of the light that entered, over `α`.
    pub reflectance: f64,
    /// The mean of its cosines outside.
    pub cosine: f64,
}

impl Exact {
    /// `absorbed` is `1 − α`.
    pub fn new(absorbed: f64, eta: f64) -> Exact {
        let (cosines, widths): (Vec<f64>, Vec<f64>) = nodes(critical_cosine(eta)).into_iter().unzip();
        let transmitted = cosines.iter().map(|c| transmittance(*c, 1.0 / eta)).collect();
        let outside = cosines.iter().map(|c| (1.0 - eta * eta * (1.0 - c * c)).max(0.0).sqrt()).collect();
        let h = h_function(&cosines, &widths, absorbed);
        Exact { cosines, widths, transmitted, outside, h, absorbed }
    }

    /// `H` at any cosine.
    fn h(&self, cosine: f64) -> f64 {
        let sum: f64 =
            (0..self.h.len()).map(|j| self.widths[j] * self.cosines[j] * self.h[j] / (cosine + self.cosines[j])).sum();
        1.0 / (self.absorbed.sqrt() + 0.5 * (1.0 - self.absorbed) * sum)
    }

    /// `ρ(μ_i|μ')/α` of the light of cosine `cosine`, of which `H` is `h`.
    fn out(&self, i: usize, cosine: f64, h: f64) -> f64 {
        0.5 * self.cosines[i] / (self.cosines[i] + cosine) * self.h[i] * h
    }

    /// What leaves of light that entered at the refracted cosine `cosine`.
    pub fn leaving(&self, cosine: f64) -> Leaving {
        let (n, albedo) = (self.h.len(), 1.0 - self.absorbed);
        let source = self.h(cosine);
        let first: Vec<f64> = (0..n).map(|i| self.out(i, cosine, source)).collect();
        let mut power = first.clone();
        for _ in 0..ROUNDS {
            let back: Vec<f64> = (0..n).map(|j| (1.0 - self.transmitted[j]) * power[j] * self.widths[j]).collect();
            let next = |i: usize| {
                first[i] + albedo * (0..n).map(|j| self.out(i, self.cosines[j], self.h[j]) * back[j]).sum::<f64>()
            };
            let new: Vec<f64> = (0..n).map(next).collect();
            let change = new.iter().zip(&power).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
            power = new;
            if change < 1e-10 {
                break;
            }
        }
        let leaves = |f: &dyn Fn(usize) -> f64| {
            (0..n).map(|i| self.transmitted[i] * power[i] * self.widths[i] * f(i)).sum::<f64>()
        };
        let reflectance = leaves(&|_| 1.0);
        Leaving { reflectance, cosine: leaves(&|i| self.outside[i]) / reflectance }
    }
}

/// The reflection from inside is repeated so often at most: it loses a twentieth each time at an index of 2.5.
const ROUNDS: usize = 1000;

/// Cosines and widths of two panels that meet at the critical cosine, dense at both ends of each.
fn nodes(critical: f64) -> Vec<(f64, f64)> {
    let panel = |low: f64, high: f64| {
        (0..POINTS).map(move |k| {
            let t = (k as f64 + 0.5) / POINTS as f64;
            // A smooth step, whose derivatives vanish at the ends: the rule of the middles is then of high order.
            let place = t * t * t * (10.0 - t * (15.0 - 6.0 * t));
            let slope = 30.0 * t * t * (1.0 - t) * (1.0 - t);
            (low + (high - low) * place, (high - low) * slope / POINTS as f64)
        })
    };
    let lower = (critical > 0.0).then(|| panel(0.0, critical)).into_iter().flatten();
    lower.chain(panel(critical, 1.0)).collect()
}

/// `H` from its integral equation `1/H(μ) = √(1−α) + ½ α ∫ μ' H(μ')/(μ + μ') dμ'`.
fn h_function(cosines: &[f64], widths: &[f64], absorbed: f64) -> Vec<f64> {
    let n = cosines.len();
    let mut h = vec![1.0; n];
    for _ in 0..3000 {
        let next = |i: usize| {
            let sum: f64 = (0..n).map(|j| widths[j] * cosines[j] * h[j] / (cosines[i] + cosines[j])).sum();
            0.5 * (h[i] + 1.0 / (absorbed.sqrt() + 0.5 * (1.0 - absorbed) * sum))
        };
        let new: Vec<f64> = (0..n).map(next).collect();
        let change = new.iter().zip(&h).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        h = new;
        if change < 1e-13 {
            break;
        }
    }
    h
}

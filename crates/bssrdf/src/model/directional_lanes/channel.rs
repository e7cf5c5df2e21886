//! One channel of the directional dipole on blocks, in four steps, with the equation of docs/method.md on each line.
//! The steps of the three channels take turns, so that a processor has something to do while one of them waits for its
//! roots.
//!
//! Lengths are in units of `1/σ_t'`, so that `D = 1/3`, and `G` is in units of `3C_φ`, so that `k = C_E/(3C_φ)` is the
//! only constant of the boundary (docs/method.md 9.7).

use super::geometry::{Projections, SourceGeometry};
use crate::{
    lanes::{
        block::{LANES, Lane},
        distances::Distances,
        exp::{decay2, exp2_negative},
    },
    medium::{Coefficients, Interface},
};
use std::f64::consts::{LOG2_E, PI};

/// A value this many times smaller than its terms has lost too many of float32's digits.
const CANCELLATION: f32 = 64.0;

/// The constants of one channel.
#[derive(Clone, Copy, Debug)]
pub(super) struct Channel {
    /// `σ_t'`, 1/m: what lengths in m are multiplied by; its square, 1/m²; and `k σ_t'`, 1/m.
    reduced: f32,
    reduced2: f32,
    k_reduced: f32,
    /// `σ̂_tr = σ_tr/σ_t'` (9.1), and `−σ̂_tr log₂ e`: the exponent of 2 that belongs to a distance.
    transport: f32,
    exponent: f32,
    /// `d_e²` (5.1), and `4 d_e² σ_t'²`, 1/m².
    extrapolation2: f32,
    four_extrapolation2: f32,
    /// `h` (5.1), `h²` and `−k h`.
    mirror: f32,
    mirror2: f32,
    minus_k_mirror: f32,
    /// `z² = 1/(3σ_t)²` of a source that is lit from behind (5.3).
    back_lit_depth2: f32,
    /// `3C_φ σ_t'²/(4π² · 4C_φ(1/η))` (5.10, 9.5), 1/m²; 0 where nothing scatters.
    prefactor: f32,
}

/// `d_r²` (5.4), and `δd² = d_v² − d_r² = h² − z²` (9.4).
pub(super) struct Squares {
    real2: Lane,
    delta2: Lane,
}

/// `d_r`, `1/d_r`, `1/d_v` and `δ` (9.1); see [`Distances`].
pub(super) struct Roots {
    real: Lane,
    over_real: Lane,
    over_virtual: Lane,
    delta: Lane,
}

/// `e^{−δq}` and `1 − e^{−δq}` (9.6), and `e^{−q_r}` times the prefactor (9.5).
pub(super) struct Decay {
    exp: Lane,
    one_minus_exp: Lane,
    real: Lane,
}

impl Channel {
    pub fn new(c: &Coefficients, boundary: &Interface, k: f64) -> Channel {
        // Where nothing scatters the prefactor is 0, and the lengths of any medium do.
        let scatters = c.scatters();
        let c = if scatters { c } else { &Coefficients { sigma_a: 1.0, sigma_s: 1.0, asymmetry: 0.0 } };
        let reduced = c.reduced_extinction();
        let extrapolation = 2.131 / 3.0 / c.reduced_albedo().sqrt();
        let mirror = 2.0 * boundary.reflection * extrapolation;
        let transport = c.transport() / reduced;
        let prefactor = 3.0 * boundary.c_phi * reduced * reduced / (4.0 * PI * PI * boundary.exit_norm);
        Channel {
            reduced: reduced as f32,
            reduced2: (reduced * reduced) as f32,
            k_reduced: (k * reduced) as f32,
            transport: transport as f32,
            exponent: (-transport * LOG2_E) as f32,
            extrapolation2: extrapolation.powi(2) as f32,
            four_extrapolation2: (2.0 * extrapolation * reduced).powi(2) as f32,
            mirror: mirror as f32,
            mirror2: (mirror * mirror) as f32,
            minus_k_mirror: (-k * mirror) as f32,
            back_lit_depth2: (reduced / (3.0 * c.extinction())).powi(2) as f32,
            prefactor: if scatters { prefactor as f32 } else { 0.0 },
        }
    }

    /// Step one: the depth of the real source.
    #[inline(always)]
    pub fn squares(&self, source: &SourceGeometry) -> Squares {
        let mut squares = Squares { real2: [0.0; LANES], delta2: [0.0; LANES] };
        for i in 0..LANES {
            let (r2, mu0) = (source.r2[i] * self.reduced2, source.mu0[i]);
            let d_mu0 = mu0 * (1.0 / 3.0); // D μ₀ (5.3)
            // 2 d_e β̂ (5.2)
            let two_de_beta = (source.across2[i] * self.four_extrapolation2 / (r2 + self.extrapolation2)).sqrt();
            let front_lit_depth2 = d_mu0 * (d_mu0 + two_de_beta); // z² (5.3)
            let z2 = if mu0 > 0.0 { front_lit_depth2 } else { self.back_lit_depth2 }; // z² (5.3)
            squares.real2[i] = r2 + z2; // d_r² (5.4)
            squares.delta2[i] = self.mirror2 - z2; // δd² (9.4)
        }
        squares
    }

    /// Step two: the distances.
    #[inline(always)]
    pub fn roots(&self, source: &SourceGeometry, squares: &Squares) -> Roots {
        let zero = [0.0; LANES];
        let mut roots = Roots { real: zero, over_real: zero, over_virtual: zero, delta: zero };
        for i in 0..LANES {
            let virtual2 = source.r2[i] * self.reduced2 + self.mirror2; // d_v² (5.4)
            let d = Distances::new(squares.real2[i], virtual2, squares.delta2[i]);
            roots.real[i] = d.real;
            roots.over_real[i] = d.over_real;
            roots.over_virtual[i] = d.over_virtual;
            roots.delta[i] = d.delta;
        }
        roots
    }

    /// Step three: the exponentials.
    #[inline(always)]
    pub fn decay(&self, roots: &Roots) -> Decay {
        let zero = [0.0; LANES];
        let mut decay = Decay { exp: zero, one_minus_exp: zero, real: zero };
        for i in 0..LANES {
            (decay.exp[i], decay.one_minus_exp[i]) = decay2(self.exponent * roots.delta[i]); // e^{−δq}, 1 − e^{−δq}
            decay.real[i] = exp2_negative(self.exponent * roots.real[i]) * self.prefactor; // e^{−q_r}
        }
        decay
    }

    /// Step four: `S_bare` (docs/method.md 5.10 by 9.5), and 1 where it has lost too many digits.
    #[inline(always)]
    pub fn values(&self, p: &Projections, s: &Squares, d: &Roots, decay: &Decay) -> (Lane, [u32; LANES]) {
        let (mut values, mut lost) = ([0.0; LANES], [0; LANES]);
        for i in 0..LANES {
            let rho = d.real[i] * d.over_virtual[i]; // ρ = d_r/d_v
            let rho3 = rho * rho * rho;
            // ω (9.6); not negative, for h² > z² in every medium.
            let omega = d.delta[i] * d.over_virtual[i] * (1.0 + rho * (1.0 + rho)) + rho3 * decay.one_minus_exp[i];
            let one_minus_omega = rho3 * decay.exp[i];
            let [(g, g_terms), (delta_g, delta_g_terms)] = self.brackets(p, s, d, i);
            let sum = omega * g - one_minus_omega * delta_g; // ω G_r − (1 − ω) ΔG (9.5)
            let terms = omega * g_terms + one_minus_omega * delta_g_terms;
            let value = decay.real[i] * (d.over_real[i] * d.over_real[i] * d.over_real[i]) * sum; // E_r [...] (9.5)
            values[i] = if value > 0.0 { value } else { 0.0 }; // max(0, ...) (5.10)
            // `value` is infinite or NaN where d_r is too near 0 for float32.
            let good = sum.abs() * CANCELLATION >= terms && value < f32::INFINITY;
            lost[i] = u32::from(!good);
        }
        (values, lost)
    }

    /// `G_r` (9.7) and `ΔG` (9.8), over `3C_φ`; each with the sum of the magnitudes of its terms.
    #[inline(always)]
    fn brackets(&self, p: &Projections, s: &Squares, d: &Roots, i: usize) -> [(f32, f32); 2] {
        let (over_real2, over_virtual2) = (d.over_real[i] * d.over_real[i], d.over_virtual[i] * d.over_virtual[i]);
        let (x, k_n) = (p.x[i] * self.reduced, p.n[i] * self.k_reduced); // X_r, k N_r (5.8)
        let (q, delta_q) = (self.transport * d.real[i], self.transport * d.delta[i]); // q_r, δq (9.1)
        let one_q = 1.0 + q;
        let kappa = (3.0 * one_q + q * q) * over_real2; // κ_r (9.3)
        let gradient = one_q + kappa * x; // P_r (9.7)
        let gradient_term = gradient * k_n; // P_r k N_r (9.7)
        let g = s.real2[i] + one_q * (x + p.k_mu[i]) + gradient_term; // G_r (9.7)
        let g_terms = s.real2[i] + one_q * (x.abs() + p.k_mu[i].abs()) + gradient_term.abs();

        let (delta_x, delta_k_n) = (self.mirror * p.a[i], self.minus_k_mirror * p.b[i]); // δX, k δN (9.4)
        let x_virtual = x + delta_x; // X_v (5.8)
        let delta_d2 = s.delta2[i]; // δd² (9.4)
        // δκ (9.9)
        let delta_kappa = (delta_q * ((one_q + one_q) + (1.0 + delta_q)) - kappa * delta_d2) * over_virtual2;
        let delta_gradient = delta_q + delta_kappa * x_virtual + kappa * delta_x; // δP (9.9)
        let by_decay = delta_q * (x_virtual + p.k_mu_virtual[i]); // δq (X_v − k W_v) (9.8)
        let by_source = one_q * (delta_x + (p.k_mu_virtual[i] - p.k_mu[i])); // (1 + q_r)(δX − k δW) (9.8)
        let by_gradient = delta_gradient * (k_n + delta_k_n); // δP k N_v (9.8)
        let by_normal = gradient * delta_k_n; // P_r k δN (9.8)
        let delta_g = (delta_d2 + by_decay) + (by_source + (by_gradient + by_normal)); // ΔG (9.8)
        let delta_g_terms = (delta_d2 + by_decay.abs()) + (by_source.abs() + (by_gradient.abs() + by_normal.abs()));
        [(g, g_terms), (delta_g, delta_g_terms)]
    }
}

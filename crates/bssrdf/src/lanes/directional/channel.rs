//! One channel of the directional dipole on blocks, in four steps. The steps of the three channels take turns, so that a
//! processor has something to do while one of them waits for its roots.

use super::{
    super::{
        LANES, Lane,
        dipole::Distances,
        exp::{decay2, exp2_negative},
    },
    geometry::{Projections, SourceGeometry},
};
use crate::{Coefficients, Interface};
use std::f64::consts::{LOG2_E, PI};

/// A value this many times smaller than its terms has lost too many of float32's digits.
const CANCELLATION: f32 = 64.0;

/// One channel, lengths in units of 1/σ_t'; `D` is 1/3 then. `k = C_E/(3C_φ)`: all is in units of `3C_φ`.
#[derive(Clone, Copy, Debug)]
pub(super) struct Channel {
    /// `σ_t'`, 1/m; its square, 1/m²; and `k σ_t'`, 1/m.
    scale: f32,
    scale2: f32,
    scale_k: f32,
    /// `σ_tr`, and `−σ_tr log₂ e`.
    transport: f32,
    fall: f32,
    /// `d_e²`, and `4 d_e² σ_t'²`, 1/m².
    extrapolation2: f32,
    across: f32,
    /// `h`, `h²` and `−k h`.
    mirror: f32,
    mirror2: f32,
    mirror_k: f32,
    /// `1/(3σ_t)²`.
    back_lit: f32,
    /// `3C_φ σ_t'²/(4π² · 4C_φ(1/η))`, 1/m²; 0 where nothing scatters.
    prefactor: f32,
}

/// `d_r²` and `δd² = d_v² − d_r² = h² − z²`.
pub(super) struct Squares {
    real2: Lane,
    delta2: Lane,
}

/// See [`Distances`].
pub(super) struct Roots {
    real: Lane,
    over_real: Lane,
    over_virtual: Lane,
    delta: Lane,
}

/// The exponentials: `e^{−δq}`, one minus that, and `e^{−q_r}` times the prefactor.
pub(super) struct Decay {
    exp: Lane,
    one_minus_exp: Lane,
    real: Lane,
}

impl Channel {
    /// A channel that scatters nothing.
    const NOTHING: Channel = Channel {
        scale: 1.0,
        scale2: 1.0,
        scale_k: 1.0,
        transport: 0.0,
        fall: 0.0,
        extrapolation2: 1.0,
        across: 1.0,
        mirror: 1.0,
        mirror2: 1.0,
        mirror_k: 1.0,
        back_lit: 0.1,
        prefactor: 0.0,
    };

    pub fn new(c: &Coefficients, boundary: &Interface, k: f64) -> Channel {
        if !c.scatters() {
            return Channel::NOTHING;
        }
        let reduced = c.reduced_extinction();
        let extrapolation = 2.131 / 3.0 / c.reduced_albedo().sqrt();
        let mirror = 2.0 * boundary.reflection * extrapolation;
        let transport = c.transport() / reduced;
        Channel {
            scale: reduced as f32,
            scale2: (reduced * reduced) as f32,
            scale_k: (k * reduced) as f32,
            transport: transport as f32,
            fall: (-transport * LOG2_E) as f32,
            extrapolation2: extrapolation.powi(2) as f32,
            across: (2.0 * extrapolation * reduced).powi(2) as f32,
            mirror: mirror as f32,
            mirror2: (mirror * mirror) as f32,
            mirror_k: (-k * mirror) as f32,
            back_lit: (reduced / (3.0 * c.extinction())).powi(2) as f32,
            prefactor: (3.0 * boundary.c_phi * reduced * reduced / (4.0 * PI * PI * boundary.exit_norm)) as f32,
        }
    }

    /// The depth of the real source (method.md 5.2, 5.3).
    #[inline(always)]
    pub fn squares(&self, light: &SourceGeometry) -> Squares {
        let mut squares = Squares { real2: [0.0; LANES], delta2: [0.0; LANES] };
        for i in 0..LANES {
            let (r2, mu0) = (light.r2[i] * self.scale2, light.mu0[i]);
            let d_mu = mu0 * (1.0 / 3.0);
            let front = d_mu * (d_mu + (light.across2[i] * self.across / (r2 + self.extrapolation2)).sqrt());
            let z2 = if mu0 > 0.0 { front } else { self.back_lit };
            squares.real2[i] = r2 + z2;
            squares.delta2[i] = self.mirror2 - z2;
        }
        squares
    }

    #[inline(always)]
    pub fn roots(&self, light: &SourceGeometry, squares: &Squares) -> Roots {
        let zero = [0.0; LANES];
        let mut roots = Roots { real: zero, over_real: zero, over_virtual: zero, delta: zero };
        for i in 0..LANES {
            let virtual2 = light.r2[i] * self.scale2 + self.mirror2;
            let d = Distances::new(squares.real2[i], virtual2, squares.delta2[i]);
            roots.real[i] = d.real;
            roots.over_real[i] = d.over_real;
            roots.over_virtual[i] = d.over_virtual;
            roots.delta[i] = d.delta;
        }
        roots
    }

    #[inline(always)]
    pub fn falls(&self, roots: &Roots) -> Decay {
        let zero = [0.0; LANES];
        let mut falls = Decay { exp: zero, one_minus_exp: zero, real: zero };
        for i in 0..LANES {
            (falls.exp[i], falls.one_minus_exp[i]) = decay2(self.fall * roots.delta[i]);
            falls.real[i] = exp2_negative(self.fall * roots.real[i]) * self.prefactor;
        }
        falls
    }

    /// `S_bare` (method.md 5.10 by 9.5), and 1 where it has lost too many digits.
    #[inline(always)]
    pub fn values(&self, p: &Projections, s: &Squares, d: &Roots, e: &Decay) -> (Lane, [u32; LANES]) {
        let (mut values, mut lost) = ([0.0; LANES], [0; LANES]);
        for i in 0..LANES {
            // ω = 1 − ρ³ e^{−δq} with ρ = d_r/d_v = 1 − u (9.2); not negative, for h² > z² in every medium.
            let rho = d.real[i] * d.over_virtual[i];
            let rho3 = rho * rho * rho;
            let omega = d.delta[i] * d.over_virtual[i] * (1.0 + rho * (1.0 + rho)) + rho3 * e.one_minus_exp[i];
            let share = rho3 * e.exp[i];
            let [(g, g_terms), (d_g, d_terms)] = self.brackets(p, s, d, i);
            let sum = omega * g - share * d_g;
            let terms = omega * g_terms + share * d_terms;
            let value = e.real[i] * (d.over_real[i] * d.over_real[i] * d.over_real[i]) * sum;
            // The clamp of (5.10).
            values[i] = if value > 0.0 { value } else { 0.0 };
            // No number, or infinite, where d_r is too near 0 for float32.
            let good = sum.abs() * CANCELLATION >= terms && value < f32::INFINITY;
            lost[i] = u32::from(!good);
        }
        (values, lost)
    }

    /// `G` of the real source and how the virtual one's differs (method.md 9.3, 9.4), over `3C_φ`; each with the sum of the
    /// magnitudes of its terms.
    #[inline(always)]
    fn brackets(&self, p: &Projections, s: &Squares, d: &Roots, i: usize) -> [(f32, f32); 2] {
        let (over_real2, over_virtual2) = (d.over_real[i] * d.over_real[i], d.over_virtual[i] * d.over_virtual[i]);
        let (x, n) = (p.x[i] * self.scale, p.n[i] * self.scale_k);
        let (q, q_delta) = (self.transport * d.real[i], self.transport * d.delta[i]);
        let one_q = 1.0 + q;
        let kappa = (3.0 * one_q + q * q) * over_real2;
        let pole = one_q + kappa * x;
        let pole_n = pole * n;
        let g = s.real2[i] + one_q * (x + p.k_mu[i]) + pole_n;
        let g_terms = s.real2[i] + one_q * (x.abs() + p.k_mu[i].abs()) + pole_n.abs();

        let (dx, dn) = (self.mirror * p.a[i], self.mirror_k * p.b[i]);
        let x_virtual = x + dx;
        let delta2 = s.delta2[i];
        let d_kappa = (q_delta * ((one_q + one_q) + (1.0 + q_delta)) - kappa * delta2) * over_virtual2;
        let d_pole = q_delta + d_kappa * x_virtual + kappa * dx;
        let t1 = q_delta * (x_virtual + p.k_mu_virtual[i]);
        let t2 = one_q * (dx + (p.k_mu_virtual[i] - p.k_mu[i]));
        let (t3, t4) = (d_pole * (n + dn), pole * dn);
        let d_g = (delta2 + t1) + (t2 + (t3 + t4));
        let d_terms = (delta2 + t1.abs()) + (t2.abs() + (t3.abs() + t4.abs()));
        [(g, g_terms), (d_g, d_terms)]
    }
}

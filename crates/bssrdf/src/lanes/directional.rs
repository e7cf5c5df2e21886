//! The directional dipole on blocks; see `directional_dipole.rs` for the model.
//!
//! The difference of the real and the virtual source is expanded in the difference of their distances (method.md 9.1 to
//! 9.5): far away the two cancel like (h/r)², and float32 has no digits for that. Where `S` passes through zero the terms
//! cancel in any form; those few values are taken from the float64 model.

use super::{Block, LANES, Lane, LaneModel, dot, dot_one, each, exp::decay, exp_negative};
use crate::{Bssrdf, DirectionalDipole, Medium, Separation};
use glam::{DVec3, Vec3};
use std::f64::consts::PI;

/// Below this a projected unit vector has no direction left (method.md 5.6).
const NULL_DIRECTION: f32 = 1e-6;

/// A value this many times smaller than its terms has lost too many of float32's digits.
const CANCELLATION: f32 = 64.0;

/// One channel, lengths in units of 1/σ_t'; `D` is 1/3 then.
#[derive(Clone, Copy, Debug)]
struct Channel {
    /// `σ_t'`, 1/m.
    scale: f32,
    transport: f32,
    /// `d_e`.
    extrapolation: f32,
    /// `h`.
    mirror: f32,
    /// `1/(3σ_t)²`.
    back_lit: f32,
    /// `σ_t'²/(4π² · 4C_φ(1/η))`, 1/m²; 0 where nothing scatters.
    strength: f32,
}

/// The directional dipole of one medium.
#[derive(Clone, Debug)]
pub struct DirectionalLanes {
    channels: [Channel; 3],
    c_phi: f32,
    c_e: f32,
    /// The float64 model.
    reference: DirectionalDipole,
}

/// What the three channels share; lengths in m.
struct Shared {
    r2: Lane,
    /// `x·ω12`.
    x: Lane,
    /// `‖x × ω12‖`.
    across: Lane,
    /// `x·n_o`.
    n: Lane,
    mu0: Lane,
    /// `n*·ω12`, `n*·n_o`.
    a: Lane,
    b: Lane,
}

impl LaneModel for DirectionalLanes {
    fn new(medium: &Medium) -> Self {
        let boundary = &medium.interface;
        let channels = medium.channels.map(|c| {
            let reduced = c.reduced_extinction();
            if !c.scatters() {
                return Channel::NOTHING;
            }
            let extrapolation = 2.131 / 3.0 / c.reduced_albedo().sqrt();
            Channel {
                scale: reduced as f32,
                transport: (c.transport() / reduced) as f32,
                extrapolation: extrapolation as f32,
                mirror: (2.0 * boundary.reflection * extrapolation) as f32,
                back_lit: (reduced / (3.0 * c.extinction())).powi(2) as f32,
                strength: (reduced * reduced / (4.0 * PI * PI * boundary.exit_norm)) as f32,
            }
        });
        let reference = DirectionalDipole::new(medium);
        DirectionalLanes { channels, c_phi: boundary.c_phi as f32, c_e: boundary.c_e as f32, reference }
    }

    #[inline(always)]
    fn bare(&self, block: &Block, normal_out: [f32; 3]) -> [Lane; 3] {
        let shared = Shared::new(block, normal_out);
        let mut values = [[0.0; LANES]; 3];
        for (channel, (c, values)) in self.channels.iter().zip(&mut values).enumerate() {
            let mut cancels = [0u32; LANES];
            for i in 0..LANES {
                let (value, terms) = self.channel(c, &shared, i);
                // The clamp of (5.10).
                values[i] = if value > 0.0 { value } else { 0.0 };
                // No number, or infinite, where d_r is too near 0 for float32.
                let good = value.abs() * CANCELLATION >= terms && value.abs() < f32::INFINITY;
                cancels[i] = u32::from(!good) << i;
            }
            let mut left = cancels.iter().fold(0, |mask, lane| mask | lane);
            while left != 0 {
                let lane = left.trailing_zeros() as usize;
                left &= left - 1;
                values[lane] = self.exactly(block, normal_out, channel, lane);
            }
        }
        values
    }
}

impl DirectionalLanes {
    /// One value by the float64 model; 0, as for `d_r = 0`, in the pole beside it that float32 cannot hold.
    #[cold]
    fn exactly(&self, block: &Block, normal_out: [f32; 3], channel: usize, lane: usize) -> f32 {
        let vector = |v: &[Lane; 3]| DVec3::from_array([0, 1, 2].map(|c| f64::from(v[c][lane])));
        let separation = Separation {
            offset: vector(&block.offset),
            normal_in: vector(&block.normal_in),
            refracted: vector(&block.refracted),
            normal_out: Vec3::from_array(normal_out).as_dvec3(),
        };
        let value = self.reference.bare(channel, &separation) as f32;
        if value < f32::INFINITY { value } else { 0.0 }
    }

    /// `S_bare` of one channel and lane before its clamp (method.md 5.10 by 9.5), and the sum of the magnitudes of its
    /// terms.
    #[inline(always)]
    fn channel(&self, c: &Channel, s: &Shared, i: usize) -> (f32, f32) {
        let r2 = s.r2[i] * c.scale * c.scale;
        let (x, n, across) = (s.x[i] * c.scale, s.n[i] * c.scale, s.across[i] * c.scale);
        let (a, b, mu0) = (s.a[i], s.b[i], s.mu0[i]);
        let h = c.mirror;

        let beta = across / (r2 + c.extrapolation * c.extrapolation).sqrt();
        let d_mu = mu0 * (1.0 / 3.0);
        let front = d_mu * (d_mu + 2.0 * c.extrapolation * beta);
        let z2 = if mu0 > 0.0 { front } else { c.back_lit };
        let (real2, virtual2) = (r2 + z2, r2 + h * h);
        let (real, mirrored) = (real2.sqrt(), virtual2.sqrt());
        let over_real2 = 1.0 / real2;
        let over_virtual2 = 1.0 / virtual2;

        // Differences virtual − real (9.1, 9.4).
        let delta2 = h * h - z2;
        let delta = delta2 / (real + mirrored);
        let q_delta = c.transport * delta;
        let (q_real, q_virtual) = (c.transport * real, c.transport * mirrored);
        let (dx, dw, dn) = (h * a, -2.0 * a * b, -h * b);

        // ω = 1 − ρ³ e^{−δq} with ρ = d_r/d_v = 1 − u (9.2).
        let u = delta * mirrored * over_virtual2;
        let rho = real * mirrored * over_virtual2;
        let rho3 = rho * rho * rho;
        let (stays, fades) = decay(q_delta);
        let omega = u * (3.0 - 3.0 * u + u * u) + rho3 * fades;

        let one_q = 1.0 + q_real;
        let kappa = (3.0 * one_q + q_real * q_real) * over_real2;
        let pole = one_q + kappa * x;
        let g_real = self.c_phi * 3.0 * (real2 + one_q * x) - self.c_e * (-mu0 * one_q - pole * n);
        let g_terms =
            self.c_phi * 3.0 * (real2 + (one_q * x).abs()) + self.c_e * ((mu0 * one_q).abs() + (pole * n).abs());

        let (x_virtual, n_virtual) = (x + dx, n + dn);
        let d_kappa = (q_delta * (3.0 + q_real + q_virtual) - kappa * delta2) * over_virtual2;
        let d_pole = q_delta + d_kappa * x_virtual + kappa * dx;
        let d_fluence = 3.0 * (delta2 + q_delta * x_virtual + one_q * dx);
        let d_vector = q_delta * (dw - mu0) + one_q * dw - (d_pole * n_virtual + pole * dn);
        let d_g = self.c_phi * d_fluence - self.c_e * d_vector;

        let d_terms = self.c_phi * 3.0 * (delta2.abs() + (q_delta * x_virtual).abs() + (one_q * dx).abs())
            + self.c_e * ((one_q * dw).abs() + (d_pole * n_virtual).abs() + (pole * dn).abs());

        let e_real = exp_negative(-q_real) * over_real2 / real * c.strength;
        let difference = e_real * (omega * g_real - rho3 * stays * d_g);
        (difference, e_real * (omega.abs() * g_terms + rho3 * stays * d_terms))
    }
}

impl Channel {
    /// A channel that scatters nothing.
    const NOTHING: Channel =
        Channel { scale: 1.0, transport: 0.0, extrapolation: 1.0, mirror: 1.0, back_lit: 1.0, strength: 0.0 };
}

impl Shared {
    #[inline(always)]
    fn new(block: &Block, normal_out: [f32; 3]) -> Shared {
        let (offset, refracted, normal_in) = (&block.offset, &block.refracted, &block.normal_in);
        let r2 = dot(offset, offset);
        let inverse = each(|i| if r2[i] > 0.0 { 1.0 / r2[i].sqrt() } else { 0.0 });
        let unit = [0, 1, 2].map(|c| each(|i| offset[c][i] * inverse[i]));
        let across = each(|i| {
            let [x, y, z] = [0, 1, 2].map(|c| {
                let (d, e) = ((c + 1) % 3, (c + 2) % 3);
                offset[d][i] * refracted[e][i] - offset[e][i] * refracted[d][i]
            });
            (x * x + y * y + z * z).sqrt()
        });
        // n* = unit(n_i − (n_i·x̂) x̂) (5.5).
        let along = dot(normal_in, &unit);
        let normal = [0, 1, 2].map(|c| each(|i| normal_in[c][i] - along[i] * unit[c][i]));
        let length = {
            let squared = dot(&normal, &normal);
            each(|i| squared[i].sqrt())
        };
        let (a, b) = (dot(&normal, refracted), dot_one(&normal, normal_out));
        let minus_mu0 = dot_one(refracted, normal_out);
        let mut shared = Shared {
            r2,
            x: dot(offset, refracted),
            across,
            n: dot_one(offset, normal_out),
            mu0: each(|i| -minus_mu0[i]),
            a: each(|i| a[i] / length[i]),
            b: each(|i| b[i] / length[i]),
        };
        for i in 0..LANES {
            if length[i] <= NULL_DIRECTION {
                (shared.a[i], shared.b[i]) = other_mirror(unit.map(|c| c[i]), refracted.map(|c| c[i]), normal_out);
            }
        }
        shared
    }
}

/// `n*·ω12` and `n*·n_o` where `n_i` runs along `x` (method.md 5.6).
#[cold]
fn other_mirror(unit: [f32; 3], refracted: [f32; 3], normal_out: [f32; 3]) -> (f32, f32) {
    let [unit, refracted, normal_out] = [unit, refracted, normal_out].map(glam::Vec3::from_array);
    for candidate in [-refracted, normal_out] {
        let projected = candidate - candidate.dot(unit) * unit;
        if projected.length() > NULL_DIRECTION {
            let normal = projected.normalize();
            return (normal.dot(refracted), normal.dot(normal_out));
        }
    }
    (0.0, 0.0)
}

//! The half-space model on blocks; see [`HalfSpace`](super::half_space::HalfSpace) for the model.
//!
//! The corrections are read from the profiles of the channels by the bits of the squared distance, and go into the
//! exponent of the decay, so that they cost no exponential of their own.

use super::half_space::{absorbed, blur2};
use crate::{
    half_space::{
        GRAZING, SOFTNESS2, exit_moment,
        layout::UNIT,
        profile::{FARTHEST2, LOW_UNITS, NEAREST2, Profile, SHIFT, START, WORDS, low_terms, place},
    },
    lanes::{
        block::{Block, LANES, Lane, LaneModel},
        distances::Distances,
        exp::{decay2, exp2_negative, log2_near_one},
    },
    medium::{Coefficients, Medium},
};
use std::f64::consts::LOG2_E;

/// The constants of one channel, lengths in units of `1/σ_t'`.
#[derive(Clone, Debug)]
struct Channel {
    /// `σ_t'`, 1/m, and its square.
    reduced: f32,
    reduced2: f32,
    /// `−κ log₂ e`: the exponent of 2 that belongs to a distance.
    exponent: f32,
    /// `z_b`.
    extrapolation: f32,
    /// The coefficients of `m⁰` to `m⁴` that hold at any distance, over the unit of the words.
    constant: [f32; 5],
    /// `α' σ_t'²/(m_0 8πAD)`, 1/(m² sr); 0 where nothing scatters.
    prefactor: f32,
    words: Box<[u32; WORDS]>,
}

/// The half-space model of one medium.
#[derive(Clone, Debug)]
pub struct HalfSpaceLanes {
    channels: [Channel; 3],
    /// `m = scale μ12 + shift`.
    place: [f32; 2],
    /// The squared distance within which the direction of an offset loses its meaning, m².
    blur2: f32,
}

/// What the channels share.
struct Geometry {
    /// `r²`, m².
    r2: Lane,
    /// `2 (x_t·ω12 + z μ12)`, m.
    twice: Lane,
    /// `z = |x·n_i|`, m.
    depth: Lane,
    /// `μ12`, and `m`.
    cosine: Lane,
    place: Lane,
    /// `W = −log₂(1.01 − w)` and `w²`, times the units of `p` and `q`.
    forward: Lane,
    square: Lane,
}

impl LaneModel for HalfSpaceLanes {
    fn new(medium: &Medium) -> Self {
        let channels = [0, 1, 2].map(|k| Channel::new(&medium.channels[k], medium.eta));
        let place = place(medium.eta).map(|x| x as f32);
        let blur2 = blur2(medium).clamp(f64::from(f32::MIN_POSITIVE), f64::from(f32::MAX));
        HalfSpaceLanes { channels, place, blur2: blur2 as f32 }
    }

    #[inline(always)]
    fn bare(&self, block: &Block, _normal_out: [f32; 3]) -> [Lane; 3] {
        let geometry = self.geometry(block);
        let [red, green, blue] = &self.channels;
        [red.bare(&geometry), green.bare(&geometry), blue.bare(&geometry)]
    }
}

impl HalfSpaceLanes {
    #[inline(always)]
    fn geometry(&self, block: &Block) -> Geometry {
        let zero = [0.0; LANES];
        let mut g =
            Geometry { r2: zero, twice: zero, depth: zero, cosine: zero, place: zero, forward: zero, square: zero };
        let ([x, y, z], [nx, ny, nz], [wx, wy, wz]) = (&block.offset, &block.normal_in, &block.refracted);
        for i in 0..LANES {
            let r2 = x[i] * x[i] + y[i] * y[i] + z[i] * z[i];
            let normal = x[i] * nx[i] + y[i] * ny[i] + z[i] * nz[i];
            let cosine = -(wx[i] * nx[i] + wy[i] * ny[i] + wz[i] * nz[i]);
            let along = x[i] * wx[i] + y[i] * wy[i] + z[i] * wz[i] + normal * cosine; // x_t·ω12
            let place = self.place[0] * cosine + self.place[1];
            let forward = along / (r2 + self.blur2).sqrt();
            let forward = if forward < 1.0 { forward } else { 1.0 };
            let place = if place > 0.0 { place } else { 0.0 };
            g.r2[i] = r2;
            g.depth[i] = normal.abs();
            g.twice[i] = 2.0 * along;
            g.cosine[i] = cosine;
            g.place[i] = if place < 1.0 { place } else { 1.0 };
            g.forward[i] = -LOW_UNITS[2] as f32 * log2_near_one(GRAZING as f32 - forward);
            g.square[i] = LOW_UNITS[1] as f32 * (forward * forward);
        }
        g
    }
}

impl Channel {
    fn new(c: &Coefficients, eta: f64) -> Channel {
        // Where nothing scatters the prefactor is 0, and the lengths of any medium do.
        let scatters = c.scatters();
        let c = if scatters { c } else { &Coefficients { sigma_a: 1.0, sigma_s: 1.0, asymmetry: 0.0 } };
        let reduced = c.reduced_extinction();
        let profile = Profile::new(absorbed(c), c.asymmetry, eta);
        let prefactor = c.reduced_albedo() * reduced * reduced / exit_moment(0, eta) * profile.images.strength;
        Channel {
            reduced: reduced as f32,
            reduced2: (reduced * reduced) as f32,
            exponent: (-profile.images.transport * LOG2_E) as f32,
            extrapolation: profile.images.extrapolation as f32,
            constant: profile.constant.map(|x| (x / UNIT) as f32),
            prefactor: if scatters { prefactor as f32 } else { 0.0 },
            words: profile.words,
        }
    }

    #[inline(always)]
    fn bare(&self, g: &Geometry) -> Lane {
        let correction = self.corrections(g);
        let mut values = [0.0; LANES];
        for i in 0..LANES {
            let depth = g.depth[i] * self.reduced;
            let depth = depth / (1.0 + depth); // z̃ (15.3)
            let ahead = g.twice[i] * self.reduced + 2.0 * depth * g.cosine[i];
            let real2 = g.r2[i] * self.reduced2 + (1.0 + SOFTNESS2 as f32) - ahead; // d_r² (15.3)
            let delta2 = 4.0 * (depth + self.extrapolation) * (g.cosine[i] + self.extrapolation); // d_v² − d_r² (15.3)
            let d = Distances::new(real2, real2 + delta2, delta2);
            let (_, one_minus_decay) = decay2(self.exponent * d.delta);
            let difference = (d.delta * d.over_real + one_minus_decay) * d.over_virtual; // (15.4) over e^{−κ d_r}
            let value = self.prefactor * difference * exp2_negative(self.exponent * d.real + correction[i]);
            // `value` is NaN where a distance left the range of float32: S is far below that range there.
            values[i] = if value > 0.0 { value } else { 0.0 };
        }
        values
    }

    /// The exponents of 2 of the corrections (docs/method.md 15.5, 15.6).
    #[inline(always)]
    fn corrections(&self, g: &Geometry) -> Lane {
        let mut corrections = [0.0; LANES];
        for i in 0..LANES {
            let r2 = g.r2[i] * self.reduced2;
            let r2 = if r2 > NEAREST2 { r2 } else { NEAREST2 };
            let bits = (if r2 < LAST2 { r2 } else { LAST2 }).to_bits();
            let at = 2 * ((bits >> SHIFT) - START) as usize;
            let t = (bits & ((1 << SHIFT) - 1)) as f32 * (1.0 / (1u32 << SHIFT) as f32);
            let m = g.place[i];
            let azimuth = [g.forward[i], g.square[i]];
            let near = terms(self.words[at & (WORDS - 1)], self.words[(at + 1) & (WORDS - 1)], m, azimuth);
            let far = terms(self.words[(at + 2) & (WORDS - 1)], self.words[(at + 3) & (WORDS - 1)], m, azimuth);
            let [a, b, c, d, e] = self.constant;
            let constant = a + m * (b + m * (c + m * (d + m * e)));
            corrections[i] = (near + t * (far - near) + constant) * UNIT as f32;
        }
        corrections
    }
}

/// The largest squared distance below [`FARTHEST2`].
const LAST2: f32 = FARTHEST2.next_down();

/// `c₀ + m (c₁ + m c₂) + p W + q w²` of the words of a step.
#[inline(always)]
fn terms(high: u32, low: u32, m: f32, [forward, square]: [f32; 2]) -> f32 {
    let (first, second) = ((high as i32 >> 16) as f32, ((high << 16) as i32 >> 16) as f32);
    let [third, q, p] = low_terms(low);
    first + m * (second + m * (third as f32 * LOW_UNITS[0] as f32)) + p as f32 * forward + q as f32 * square
}

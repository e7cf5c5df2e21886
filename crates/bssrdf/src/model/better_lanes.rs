//! The better dipole on blocks; see [`BetterDipole`](super::better_dipole::BetterDipole) for the model.
//!
//! The difference of the two fluences is taken from the difference of their distances, so that it does not cancel far
//! away (docs/method.md section 9).

use crate::{
    lanes::{
        block::{Block, Lane, LaneModel, by_distance},
        distances::Distances,
        exp::{decay2, exp2_negative},
    },
    medium::Medium,
};
use std::f64::consts::{LOG2_E, PI};

/// The constants of one channel, lengths in units of `1/σ_t'`: there `z_r = 1`.
#[derive(Clone, Copy, Debug)]
struct Channel {
    /// `σ_t'²`, 1/m²: what squared lengths in m² are multiplied by.
    reduced2: f32,
    /// `σ̂_tr = σ_tr/σ_t'`, and `−σ̂_tr log₂ e`: the exponent of 2 that belongs to a distance.
    transport: f32,
    exponent: f32,
    /// `z_v` (4.2).
    virtual_depth: f32,
    /// `C_φ/D` (4.3).
    fluence: f32,
    /// `C_E` (4.3).
    vector: f32,
    /// `α'² σ_t'²/(4π)` (4.3) over `4π C_φ(1/η)` (4.5), 1/m²; 0 where nothing scatters.
    prefactor: f32,
}

/// The better dipole of one medium, channel by channel.
#[derive(Clone, Debug)]
pub struct BetterLanes([Channel; 3]);

impl LaneModel for BetterLanes {
    fn new(medium: &Medium) -> Self {
        let boundary = &medium.interface;
        BetterLanes(medium.channels.map(|c| {
            let reduced = c.reduced_extinction();
            let scatters = c.scatters();
            // Where the prefactor is 0, the other constants may have any finite value.
            let diffusion = if scatters { c.grosjean_diffusion() * reduced } else { 1.0 };
            let transport = if scatters { c.grosjean_transport() / reduced } else { 0.0 };
            let norm = PI * boundary.exit_norm;
            Channel {
                reduced2: (reduced * reduced) as f32,
                transport: transport as f32,
                exponent: (-transport * LOG2_E) as f32,
                virtual_depth: (1.0 + 4.0 * boundary.reflection * diffusion) as f32,
                fluence: (boundary.c_phi / diffusion) as f32,
                vector: boundary.c_e as f32,
                prefactor: (c.reduced_albedo().powi(2) * reduced * reduced / (4.0 * PI) / norm) as f32,
            }
        }))
    }

    #[inline(always)]
    fn bare(&self, block: &Block, _normal_out: [f32; 3]) -> [Lane; 3] {
        by_distance(block, self.0, Channel::bare)
    }
}

impl Channel {
    /// `S_bare` (docs/method.md 4.3, 4.5) of `r²`, m².
    #[inline(always)]
    fn bare(&self, r2: f32) -> f32 {
        let r2 = r2 * self.reduced2;
        let virtual_depth2 = self.virtual_depth * self.virtual_depth;
        // d_r², d_v² (3.3), δd² = z_v² − z_r²
        let d = Distances::new(r2 + 1.0, r2 + virtual_depth2, virtual_depth2 - 1.0);
        let q_real = self.transport * d.real; // q_r = σ_tr d_r
        let q_virtual = q_real + self.transport * d.delta; // q_v = σ_tr d_v
        let (decay, one_minus_decay) = decay2(self.exponent * d.delta); // e^{−δq}, 1 − e^{−δq}
        let over_real2 = d.over_real * d.over_real;
        let over_virtual2 = d.over_virtual * d.over_virtual;
        let real = (1.0 + q_real) * over_real2 * d.over_real; // z_r (1 + q_r)/d_r³
        // z_v (1 + q_v)/d_v³ e^{−δq}
        let mirrored = self.virtual_depth * (1.0 + q_virtual) * over_virtual2 * d.over_virtual * decay;
        let difference = (d.delta * d.over_real + one_minus_decay) * d.over_virtual; // 1/d_r − e^{−δq}/d_v
        let sources = self.vector * (real + mirrored) + self.fluence * difference; // {...} (4.3) over e^{−q_r}
        let value = self.prefactor * exp2_negative(self.exponent * d.real) * sources;
        // `value` is NaN where a distance left the range of float32: S is far below that range there.
        if value > 0.0 { value } else { 0.0 }
    }
}

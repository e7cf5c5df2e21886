//! The better dipole on blocks; see `better_dipole.rs` for the model.
//!
//! The difference of the two fluences is taken from the difference of their distances, so that it does not cancel far
//! away (method.md section 9).

use super::{
    Block, Lane, LaneModel, by_distance,
    dipole::Distances,
    exp::{decay2, exp2_negative},
};
use crate::Medium;
use std::f64::consts::{LOG2_E, PI};

/// One channel, lengths in units of 1/σ_t'.
#[derive(Clone, Copy, Debug)]
struct Channel {
    /// `σ_t'²`, 1/m².
    scale2: f32,
    /// `σ_tr`, and `−σ_tr log₂ e`.
    transport: f32,
    fall: f32,
    virtual_depth: f32,
    /// `C_φ/D`.
    fluence: f32,
    /// `C_E`.
    vector: f32,
    /// `α'² σ_t'²/(4π)` over the exit normalisation, 1/m²; 0 where nothing scatters.
    prefactor: f32,
}

/// The better dipole of one medium.
#[derive(Clone, Debug)]
pub struct BetterLanes {
    channels: [Channel; 3],
}

impl LaneModel for BetterLanes {
    fn new(medium: &Medium) -> Self {
        let boundary = &medium.interface;
        let channels = medium.channels.map(|c| {
            let reduced = c.reduced_extinction();
            let scatters = c.scatters();
            // Any finite values do where the prefactor is 0.
            let diffusion = if scatters { c.grosjean_diffusion() * reduced } else { 1.0 };
            let transport = if scatters { c.grosjean_transport() / reduced } else { 0.0 };
            let norm = PI * boundary.exit_norm;
            Channel {
                scale2: (reduced * reduced) as f32,
                transport: transport as f32,
                fall: (-transport * LOG2_E) as f32,
                virtual_depth: (1.0 + 4.0 * boundary.reflection * diffusion) as f32,
                fluence: (boundary.c_phi / diffusion) as f32,
                vector: boundary.c_e as f32,
                prefactor: (c.reduced_albedo().powi(2) * reduced * reduced / (4.0 * PI) / norm) as f32,
            }
        });
        BetterLanes { channels }
    }

    #[inline(always)]
    fn bare(&self, block: &Block, _normal_out: [f32; 3]) -> [Lane; 3] {
        by_distance(block, self.channels, Channel::bare)
    }
}

impl Channel {
    #[inline(always)]
    fn bare(&self, r2: f32) -> f32 {
        let r2 = r2 * self.scale2;
        let depth2 = self.virtual_depth * self.virtual_depth;
        let d = Distances::new(r2 + 1.0, r2 + depth2, depth2 - 1.0);
        let q_real = self.transport * d.real;
        let q_virtual = q_real + self.transport * d.delta;
        let (stays, fades) = decay2(self.fall * d.delta);
        let over_real2 = d.over_real * d.over_real;
        let over_virtual2 = d.over_virtual * d.over_virtual;
        let real = (1.0 + q_real) * over_real2 * d.over_real;
        let mirrored = self.virtual_depth * (1.0 + q_virtual) * over_virtual2 * d.over_virtual * stays;
        // e^{q_r} (e^{−q_r}/d_r − e^{−q_v}/d_v)
        let difference = (d.delta * d.over_real + fades) * d.over_virtual;
        let sources = self.vector * (real + mirrored) + self.fluence * difference;
        let value = self.prefactor * exp2_negative(self.fall * d.real) * sources;
        // No number where a distance left the range of float32: S is far below it there.
        if value > 0.0 { value } else { 0.0 }
    }
}

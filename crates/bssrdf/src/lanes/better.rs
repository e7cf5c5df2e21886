//! The better dipole on blocks; see `better_dipole.rs` for the model.
//!
//! The difference of the two fluences is taken from the difference of their distances, so that it does not cancel far
//! away (method.md section 9).

use super::{Block, Lane, LaneModel, dot, each, exp::decay, exp_negative};
use crate::Medium;
use std::f64::consts::PI;

/// One channel, lengths in units of 1/σ_t'.
#[derive(Clone, Copy, Debug)]
struct Channel {
    /// `σ_t'`, 1/m.
    scale: f32,
    transport: f32,
    virtual_depth: f32,
    /// `C_φ/D`.
    fluence: f32,
    /// `C_E`.
    vector: f32,
    /// `α'² σ_t'²/(4π)` over the exit normalisation, 1/m²; 0 where nothing scatters.
    strength: f32,
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
            // Any finite values do where the strength is 0.
            let diffusion = if scatters { c.grosjean_diffusion() * reduced } else { 1.0 };
            let norm = PI * boundary.exit_norm;
            Channel {
                scale: reduced as f32,
                transport: if scatters { (c.grosjean_transport() / reduced) as f32 } else { 0.0 },
                virtual_depth: (1.0 + 4.0 * boundary.reflection * diffusion) as f32,
                fluence: (boundary.c_phi / diffusion) as f32,
                vector: boundary.c_e as f32,
                strength: (c.reduced_albedo().powi(2) * reduced * reduced / (4.0 * PI) / norm) as f32,
            }
        });
        BetterLanes { channels }
    }

    #[inline(always)]
    fn bare(&self, block: &Block, _normal_out: [f32; 3]) -> [Lane; 3] {
        let r2 = dot(&block.offset, &block.offset);
        self.channels.map(|c| each(|i| c.bare(r2[i])))
    }
}

impl Channel {
    #[inline(always)]
    fn bare(&self, r2: f32) -> f32 {
        let r2 = r2 * self.scale * self.scale;
        let real2 = r2 + 1.0;
        let virtual2 = r2 + self.virtual_depth * self.virtual_depth;
        let (real, mirrored) = (real2.sqrt(), virtual2.sqrt());
        // δ = d_v − d_r (9.1)
        let delta = (self.virtual_depth * self.virtual_depth - 1.0) / (real + mirrored);
        let (q_real, q_virtual) = (self.transport * real, self.transport * mirrored);
        let e_real = exp_negative(-q_real);
        let (stays, fades) = decay(self.transport * delta);
        let e_virtual = e_real * stays;
        let vector = self.vector
            * ((1.0 + q_real) * e_real / (real2 * real)
                + self.virtual_depth * (1.0 + q_virtual) * e_virtual / (virtual2 * mirrored));
        // e^{−q_r}/d_r − e^{−q_v}/d_v
        let difference = e_real * (delta + real * fades) / (real * mirrored);
        let value = self.strength * (vector + self.fluence * difference);
        // No number where a distance left the range of float32: S is far below it there.
        if value > 0.0 { value } else { 0.0 }
    }
}

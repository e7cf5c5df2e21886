//! The standard dipole on blocks; see `standard_dipole.rs` for the model.

use super::{Block, Lane, LaneModel, by_distance, exp::exp2_negative};
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
    /// `α' σ_t'²/(4π²)`, 1/m²; 0 where nothing scatters.
    prefactor: f32,
}

/// The standard dipole of one medium.
#[derive(Clone, Debug)]
pub struct StandardLanes {
    channels: [Channel; 3],
}

impl LaneModel for StandardLanes {
    fn new(medium: &Medium) -> Self {
        let channels = medium.channels.map(|c| {
            let reduced = c.reduced_extinction();
            let transport = if c.scatters() { c.transport() / reduced } else { 0.0 };
            Channel {
                scale2: (reduced * reduced) as f32,
                transport: transport as f32,
                fall: (-transport * LOG2_E) as f32,
                virtual_depth: (1.0 + 4.0 / 3.0 * medium.interface.reflection_egan) as f32,
                prefactor: (c.reduced_albedo() * reduced * reduced / (4.0 * PI * PI)) as f32,
            }
        });
        StandardLanes { channels }
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
        let (real2, virtual2) = (r2 + 1.0, r2 + self.virtual_depth * self.virtual_depth);
        let (real, mirrored) = (real2.sqrt(), virtual2.sqrt());
        // One division for both 1/d.
        let inverse = 1.0 / (real * mirrored);
        let (over_real, over_virtual) = (inverse * mirrored, inverse * real);
        let real = self.source(real) * (over_real * over_real * over_real);
        let mirrored = self.source(mirrored) * (over_virtual * over_virtual * over_virtual);
        let value = self.prefactor * (real + self.virtual_depth * mirrored);
        // No number where a distance left the range of float32: S is far below it there.
        if value > 0.0 { value } else { 0.0 }
    }

    /// `(1 + q) e^{−q}`.
    #[inline(always)]
    fn source(&self, distance: f32) -> f32 {
        (1.0 + self.transport * distance) * exp2_negative(self.fall * distance)
    }
}

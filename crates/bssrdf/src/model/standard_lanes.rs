//! The standard dipole on blocks; see [`StandardDipole`](super::standard_dipole::StandardDipole) for the model.

use crate::{
    lanes::{
        block::{Block, Lane, LaneModel, by_distance},
        exp::exp2_negative,
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
    /// `z_v` (3.2).
    virtual_depth: f32,
    /// `α' σ_t'²/(4π²)` (3.4, 3.6), 1/m²; 0 where nothing scatters.
    prefactor: f32,
}

/// The standard dipole of one medium, channel by channel.
#[derive(Clone, Debug)]
pub struct StandardLanes([Channel; 3]);

impl LaneModel for StandardLanes {
    fn new(medium: &Medium) -> Self {
        StandardLanes(medium.channels.map(|c| {
            let reduced = c.reduced_extinction();
            let transport = if c.scatters() { c.transport() / reduced } else { 0.0 };
            Channel {
                reduced2: (reduced * reduced) as f32,
                transport: transport as f32,
                exponent: (-transport * LOG2_E) as f32,
                virtual_depth: (1.0 + 4.0 / 3.0 * medium.interface.reflection_egan) as f32,
                prefactor: (c.reduced_albedo() * reduced * reduced / (4.0 * PI * PI)) as f32,
            }
        }))
    }

    #[inline(always)]
    fn bare(&self, block: &Block, _normal_out: [f32; 3]) -> [Lane; 3] {
        by_distance(block, self.0, Channel::bare)
    }
}

impl Channel {
    /// `S_bare` (docs/method.md 3.4, 3.6) of `r²`, m².
    #[inline(always)]
    fn bare(&self, r2: f32) -> f32 {
        let r2 = r2 * self.reduced2;
        let (real2, virtual2) = (r2 + 1.0, r2 + self.virtual_depth * self.virtual_depth); // d_r², d_v² (3.3)
        let (d_real, d_virtual) = (real2.sqrt(), virtual2.sqrt());
        // One division for both 1/d.
        let inverse = 1.0 / (d_real * d_virtual);
        let (over_real, over_virtual) = (inverse * d_virtual, inverse * d_real);
        let real_source = self.decay(d_real) * (over_real * over_real * over_real);
        let virtual_source = self.decay(d_virtual) * (over_virtual * over_virtual * over_virtual);
        let value = self.prefactor * (real_source + self.virtual_depth * virtual_source);
        // `value` is NaN where a distance left the range of float32: S is far below that range there.
        if value > 0.0 { value } else { 0.0 }
    }

    /// `(1 + q) e^{−q}` with `q = σ_tr d` (3.4).
    #[inline(always)]
    fn decay(&self, distance: f32) -> f32 {
        (1.0 + self.transport * distance) * exp2_negative(self.exponent * distance)
    }
}

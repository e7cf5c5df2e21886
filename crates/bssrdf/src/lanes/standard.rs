//! The standard dipole on blocks; see `standard_dipole.rs` for the model.

use super::{Block, Lane, LaneModel, dot, each, exp_negative};
use crate::Medium;
use std::f64::consts::PI;

/// One channel, lengths in units of 1/σ_t'.
#[derive(Clone, Copy, Debug)]
struct Channel {
    /// `σ_t'`, 1/m.
    scale: f32,
    transport: f32,
    virtual_depth: f32,
    /// `α' σ_t'²/(4π²)`, 1/m²; 0 where nothing scatters.
    strength: f32,
}

/// The standard dipole of one medium.
#[derive(Clone, Debug)]
pub struct StandardLanes {
    channels: [Channel; 3],
}

/// `z (1 + q) e^{−q}/d³`.
#[inline(always)]
fn source(r2: f32, depth: f32, transport: f32) -> f32 {
    let d2 = r2 + depth * depth;
    let d = d2.sqrt();
    let q = transport * d;
    depth * (1.0 + q) * exp_negative(-q) / (d2 * d)
}

impl LaneModel for StandardLanes {
    fn new(medium: &Medium) -> Self {
        let channels = medium.channels.map(|c| {
            let reduced = c.reduced_extinction();
            let scatters = c.scatters();
            Channel {
                scale: reduced as f32,
                transport: if scatters { (c.transport() / reduced) as f32 } else { 0.0 },
                virtual_depth: (1.0 + 4.0 / 3.0 * medium.interface.reflection_egan) as f32,
                strength: (c.reduced_albedo() * reduced * reduced / (4.0 * PI * PI)) as f32,
            }
        });
        StandardLanes { channels }
    }

    #[inline(always)]
    fn bare(&self, block: &Block, _normal_out: [f32; 3]) -> [Lane; 3] {
        let r2 = dot(&block.offset, &block.offset);
        self.channels.map(|c| {
            each(|i| {
                let r2 = r2[i] * c.scale * c.scale;
                let value = c.strength * (source(r2, 1.0, c.transport) + source(r2, c.virtual_depth, c.transport));
                // No number where a distance left the range of float32: S is far below it there.
                if value > 0.0 { value } else { 0.0 }
            })
        })
    }
}

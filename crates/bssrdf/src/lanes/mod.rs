//! The models in float32, sixteen samples at a time.
//!
//! Every length is taken in units of `1/σ_t'`, which makes the diffusion coefficient of the dipoles 1/3 and leaves only
//! `α'`, `η` and `σ_t'/σ_t` (method.md section 8). The float64 models of this crate are the reference.

mod better;
mod directional;
mod exp;
mod standard;

pub use better::BetterLanes;
pub use directional::DirectionalLanes;
pub use exp::exp_negative;
pub use standard::StandardLanes;

use crate::Medium;

/// Samples evaluated together.
pub const LANES: usize = 16;

/// One number for each of sixteen samples.
pub type Lane = [f32; LANES];

/// Sixteen samples seen from an exitant point.
#[derive(Clone, Copy, Debug)]
#[repr(align(64))]
pub struct Block {
    /// `x = x_o − x_i`, m.
    pub offset: [Lane; 3],
    /// `n_i`.
    pub normal_in: [Lane; 3],
    /// `ω12`.
    pub refracted: [Lane; 3],
}

/// A BSSRDF of one medium, evaluated on blocks.
pub trait LaneModel: Send + Sync {
    /// The model of `medium`.
    fn new(medium: &Medium) -> Self;

    /// `S_bare` of the three channels, 1/(m² sr); `normal_out` is `n_o`.
    fn bare(&self, block: &Block, normal_out: [f32; 3]) -> [Lane; 3];
}

/// Applies `f` to every lane number.
#[inline(always)]
fn each(f: impl Fn(usize) -> f32) -> Lane {
    let mut lane = [0.0; LANES];
    for (i, value) in lane.iter_mut().enumerate() {
        *value = f(i);
    }
    lane
}

/// The dot product of two lane vectors.
#[inline(always)]
fn dot(a: &[Lane; 3], b: &[Lane; 3]) -> Lane {
    each(|i| a[0][i] * b[0][i] + a[1][i] * b[1][i] + a[2][i] * b[2][i])
}

/// The dot product of a lane vector with one vector.
#[inline(always)]
fn dot_one(a: &[Lane; 3], b: [f32; 3]) -> Lane {
    each(|i| a[0][i] * b[0] + a[1][i] * b[1] + a[2][i] * b[2])
}

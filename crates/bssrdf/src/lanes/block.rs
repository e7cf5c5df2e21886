//! Sixteen samples side by side, and what evaluates a BSSRDF on them.

use crate::medium::Medium;

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

/// The values of a function of the lane's number.
#[inline(always)]
pub(crate) fn each(f: impl Fn(usize) -> f32) -> Lane {
    let mut lane = [0.0; LANES];
    for (i, value) in lane.iter_mut().enumerate() {
        *value = f(i);
    }
    lane
}

/// `S_bare` of a model that depends on the distance alone: `bare` of each channel and of `r²`, m².
#[inline(always)]
pub(crate) fn by_distance<C: Copy>(block: &Block, channels: [C; 3], bare: impl Fn(&C, f32) -> f32) -> [Lane; 3] {
    let [x, y, z] = &block.offset;
    let r2 = each(|i| x[i] * x[i] + y[i] * y[i] + z[i] * z[i]);
    let mut values = [[0.0; LANES]; 3];
    for (c, values) in channels.into_iter().zip(&mut values) {
        *values = each(|i| bare(&c, r2[i]));
    }
    values
}

/// `a·b`.
#[inline(always)]
pub(crate) fn dot(a: [f32; 3], b: [f32; 3]) -> f32 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// `a × b`.
#[inline(always)]
pub(crate) fn cross(a: [f32; 3], b: [f32; 3]) -> [f32; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

//! What dipoles have in common: two distances and how they differ (method.md 9.1).

/// The distances of an exitant point from the two sources, in the unit of their squares.
#[derive(Clone, Copy)]
pub(super) struct Distances {
    /// `d_r`.
    pub real: f32,
    /// `1/d_r`.
    pub over_real: f32,
    /// `1/d_v`.
    pub over_virtual: f32,
    /// `δ = d_v − d_r`, without cancellation.
    pub delta: f32,
}

impl Distances {
    /// From `d_r²`, `d_v²` and `δd² = d_v² − d_r²`.
    #[inline(always)]
    pub fn new(real2: f32, virtual2: f32, delta2: f32) -> Distances {
        let (real, mirrored) = (real2.sqrt(), virtual2.sqrt());
        // One division, which costs as much as twenty multiplications, does for three.
        let (product, sum) = (real * mirrored, real + mirrored);
        let inverse = 1.0 / (product * sum);
        let over_product = inverse * sum;
        Distances {
            real,
            over_real: over_product * mirrored,
            over_virtual: over_product * real,
            delta: delta2 * (inverse * product),
        }
    }
}

//! The distances of a dipole's two sources from the exitant point, and their difference.

/// The distances (docs/method.md 9.1), in any unit of length.
#[derive(Clone, Copy)]
pub(crate) struct Distances {
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
    /// Takes `d_r²`, `d_v²` and `δd² = d_v² − d_r²`.
    #[inline(always)]
    pub fn new(real2: f32, virtual2: f32, delta2: f32) -> Distances {
        let (d_real, d_virtual) = (real2.sqrt(), virtual2.sqrt());
        // One division instead of three: it costs as much as twenty multiplications.
        let (product, sum) = (d_real * d_virtual, d_real + d_virtual);
        let inverse = 1.0 / (product * sum);
        let over_product = inverse * sum; // 1/(d_r d_v)
        Distances {
            real: d_real,
            over_real: over_product * d_virtual,
            over_virtual: over_product * d_real,
            delta: delta2 * (inverse * product), // δ = δd²/(d_r + d_v)
        }
    }
}

//! A block of sixteen separations as a kernel evaluates it.

use bssrdf::{
    DVec3, Separation,
    lanes::{Block, LANES, Lane, LaneModel},
    simd::Kernel,
};

/// One evaluation of a block.
pub struct Evaluate<'a, M> {
    pub model: &'a M,
    pub block: Block,
    pub normal_out: [f32; 3],
}

impl<'a, M> Evaluate<'a, M> {
    pub fn new(model: &'a M, separations: &[Separation; LANES]) -> Self {
        let lanes = |f: fn(&Separation) -> DVec3| [0, 1, 2].map(|c| separations.map(|s| f(&s)[c] as f32));
        let block =
            Block { offset: lanes(|s| s.offset), normal_in: lanes(|s| s.normal_in), refracted: lanes(|s| s.refracted) };
        Evaluate { model, block, normal_out: separations[0].normal_out.as_vec3().to_array() }
    }
}

impl<M: LaneModel> Kernel for Evaluate<'_, M> {
    type Output = [Lane; 3];

    #[inline(always)]
    fn run(self) -> [Lane; 3] {
        self.model.bare(&self.block, self.normal_out)
    }
}

//! A BSSRDF in two parts by distance: `S = w S + (1 − w) S` (docs/method.md 17.1).
//!
//! The samples of a cloud are some distance apart, and where light travels less far than that, a sum over them is grain.
//! They carry the far part `w S`; the near part is sampled around the exitant point.

use crate::{
    evaluate::{Bssrdf, Separation},
    lanes::block::{Block, Lane, LaneModel, each},
    medium::Medium,
};

/// Where the near part of a BSSRDF ends: `w` is a smooth step of the squared distance, from 0 to 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Partition {
    /// The squared distance where the step begins, m².
    start: f64,
    /// The inverse of its width, 1/m².
    inverse: f64,
}

impl Partition {
    /// No near part: `w` is exactly 1 at any distance.
    pub const NONE: Partition = Partition { start: -1.0, inverse: 1.0 };

    /// A step between two distances, m.
    pub fn new(from: f64, to: f64) -> Partition {
        Partition { start: from * from, inverse: 1.0 / (to * to - from * from) }
    }

    /// `w` at a squared distance, m².
    #[inline(always)]
    pub fn far(&self, r2: f64) -> f64 {
        let t = ((r2 - self.start) * self.inverse).clamp(0.0, 1.0);
        t * t * (3.0 - 2.0 * t)
    }
}

/// The far part of a model.
#[derive(Clone, Debug)]
pub struct Far<M> {
    pub model: M,
    pub partition: Partition,
}

impl<M: LaneModel> LaneModel for Far<M> {
    fn new(medium: &Medium) -> Self {
        Far { model: M::new(medium), partition: Partition::NONE }
    }

    #[inline(always)]
    fn bare(&self, block: &Block, normal_out: [f32; 3]) -> [Lane; 3] {
        let mut values = self.model.bare(block, normal_out);
        let [x, y, z] = &block.offset;
        let (start, inverse) = (self.partition.start as f32, self.partition.inverse as f32);
        let far = each(|i| {
            let r2 = x[i] * x[i] + y[i] * y[i] + z[i] * z[i];
            let t = ((r2 - start) * inverse).clamp(0.0, 1.0);
            t * t * (3.0 - 2.0 * t)
        });
        for channel in &mut values {
            for i in 0..channel.len() {
                channel[i] *= far[i];
            }
        }
        values
    }
}

impl Bssrdf for Far<Box<dyn Bssrdf>> {
    fn bare(&self, channel: usize, s: &Separation) -> f64 {
        self.model.bare(channel, s) * self.partition.far(s.offset.length_squared())
    }

    fn transport(&self) -> [f64; 3] {
        self.model.transport()
    }
}

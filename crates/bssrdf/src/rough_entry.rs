//! The share of light that enters through a rough interface, by the cosine of its direction.

use bsdf::RoughBoundary;
use std::sync::Arc;

/// Intervals of the table, even in the root of the cosine. Between its entries the transmittance is off by less than
/// 0.002 at cosines above 0.05.
const INTERVALS: usize = 128;

/// `T12` of a rough interface from outside. Copies share the table.
#[derive(Clone, Debug)]
pub struct RoughEntry(Arc<[f32; INTERVALS + 1]>);

impl RoughEntry {
    /// That of a boundary with one roughness; its square is `α`.
    pub fn new(boundary: &RoughBoundary, roughness: f64) -> RoughEntry {
        let at = |k: usize| {
            let root = (k as f64 / INTERVALS as f64).max(1e-3);
            boundary.transmittance(root * root, roughness) as f32
        };
        RoughEntry(Arc::new(std::array::from_fn(at)))
    }

    /// `T12` at a cosine above 0.
    #[inline(always)]
    pub fn at(&self, cosine: f32) -> f32 {
        let x = cosine.clamp(0.0, 1.0).sqrt() * INTERVALS as f32;
        let k = (x as usize).min(INTERVALS - 1);
        self.0[k] + (self.0[k + 1] - self.0[k]) * (x - k as f32)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lanes::{EntryRefraction, LANES};

    #[test]
    fn sixteen_samples_enter_as_the_boundary_says() {
        let boundary = RoughBoundary::new(1.4, 0.6);
        let entry = EntryRefraction::new(1.4).behind(&RoughEntry::new(&boundary, 0.6));
        let up = [[0; LANES], [0; LANES], [1000; LANES]];
        let slanted: [i32; LANES] = std::array::from_fn(|i| 2000 * i as i32 - 2000);
        let entered = entry.enter(&up, &[[9000; LANES], [0; LANES], slanted]);
        for (i, z) in slanted.into_iter().map(f64::from).enumerate() {
            let expected = boundary.transmittance(z / (z * z + 9000.0 * 9000.0).sqrt(), 0.6);
            assert!((f64::from(entered.transmittance[i]) - expected).abs() < 1e-3, "{z}: {expected}");
        }
        assert_eq!(entered.transmittance[..2], [0.0; 2]);
    }
}

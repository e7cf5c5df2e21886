//! The factor between the error that the cut predicts and the error that it has.

/// A factor of the target error of a cut that makes its true error meet the target. It is a function of the predicted
/// sum, since the nodes that matter in shadow are not those that matter in light.
#[derive(Clone, Debug)]
pub struct CutCorrection(Box<[f32; ENTRIES]>);

/// The factors are indexed by the bits of a float64 above this one: two steps for each doubling of the sum, from 2⁻²⁵⁶
/// to 2²⁵⁶.
const SHIFT: u32 = 51;
const ENTRIES: usize = 1 << 10;
/// The index of 2⁻²⁵⁶.
const FIRST: u64 = (1023 - 256) << 1;

impl CutCorrection {
    /// Takes pairs of a predicted sum, W/(m² sr), and its factor, in order of the sums. Between them the logarithm of
    /// the factor is linear in the logarithm of the sum; beyond them the factor is constant. Without any pair it is 1.
    pub fn new(known: &[(f64, f64)]) -> CutCorrection {
        let middle = |k: usize| f64::from_bits((k as u64 + FIRST) << SHIFT | 1 << (SHIFT - 1));
        CutCorrection(Box::new(std::array::from_fn(|k| interpolate(known, middle(k)) as f32)))
    }

    /// The factor at a predicted sum, W/(m² sr).
    #[inline(always)]
    pub fn factor(&self, predicted: f64) -> f32 {
        let index = (predicted.abs().to_bits() >> SHIFT).saturating_sub(FIRST);
        self.0[(index as usize).min(ENTRIES - 1)]
    }
}

impl Default for CutCorrection {
    fn default() -> Self {
        CutCorrection::new(&[])
    }
}

fn interpolate(known: &[(f64, f64)], sum: f64) -> f64 {
    let above = known.partition_point(|(at, _)| *at <= sum);
    match (above.checked_sub(1).map(|below| known[below]), known.get(above)) {
        (Some((low, from)), Some((high, to))) => from * (to / from).powf((sum / low).ln() / (high / low).ln()),
        (Some((_, factor)), None) | (None, Some(&(_, factor))) => factor,
        (None, None) => 1.0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Seen to catch: factors linear in the sum instead of its logarithm.
    #[test]
    fn factors_are_interpolated_between_the_known_ones() {
        let correction = CutCorrection::new(&[(1e2, 0.25), (1e6, 4.0)]);
        let sums = [(0.0, 0.25), (1.0, 0.25), (1e4, 1.0), (1e6, 4.0), (1e30, 4.0), (1e60, 4.0), (f64::NAN, 4.0)];
        for (sum, factor) in sums.into_iter().chain([(1e-80, 0.25), (1e80, 4.0), (f64::INFINITY, 4.0)]) {
            // From one step of the table to the next this factor grows by a tenth.
            let close = (correction.factor(sum) / factor).ln().abs() < 0.1;
            assert!(close, "{sum}: {}", correction.factor(sum));
        }
        assert_eq!(CutCorrection::default().factor(3.0).to_bits(), 1f32.to_bits());
    }
}

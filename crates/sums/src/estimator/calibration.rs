//! How much better or worse a cut is than it predicts, see [`Calibration`].

/// What the accuracy asked of a cut is multiplied by, so that the error asked for is the error that comes: a function of
/// the sum that the cut predicts, since in the shadow other nodes count than in the light.
#[derive(Clone, Debug)]
pub struct Calibration(Box<[f32; ENTRIES]>);

/// Bits of a float64 that are dropped to index the factors: two steps for each doubling of the sum, from 2⁻²⁵⁶ to 2²⁵⁶.
const SHIFT: u32 = 51;
const ENTRIES: usize = 1 << 10;
/// The index of 2⁻²⁵⁶.
const FIRST: u64 = (1023 - 256) << 1;

impl Calibration {
    /// From predicted sums, W/(m² sr), in ascending order, and the factor at each. Between them the factor's logarithm is
    /// linear in that of the sum; beyond, the factor is the last. It is 1 if nothing is known.
    pub fn new(known: &[(f64, f64)]) -> Calibration {
        let middle = |k: usize| f64::from_bits((k as u64 + FIRST) << SHIFT | 1 << (SHIFT - 1));
        Calibration(Box::new(std::array::from_fn(|k| interpolate(known, middle(k)) as f32)))
    }

    /// The factor at a predicted sum, W/(m² sr).
    #[inline(always)]
    pub fn factor(&self, predicted: f64) -> f32 {
        let index = (predicted.abs().to_bits() >> SHIFT).saturating_sub(FIRST);
        self.0[(index as usize).min(ENTRIES - 1)]
    }
}

impl Default for Calibration {
    fn default() -> Self {
        Calibration::new(&[])
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

    /// Seen to catch: linear in the sum instead of its logarithm.
    #[test]
    fn the_factor_goes_from_one_known_one_to_the_next() {
        let calibration = Calibration::new(&[(1e2, 0.25), (1e6, 4.0)]);
        let sums = [(0.0, 0.25), (1.0, 0.25), (1e4, 1.0), (1e6, 4.0), (1e30, 4.0), (1e60, 4.0), (f64::NAN, 4.0)];
        for (sum, factor) in sums.into_iter().chain([(1e-80, 0.25), (1e80, 4.0), (f64::INFINITY, 4.0)]) {
            // One step of the table is a tenth of a doubling of the factor.
            let close = (calibration.factor(sum) / factor).ln().abs() < 0.1;
            assert!(close, "{sum}: {}", calibration.factor(sum));
        }
        assert_eq!(Calibration::default().factor(3.0).to_bits(), 1f32.to_bits());
    }
}

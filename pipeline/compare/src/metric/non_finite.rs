//! NaN and infinity: faults of the renderer whatever the reference says.

use super::Samples;

/// Of reference and test.
pub(super) fn counts(samples: &Samples<'_>) -> [u64; 2] {
    let count = |plane: &[f32]| plane.iter().filter(|sample| !sample.is_finite()).count() as u64;
    samples.planes.iter().fold([0, 0], |[r, t], (reference, test)| [r + count(reference), t + count(test)])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn equal_ones_do_not_cancel() {
        let planes = vec![([1.0, f32::NAN].as_slice(), [f32::INFINITY, f32::NAN].as_slice())];
        assert_eq!(counts(&Samples { planes }), [1, 2]);
    }
}

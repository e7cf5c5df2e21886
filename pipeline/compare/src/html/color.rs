//! Colors of errors, in the page and in the index.

use serde::Serialize;

/// Color maps: sRGB codes at equal steps, linear between them.
#[derive(Serialize)]
pub(super) struct Maps {
    /// From no error to the largest that the scale has; brightness rises throughout.
    pub absolute: [[u8; 3]; 6],
    /// From the test image darker, by equal, to brighter; equally dark at both ends.
    pub signed: [[u8; 3]; 7],
    /// NaN and infinity: far from every color of the maps.
    pub not_finite: [u8; 3],
}

pub(super) const MAPS: Maps = Maps {
    absolute: [[4, 5, 18], [52, 22, 88], [135, 32, 92], [215, 66, 50], [250, 160, 30], [255, 250, 205]],
    signed: [
        [8, 40, 110],
        [44, 115, 190],
        [145, 195, 228],
        [247, 247, 245],
        [246, 178, 140],
        [205, 75, 60],
        [110, 8, 30],
    ],
    not_finite: [255, 0, 212],
};

/// The color of an error as part of the scale; no number has a color of its own.
pub(super) fn absolute(part: f64) -> [u8; 3] {
    if part.is_nan() {
        return MAPS.not_finite;
    }
    let steps = MAPS.absolute.len() - 1;
    let place = part.clamp(0.0, 1.0) * steps as f64;
    let index = (place as usize).min(steps - 1);
    let (low, high) = (MAPS.absolute[index], MAPS.absolute[index + 1]);
    let weight = place - index as f64;
    [0, 1, 2].map(|i| (f64::from(low[i]) * (1.0 - weight) + f64::from(high[i]) * weight).round() as u8)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ends_middle_and_no_number() {
        assert_eq!([0.0, 0.2, 1.0, 7.0].map(absolute), [[4, 5, 18], [52, 22, 88], [255, 250, 205], [255, 250, 205]]);
        assert_eq!(absolute(0.1), [28, 14, 53]);
        assert_eq!(absolute(f64::NAN), [255, 0, 212]);
    }
}

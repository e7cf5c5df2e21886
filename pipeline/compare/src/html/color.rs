//! The colors of errors in the page and in the index.

use serde::Serialize;

/// Color maps: sRGB codes at equal steps, with linear interpolation between them.
#[derive(Serialize)]
pub(super) struct Maps {
    /// The map from no error to the end of the scale. Its brightness rises throughout.
    pub absolute: [[u8; 3]; 6],
    /// The map from a darker test image over an equal one to a brighter one. Both ends are equally dark.
    pub signed: [[u8; 3]; 7],
    /// The color of NaN and infinity, which is far from every color of the maps.
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

/// The color of an error at a part, 0 to 1, of the scale. NaN has a color of its own.
pub(super) fn absolute(part: f64) -> [u8; 3] {
    if part.is_nan() {
        return MAPS.not_finite;
    }
    let steps = MAPS.absolute.len() - 1;
    let position = part.clamp(0.0, 1.0) * steps as f64;
    let index = (position as usize).min(steps - 1);
    let (low, high) = (MAPS.absolute[index], MAPS.absolute[index + 1]);
    let weight = position - index as f64;
    [0, 1, 2].map(|i| (f64::from(low[i]) * (1.0 - weight) + f64::from(high[i]) * weight).round() as u8)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ends_middle_and_nan() {
        assert_eq!([0.0, 0.2, 1.0, 7.0].map(absolute), [[4, 5, 18], [52, 22, 88], [255, 250, 205], [255, 250, 205]]);
        assert_eq!(absolute(0.1), [28, 14, 53]);
        assert_eq!(absolute(f64::NAN), [255, 0, 212]);
    }
}

//! Conversion of colors with other primaries to linear Rec. 709, in which the programs compute.
//!
//! Where the white differs, von Kries adaptation of Bradford's cone responses (Lam 1985) keeps neutral colors neutral.

use super::pixels::Panorama;
use glam::{DMat3, DVec3};
use std::f64::consts::PI;

/// CIE x and y of red, green, blue and white.
const REC_709: [f64; 8] = {
    let ([[rx, ry], [gx, gy], [bx, by]], [wx, wy]) = (color::PRIMARIES, color::WHITE);
    [rx, ry, gx, gy, bx, by, wx, wy]
};

/// Coordinates that differ by less are taken as equal, since files print them with few digits.
const TOLERANCE: f64 = 5e-4;

/// The relative change of the mean radiance that needs no warning: half floats are rounded by more.
const NEGLIGIBLE: f64 = 1e-5;

/// From CIE XYZ to the responses of the cones.
const BRADFORD: DMat3 = DMat3::from_cols_array(&[
    0.8951, -0.7502, 0.0389, //
    0.2664, 1.7135, -0.0685, //
    -0.1614, 0.0367, 1.0296,
]);

/// The matrix to linear Rec. 709 from the color space with these CIE x and y of red, green, blue and white; none if
/// that is Rec. 709.
pub(super) fn to_rec_709(stated: [f64; 8]) -> Result<Option<DMat3>, String> {
    if stated.iter().zip(REC_709).all(|(a, b)| (a - b).abs() < TOLERANCE) {
        return Ok(None);
    }
    let matrix = to_xyz(stated).zip(to_xyz(REC_709)).and_then(|((own, own_white), (target, white))| {
        let [from, to] = [own_white, white].map(|xyz| BRADFORD * xyz);
        let adapted = BRADFORD.inverse() * DMat3::from_diagonal(to / from) * BRADFORD;
        let matrix = target.inverse() * adapted * own;
        (from.min_element() > 0.0 && matrix.is_finite()).then_some(matrix)
    });
    let unusable =
        || format!("{stated:?} are no primaries and white of a color space; save the picture as linear Rec. 709");
    matrix.map(Some).ok_or_else(unusable)
}

/// The matrix from a color space to CIE XYZ, and the XYZ of its white.
fn to_xyz([rx, ry, gx, gy, bx, by, wx, wy]: [f64; 8]) -> Option<(DMat3, DVec3)> {
    let xyz = |x: f64, y: f64| DVec3::new(x, y, 1.0 - x - y);
    let primaries = DMat3::from_cols(xyz(rx, ry), xyz(gx, gy), xyz(bx, by));
    let white = xyz(wx, wy) / wy;
    let amounts = primaries.inverse() * white;
    let usable = amounts.is_finite() && amounts.min_element() > 0.0;
    usable.then(|| (primaries * DMat3::from_diagonal(amounts), white))
}

/// Converts all pixels. A color outside the gamut of Rec. 709 has a negative channel, which becomes 0 because a density
/// is made of the radiance; a warning states how much the light of the map changes.
pub(super) fn convert(picture: &mut Panorama, matrix: DMat3) {
    let (mut exact_mean, mut mean, mut outside) = (DVec3::ZERO, DVec3::ZERO, 0_u64);
    let (width, height) = (picture.width, picture.height);
    for (row, pixels) in picture.pixels.chunks_mut(width).enumerate() {
        let weight = share_of_sphere(row, height) / width as f64;
        for pixel in pixels {
            // Numbers that are no radiance stay: the environment map refuses them and names the pixel.
            if !pixel.iter().all(|x| x.is_finite() && *x >= 0.0) {
                continue;
            }
            let exact = matrix * DVec3::from_array(pixel.map(f64::from));
            let kept = exact.max(DVec3::ZERO);
            outside += u64::from(exact != kept);
            exact_mean += exact * weight;
            mean += kept * weight;
            *pixel = kept.as_vec3().to_array();
        }
    }
    if (mean - exact_mean).max_element() > NEGLIGIBLE * mean.max_element() {
        let three = |v: DVec3| v.to_array().map(|x| format!("{x:.4e}")).join(" ");
        picture.warnings.push(format!(
            "{outside} of {} pixels have colors outside Rec. 709: negative channels become 0, and the mean radiance \
             of the picture is {} instead of {} (red, green, blue)",
            width * height,
            three(mean),
            three(exact_mean)
        ));
    }
}

/// The fraction of the sphere's solid angle that a row covers.
fn share_of_sphere(row: usize, height: usize) -> f64 {
    let border = |row: usize| (PI * row as f64 / height as f64).cos();
    0.5 * (border(row) - border(row + 1))
}

#[cfg(test)]
mod tests {
    use super::*;

    const ACESCG: [f64; 8] = [0.713, 0.293, 0.165, 0.830, 0.128, 0.044, 0.32168, 0.33767];

    /// The matrix that color managers publish for ACEScg to linear Rec. 709 (OpenColorIO's ACES configuration).
    ///
    /// Seen to catch: no adaptation of the white; the inverse adaptation; rows taken for columns.
    #[test]
    fn acescg_becomes_rec_709() {
        let matrix = to_rec_709(ACESCG).expect("a color space").expect("another");
        let expected = [[1.70505, -0.62179, -0.08326], [-0.13026, 1.14080, -0.01055], [-0.02400, -0.12897, 1.15297]];
        for (row, expected) in expected.into_iter().enumerate() {
            let found = matrix.row(row);
            assert!(found.abs_diff_eq(DVec3::from_array(expected), 1e-4), "{found} {expected:?}");
        }
        assert!((matrix * DVec3::ONE).abs_diff_eq(DVec3::ONE, 1e-12), "white stays white");
    }

    /// CIE XYZ as a color space of three primaries, one of which has no y.
    #[test]
    fn xyz_is_a_color_space_and_three_on_a_line_are_none() {
        let third = 1.0 / 3.0;
        let xyz = to_rec_709([1.0, 0.0, 0.0, 1.0, 0.0, 0.0, third, third]).expect("a color space").expect("another");
        assert!((xyz * DVec3::ONE).abs_diff_eq(DVec3::ONE, 1e-12));
        assert_eq!(to_rec_709([0.64, 0.33, 0.30, 0.60, 0.15, 0.06, 0.3127159, 0.3290015]), Ok(None));
        let line = [0.1, 0.1, 0.2, 0.2, 0.3, 0.3, 0.25, 0.25];
        for bad in [[0.0; 8], [f64::NAN; 8], line, [0.64, 0.33, 0.3, 0.6, 0.15, 0.06, 0.9, 0.05]] {
            assert!(to_rec_709(bad).is_err(), "{bad:?}");
        }
    }
}

//! Colors: linear sRGB, the opponent channels in which contrast is filtered, and the space in which differences are
//! measured.

use color::xyz;

use crate::metric::elementary::power;

/// CIE x and y of D65, with one digit more than sRGB states.
const WHITE: [f64; 2] = [0.312_71, 0.329_02];

/// The matrices from linear R, G, B to X, Y, Z relative to white, and back.
const TO_XYZ: xyz::Matrix = xyz::from_rgb(color::PRIMARIES, WHITE);
const TO_RGB: xyz::Matrix = xyz::inverse(TO_XYZ);

#[inline(always)]
fn transform(matrix: &xyz::Matrix, [a, b, c]: [f32; 3]) -> [f32; 3] {
    let row = |row: [f64; 3]| row[0] as f32 * a + row[1] as f32 * b + row[2] as f32 * c;
    [row(matrix[0]), row(matrix[1]), row(matrix[2])]
}

/// The opponent channels Y, X - Y and Y - Z, relative to white, of linear R, G, B in 0..1. The paper's YCxCz is 116 Y -
/// 16, 500 (X - Y) and 200 (Y - Z); a filter whose weights sum to 1 acts on both in the same way.
#[inline(always)]
pub(super) fn opponents(rgb: [f32; 3]) -> [f32; 3] {
    let [x, y, z] = transform(&TO_XYZ, rgb);
    [y, x - y, y - z]
}

/// L*a*b* of opponent channels, whose R, G, B are clamped to what a screen shows, with Hunt's adjustment, by which
/// colors fade in the dark.
#[inline(always)]
pub(super) fn hunt_lab([y, xy, yz]: [f32; 3]) -> [f32; 3] {
    let [r, g, b] = transform(&TO_RGB, [y + xy, y, y - yz]);
    let xyz = transform(&TO_XYZ, [r.clamp(0.0, 1.0), g.clamp(0.0, 1.0), b.clamp(0.0, 1.0)]);
    let [x, y, z] = [compress(xyz[0]), compress(xyz[1]), compress(xyz[2])];
    let lightness = 116.0 * y - 16.0;
    let hunt = 0.01 * lightness;
    [lightness, hunt * 500.0 * (x - y), hunt * 200.0 * (y - z)]
}

/// The compression of CIE 15: a cube root, and a straight line near black.
#[inline(always)]
fn compress(t: f32) -> f32 {
    const JOINT: f32 = 6.0 / 29.0;
    let line = t / (3.0 * JOINT * JOINT) + 4.0 / 29.0;
    let root = power(t, 1.0 / 3.0);
    if t > JOINT * JOINT * JOINT { root } else { line }
}

/// The HyAB distance: lightness by itself plus the Euclidean distance of the other two.
#[inline(always)]
fn distance(a: [f32; 3], b: [f32; 3]) -> f32 {
    let [l, a, b] = [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
    l.abs() + (a * a + b * b).sqrt()
}

/// The distance to the power of 0.7, the paper's q_c, by which large differences count less. It is exactly zero for
/// equal colors.
#[inline(always)]
fn compressed_distance(a: [f32; 3], b: [f32; 3]) -> f32 {
    let distance = distance(a, b);
    distance * power(distance, 0.7 - 1.0)
}

/// The paper's c_max: the compressed distance of pure green and pure blue.
pub(super) fn largest_difference() -> f32 {
    let [green, blue] = [[0.0, 1.0, 0.0], [0.0, 0.0, 1.0]].map(|rgb| hunt_lab(opponents(rgb)));
    compressed_distance(green, blue)
}

/// The difference, 0 to 1, of two adjusted colors. Distances up to 0.4 of the largest, the paper's p_c, take 0.95 of
/// the range, its p_t.
#[inline(always)]
pub(super) fn difference(a: [f32; 3], b: [f32; 3], largest: f32) -> f32 {
    let (joint, distance) = (0.4 * largest, compressed_distance(a, b));
    let small = distance * (0.95 / joint);
    let large = 0.95 + (distance - joint) * (0.05 / (largest - joint));
    if distance < joint { small } else { large }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn lab(rgb: [f32; 3]) -> [f32; 3] {
        hunt_lab(opponents(rgb))
    }

    #[test]
    fn white_gray_and_black_have_no_color() {
        for (gray, lightness) in [(0.0, 0.0), (0.001, 0.903_3), (0.184_187, 50.0), (1.0, 100.0)] {
            let [l, a, b] = lab([gray; 3]);
            // The tolerance is the rounding of 100 in float32.
            assert!((l - lightness).abs() < 1e-4 && a.abs() < 1e-4 && b.abs() < 1e-4, "{gray}: {l} {a} {b}");
        }
    }

    #[test]
    fn red_has_its_tabulated_value() {
        // Red of sRGB under D65 has L* 53.24, a* 80.09 and b* 67.20; Hunt's factor is 0.5324.
        let [l, a, b] = lab([1.0, 0.0, 0.0]);
        assert!((l - 53.24).abs() < 0.01 && (a - 42.64).abs() < 0.02 && (b - 35.78).abs() < 0.02, "{l} {a} {b}");
    }

    #[test]
    fn differences_of_lightness_alone() {
        // A distance of 10 in lightness is compressed to 10^0.7 = 5.0119, of 0.4 * 41.27 that make 0.95.
        let largest = largest_difference();
        let found = difference([40.0, 0.0, 0.0], [50.0, 0.0, 0.0], largest);
        assert!((found - 0.95 * 5.011_872 / (0.4 * largest)).abs() < 1e-6);
        assert!((largest - 41.27).abs() < 0.01, "{largest}");
        assert_eq!(difference([40.0, 3.0, 2.0], [40.0, 3.0, 2.0], largest), 0.0);
        assert!((difference(lab([0.0, 1.0, 0.0]), lab([0.0, 0.0, 1.0]), largest) - 1.0).abs() < 1e-6);
    }
}

//! Unit vectors in four bytes: the octahedral map (Meyer, Süßmuth, Sußner, Stamminger, Greiner 2010, "On floating-point
//! normal vectors"). The encoder takes the best of the four codes around the exact point (Cigolle, Donow, Evangelakos,
//! Mara, McGuire, Meyer 2014, "A survey of efficient representations for independent unit vectors").
//!
//! ```
//! use formats::octahedral::{decode, encode};
//! let direction = glam::DVec3::new(0.6, 0.0, -0.8);
//! assert!(decode(encode(direction)).angle_between(direction) < 5e-5);
//! ```

use glam::DVec3;

const STEPS: f64 = i16::MAX as f64;

/// The code whose direction is nearest to the unit vector `v`: it is off by at most 5·10⁻⁵ rad.
pub fn encode(v: DVec3) -> [i16; 2] {
    let flat = v / (v.x.abs() + v.y.abs() + v.z.abs());
    let (x, y) = if v.z < 0.0 {
        ((1.0 - flat.y.abs()) * sign(flat.x), (1.0 - flat.x.abs()) * sign(flat.y))
    } else {
        (flat.x, flat.y)
    };
    let (low_x, low_y) = ((x * STEPS).floor(), (y * STEPS).floor());
    let mut best = [0i16; 2];
    let mut closest = f64::NEG_INFINITY;
    for (dx, dy) in [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0), (1.0, 1.0)] {
        let code = [(low_x + dx).clamp(-STEPS, STEPS) as i16, (low_y + dy).clamp(-STEPS, STEPS) as i16];
        let cosine = decode(code).dot(v);
        if cosine > closest {
            (best, closest) = (code, cosine);
        }
    }
    best
}

/// The unit vector of a code. Every code has one; −32768 reads as −32767.
pub fn decode(code: [i16; 2]) -> DVec3 {
    let (x, y) = (f64::from(code[0]).max(-STEPS) / STEPS, f64::from(code[1]).max(-STEPS) / STEPS);
    let z = 1.0 - x.abs() - y.abs();
    let (x, y) = if z < 0.0 { ((1.0 - y.abs()) * sign(x), (1.0 - x.abs()) * sign(y)) } else { (x, y) };
    DVec3::new(x, y, z).normalize()
}

/// The directions of codes with x in the low half and y in the high one, component by component: vectors of integers
/// whose magnitudes add up to 32767, so that their dot products are exact.
///
/// The corners of the square are the lower half of the octahedron: there both coordinates move towards zero by how far
/// `z` is below it. −32768 reads as −32767. There are no branches, which would become masked stores that the next loop
/// has to wait for.
#[inline(always)]
pub fn integer_directions<const N: usize>(codes: &[u32; N]) -> [[i32; N]; 3] {
    const STEPS: i32 = i16::MAX as i32;
    let mut directions = [[0; N]; 3];
    for i in 0..N {
        let x = (((codes[i] << 16) as i32) >> 16).max(-STEPS);
        let y = ((codes[i] as i32) >> 16).max(-STEPS);
        let z = STEPS - x.abs() - y.abs();
        let below = (-z).max(0);
        directions[0][i] = x - with_sign(below, x);
        directions[1][i] = y - with_sign(below, y);
        directions[2][i] = z;
    }
    directions
}

/// `magnitude`, or its negative where `sign < 0`.
#[inline(always)]
fn with_sign(magnitude: i32, sign: i32) -> i32 {
    let ones = sign >> 31;
    (magnitude ^ ones) - ones
}

fn sign(x: f64) -> f64 {
    if x < 0.0 { -1.0 } else { 1.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn axes_are_exact_and_everything_else_is_close() {
        for v in [DVec3::X, DVec3::NEG_X, DVec3::Y, DVec3::NEG_Y, DVec3::Z, DVec3::NEG_Z] {
            assert_eq!(decode(encode(v)), v);
        }
        let mut worst = 0.0f64;
        for k in 0..200_000 {
            let z = 1.0 - 2.0 * (f64::from(k) + 0.5) / 200_000.0;
            let (s, c) = (f64::from(k) * 2.399_963).sin_cos();
            let v = DVec3::new(c, s, 0.0) * (1.0 - z * z).sqrt() + DVec3::Z * z;
            worst = worst.max(decode(encode(v)).cross(v).length());
        }
        assert!(worst < 5e-5, "{worst}");
    }

    #[test]
    fn mirrored_vectors_have_mirrored_codes() {
        let v = DVec3::new(0.3, -0.5, 0.7).normalize();
        let mirrored = decode(encode(v * DVec3::new(-1.0, 1.0, 1.0)));
        assert!((mirrored * DVec3::new(-1.0, 1.0, 1.0) - decode(encode(v))).length() < 1e-15);
    }

    /// Seen to catch: halves exchanged, −32768 taken as it is, a corner that is not folded.
    #[test]
    fn every_code_is_a_unit_vector_and_one_of_integers() {
        let steps = [i16::MIN, i16::MIN + 1, -20_000, -1, 0, 1, 20_000, i16::MAX];
        for (x, y) in steps.into_iter().flat_map(|x| steps.map(|y| (x, y))) {
            let unit = decode([x, y]);
            assert!((unit.length() - 1.0).abs() < 1e-15);
            let code = u32::from(x as u16) | u32::from(y as u16) << 16;
            let integers = DVec3::from_array(integer_directions(&[code]).map(|[component]| f64::from(component)));
            assert_eq!(integers.abs().element_sum(), STEPS);
            assert!(integers.normalize().abs_diff_eq(unit, 1e-15), "{x} {y}");
        }
    }
}

//! Filters: what is undone after decoding. Numbers outside the ranges of the specification give some numbers.

/// Undoes a filter of four components, of 8 or 16 bits, to an element of `stride` bytes.
fn each_four(bytes: &mut [u8], stride: usize, undo: impl Fn([i32; 4], f32) -> [f32; 4]) {
    if stride == 4 {
        for four in bytes.as_chunks_mut::<4>().0 {
            *four = undo(four.map(|b| i32::from(b as i8)), f32::from(i8::MAX)).map(|x| x.round() as i32 as u8);
        }
    } else {
        for eight in bytes.as_chunks_mut::<8>().0 {
            let four = std::array::from_fn(|k| i32::from(i16::from_le_bytes([eight[2 * k], eight[2 * k + 1]])));
            let new = undo(four, f32::from(i16::MAX)).map(|x| (x.round() as i32 as u16).to_le_bytes());
            eight.copy_from_slice(new.as_flattened());
        }
    }
}

/// Unit vectors from their projection on an octahedron. The third component is 1 in the vector's own precision.
pub(super) fn octahedral(bytes: &mut [u8], stride: usize) {
    each_four(bytes, stride, |[x, y, one, rest], largest| {
        let [mut x, mut y] = [x, y].map(|v| v as f32 / one as f32);
        let z = 1.0 - x.abs() - y.abs();
        let fold = z.min(0.0);
        x -= fold.copysign(x);
        y -= fold.copysign(y);
        let scale = largest / (x * x + y * y + z * z).sqrt();
        [x * scale, y * scale, z * scale, rest as f32]
    });
}

/// Unit quaternions from three components. The last says which is left out, and is 1 in the quaternion's own precision.
pub(super) fn quaternion(bytes: &mut [u8]) {
    each_four(bytes, 8, |[x, y, z, last], largest| {
        let scale = std::f32::consts::FRAC_1_SQRT_2 / (last | 3) as f32;
        let [x, y, z] = [x, y, z].map(|v| v as f32 * scale);
        let w = (1.0 - x * x - y * y - z * z).max(0.0).sqrt();
        let mut quaternion = [0.0; 4];
        for (k, component) in [w, x, y, z].into_iter().enumerate() {
            quaternion[((last & 3) as usize + k) % 4] = component * largest;
        }
        quaternion
    });
}

/// Numbers in float32 from a mantissa of 24 bits and an exponent.
pub(super) fn exponential(bytes: &mut [u8]) {
    for four in bytes.as_chunks_mut::<4>().0 {
        let bits = i32::from_le_bytes(*four);
        let (exponent, mantissa) = (bits >> 24, bits << 8 >> 8);
        *four = (2f32.powi(exponent) * mantissa as f32).to_le_bytes();
    }
}

/// Colors with alpha from luma and chroma. The highest bit of alpha tells the precision.
pub(super) fn color(bytes: &mut [u8], stride: usize) {
    each_four(bytes, stride, |[y, co, cg, alpha], largest| {
        // Components without sign: the largest is twice that of signed ones, and 1.
        let (unsigned, mask) = (2.0 * largest + 1.0, if stride == 4 { 0xff } else { 0xffff });
        let [y, alpha] = [y & mask, alpha & mask];
        let all = (1i32 << (32 - alpha.leading_zeros())) - 1;
        let a = alpha & all >> 1;
        let scale = unsigned / all as f32;
        [y + co - cg, y + cg, y - co - cg, a << 1 | a & 1].map(|v| v as f32 * scale)
    });
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Seen to catch: the lower hemisphere not folded.
    #[test]
    fn octahedral_vectors() {
        let mut bytes = [127, 0, 127, 5, 0, 0, 127, 6, (-64i8) as u8, 0, 64, 0, 127, 127, 127, 0];
        octahedral(&mut bytes, 4);
        let signed = bytes.map(|b| b as i8);
        assert_eq!(signed, [127, 0, 0, 5, 0, 0, 127, 6, -127, 0, 0, 0, 0, 0, -127, 0]);
        let mut wide: Vec<u8> = [511i16, 0, 511, -9].iter().flat_map(|x| x.to_le_bytes()).collect();
        octahedral(&mut wide, 8);
        assert_eq!(wide, [32767i16, 0, 0, -9].iter().flat_map(|x| x.to_le_bytes()).collect::<Vec<_>>());
    }

    /// Half a turn about an axis between x and y; the largest component is in any place.
    ///
    /// Seen to catch: components turned the other way.
    #[test]
    fn quaternions() {
        for place in 0..4 {
            // The component after the largest is as large: sqrt(1/2), which is 1 in these numbers.
            let mut bytes: Vec<u8> = [511i16, 0, 0, 511 & !3 | place].iter().flat_map(|x| x.to_le_bytes()).collect();
            quaternion(&mut bytes);
            let read = |k: usize| i16::from_le_bytes([bytes[2 * k], bytes[2 * k + 1]]);
            let place = place as usize;
            let expected = (0.5f32.sqrt() * 32767.0).round() as i16;
            for k in 0..4 {
                let large = k == place || k == (place + 1) % 4;
                assert!((read(k) - if large { expected } else { 0 }).abs() <= 1, "{place}, {k}: {}", read(k));
            }
        }
    }

    /// Seen to catch: the sign of the mantissa ignored.
    #[test]
    fn exponents() {
        for (exponent, mantissa, value) in [(0, 5, 5.0), (-2, -3, -0.75), (10, 1, 1024.0), (-100, 1, 2f32.powi(-100))] {
            let mut bytes = (exponent << 24 | mantissa & 0xff_ffffi32).to_le_bytes();
            exponential(&mut bytes);
            assert_eq!(f32::from_le_bytes(bytes), value);
        }
    }

    /// White, black and pure red with half alpha, in 8 bits and in 4 of 8.
    ///
    /// Seen to catch: the bit that tells the precision taken for one of alpha.
    #[test]
    fn colors() {
        // Y = (r + 2 g + b) / 4, Co = (r - b) / 2, Cg = g - Y.
        let mut bytes = [255, 0, 0, 0xff, 0, 0, 0, 0x80, 64, 127, (-64i8) as u8, 0xc0, 15, 0, 0, 15];
        color(&mut bytes, 4);
        assert_eq!(bytes, [255, 255, 255, 255, 0, 0, 0, 0, 255, 0, 1, 128, 255, 255, 255, 255]);
    }
}

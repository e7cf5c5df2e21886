//! The preview: a picture of 8 bits by exposure, a filmic curve and sRGB.

use crate::film::Pixel;
use color::{srgb, tone};
use scene::DVec3;

/// Factor of the tone curve's argument, with which a middle gray of 0.18 stays 0.18 and the curve reaches 1 at about
/// 10.
const MIDDLE: f64 = 0.7232;

/// Encodes the pixels as a PNG file, brightened by `stops` powers of two. Their values are taken as linear sRGB.
pub fn png(pixels: &[Pixel], width: usize, height: usize, stops: f64) -> Result<Vec<u8>, png::EncodingError> {
    let scale = stops.exp2();
    let bytes: Vec<u8> = pixels.iter().flat_map(|p| shown(p.beauty() * scale)).collect();
    let mut file = Vec::new();
    let mut encoder = png::Encoder::new(&mut file, width as u32, height as u32);
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_depth(png::BitDepth::Eight);
    encoder.set_source_srgb(png::SrgbRenderingIntent::Perceptual);
    encoder.write_header()?.write_image_data(&bytes)?;
    Ok(file)
}

/// Applies the tone curve and the sRGB encoding to each channel.
fn shown(linear: DVec3) -> [u8; 3] {
    linear.to_array().map(|x| srgb::encode_byte(tone::aces(MIDDLE * x)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn black_middle_gray_and_white_have_their_known_values() {
        assert_eq!(shown(DVec3::ZERO), [0; 3]);
        // sRGB shows 0.18 as 118. Seen to catch: a curve without its scale (141).
        assert_eq!(shown(DVec3::splat(0.18)), [118; 3]);
        assert_eq!(shown(DVec3::splat(10.1)), [255; 3]);
        assert_eq!(shown(DVec3::splat(f64::MAX)), [255; 3]);
    }

    /// A warm light that becomes too bright stays warm and pales on its way to white: no channel overtakes another, and
    /// the color never turns to a clipped yellow. Seen to catch: clipping alone.
    #[test]
    fn highlights_keep_their_hue_and_pale() {
        let mut spread_before = 255;
        for stops in 0..5 {
            let [r, g, b] = shown(DVec3::new(1.0, 0.5, 0.25) * f64::from(stops).exp2());
            assert!(r >= g && g >= b, "{stops}: {r} {g} {b}");
            // In a hue between red and yellow, the middle channel lies between the smallest (0) and the largest (1).
            let (way, spread) = (f64::from(g - b) / f64::from((r - b).max(1)), r - b);
            assert!((0.2..0.85).contains(&way) || spread < 16, "{stops}: {r} {g} {b}");
            assert!(spread <= spread_before, "{stops}: {r} {g} {b}");
            spread_before = spread;
        }
    }
}

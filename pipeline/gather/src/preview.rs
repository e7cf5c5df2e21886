//! A picture for looking at: exposure, a filmic curve, sRGB, 8 bits.

use crate::film::Pixel;
use scene::DVec3;

/// What the curve's argument is multiplied by: so a middle grey of 0.18 stays 0.18, and the curve meets 1 at about 10.
const MIDDLE: f64 = 0.7232;

/// The pixels as a PNG file, brighter by `stops` powers of two. Not color-managed: values are linear sRGB.
pub fn png(pixels: &[Pixel], width: usize, height: usize, stops: f64) -> Result<Vec<u8>, png::EncodingError> {
    let scale = stops.exp2();
    let bytes: Vec<u8> = pixels.iter().flat_map(|p| tone(p.beauty() * scale)).collect();
    let mut file = Vec::new();
    let mut encoder = png::Encoder::new(&mut file, width as u32, height as u32);
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_depth(png::BitDepth::Eight);
    encoder.set_source_srgb(png::SrgbRenderingIntent::Perceptual);
    encoder.write_header()?.write_image_data(&bytes)?;
    Ok(file)
}

/// Each channel by the curve, then sRGB.
fn tone(linear: DVec3) -> [u8; 3] {
    linear.to_array().map(|x| (255.0 * srgb(filmic(x))).round() as u8)
}

/// A toe, a straight part and a shoulder: the curve of the ACES output transform as Krzysztof Narkowicz fitted it ("ACES
/// Filmic Tone Mapping Curve", 2016), 0 to 1. Applied to each channel, it takes what is far too bright to white.
fn filmic(linear: f64) -> f64 {
    // Beyond, the curve is 1; its squares could overflow.
    let x = (MIDDLE * linear).clamp(0.0, 100.0);
    (x * (2.51 * x + 0.03) / (x * (2.43 * x + 0.59) + 0.14)).min(1.0)
}

/// The sRGB transfer curve (IEC 61966-2-1).
fn srgb(x: f64) -> f64 {
    if x <= 0.003_130_8 { 12.92 * x } else { 1.055 * x.powf(1.0 / 2.4) - 0.055 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn black_middle_grey_and_white_are_where_they_should_be() {
        assert_eq!(tone(DVec3::ZERO), [0; 3]);
        // sRGB shows 0.18 as 118. Seen to catch: a curve without its scale (141).
        assert_eq!(tone(DVec3::splat(0.18)), [118; 3]);
        assert_eq!(tone(DVec3::splat(10.1)), [255; 3]);
        assert_eq!(tone(DVec3::splat(f64::MAX)), [255; 3]);
        assert!((srgb(0.5) - 0.735_36).abs() < 1e-4);
    }

    #[test]
    fn the_curve_rises_and_its_shoulder_flattens() {
        let curve: Vec<f64> = (0..100).map(|k| filmic(0.1 * f64::from(k))).collect();
        assert!(curve.windows(2).all(|w| w[0] < w[1]), "{curve:?}");
        // Beyond white paper, 0.9, two stops are worth less than half of one.
        assert!(filmic(3.6) < 1.4 * filmic(0.9));
    }

    /// A warm light stays warm as it becomes too bright, and pales on its way to white: none of its channels overtakes
    /// another, and it never turns to a clipped yellow. Seen to catch: clipping alone.
    #[test]
    fn highlights_keep_their_hue_and_pale() {
        let mut spread_before = 255;
        for stops in 0..5 {
            let [r, g, b] = tone(DVec3::new(1.0, 0.5, 0.25) * f64::from(stops).exp2());
            assert!(r >= g && g >= b, "{stops}: {r} {g} {b}");
            // Of a hue between red and yellow the middle channel is 0 to 1 of the way from the least to the most.
            let (way, spread) = (f64::from(g - b) / f64::from((r - b).max(1)), r - b);
            assert!((0.2..0.85).contains(&way) || spread < 16, "{stops}: {r} {g} {b}");
            assert!(spread <= spread_before, "{stops}: {r} {g} {b}");
            spread_before = spread;
        }
    }
}

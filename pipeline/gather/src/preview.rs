//! A picture for looking at: exposure, a soft shoulder, sRGB, 8 bits.

use crate::film::Pixel;
use scene::DVec3;

/// Luminance that is shown as white, before exposure.
const WHITE: f64 = 4.0;

/// The pixels as a PNG file, brighter by `stops` powers of two. Not colour-managed: values are linear sRGB.
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

/// Reinhard's curve on luminance with a white point (Reinhard, Stark, Shirley, Ferwerda 2002, eq. 4), then sRGB.
fn tone(linear: DVec3) -> [u8; 3] {
    let luminance = linear.dot(DVec3::new(0.2126, 0.7152, 0.0722));
    let factor = if luminance > 0.0 { (1.0 + luminance / (WHITE * WHITE)) / (1.0 + luminance) } else { 1.0 };
    (linear * factor).to_array().map(|x| (255.0 * srgb(x.clamp(0.0, 1.0))).round() as u8)
}

/// The sRGB transfer curve (IEC 61966-2-1).
fn srgb(x: f64) -> f64 {
    if x <= 0.003_130_8 { 12.92 * x } else { 1.055 * x.powf(1.0 / 2.4) - 0.055 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ends_of_the_curve() {
        assert_eq!(tone(DVec3::ZERO), [0; 3]);
        assert_eq!(tone(DVec3::splat(WHITE)), [255; 3]);
        assert_eq!(tone(DVec3::splat(1e9)), [255; 3]);
        assert!((srgb(0.5) - 0.735_36).abs() < 1e-4);
    }
}

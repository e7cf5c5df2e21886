//! Pictures of models beside the truth, with their signed errors below.

use crate::truth::{BLOCK, Scattered};
use bssrdf::DVec3;
use color::srgb;
use picture::{Picture, font};

/// The relative error that has the full color.
const FULL: f64 = 0.5;

/// Where nothing is.
const BACKGROUND: [u8; 3] = [16; 3];
const PAPER: [u8; 3] = [245; 3];
const INK: [u8; 3] = [40; 3];

/// Space between columns, pixels: names are wider than pictures.
const GAP: usize = 8;

/// The truth and the images of models in a row, each below its name, and below each model its error.
pub fn strip(truth: &Scattered, models: &[(&str, &Scattered)]) -> Result<Vec<u8>, png::EncodingError> {
    let (width, height, exposure) = (truth.width + GAP, truth.height, exposure(truth));
    let mut sheet = Picture::new(width * (models.len() + 1), font::LINE + 2 * height + GAP, PAPER);
    let columns = [("truth", truth)].into_iter().chain(models.iter().copied());
    for (column, (name, image)) in columns.enumerate() {
        let left = column * width;
        font::dots(name, width).for_each(|(x, y)| sheet.dot(left + x, y + 1, INK));
        sheet.draw(&toned(image, exposure), left, font::LINE);
        if column > 0 {
            sheet.draw(&errors(truth, image), left, font::LINE + height + GAP);
        }
    }
    sheet.encode(png::Compression::High, &[])
}

/// What the light is multiplied by: the brightest hundredth of what is lit becomes white.
fn exposure(truth: &Scattered) -> f64 {
    let mut lit: Vec<f64> = truth.pixels.iter().map(|p| p[0].max(p[1]).max(p[2])).filter(|x| *x > 0.0).collect();
    lit.sort_by(f64::total_cmp);
    lit.get(lit.len() * 99 / 100).map_or(1.0, |x| 1.0 / x)
}

fn toned(image: &Scattered, exposure: f64) -> Picture {
    let shown = |p: &[f64; 3]| match p.iter().all(|x| *x == 0.0) {
        true => BACKGROUND,
        false => p.map(|x| srgb::encode_byte(exposure * x)),
    };
    Picture { width: image.width, height: image.height, pixels: image.pixels.iter().map(shown).collect() }
}

/// The signed error in blocks.
fn errors(truth: &Scattered, image: &Scattered) -> Picture {
    let (truth_of, image_of) = (truth.blocks(BLOCK), image.blocks(BLOCK));
    let color = |x: usize, y: usize| {
        let k = y / BLOCK * truth_of.width + x / BLOCK;
        let [t, r] = [image_of.pixels[k], truth_of.pixels[k]].map(DVec3::from_array);
        if r == DVec3::ZERO {
            return PAPER;
        }
        let relative = (t - r) / (r * r + DVec3::splat(0.01)).map(f64::sqrt);
        let error = (relative.element_sum() / 3.0 / FULL).clamp(-1.0, 1.0);
        let fade = (255.0 * (1.0 - error.abs())).round() as u8;
        if error > 0.0 { [255, fade, fade] } else { [fade, fade, 255] }
    };
    let (width, height) = (truth.width, truth.height);
    let pixels = (0..height).flat_map(|y| (0..width).map(move |x| (x, y))).map(|(x, y)| color(x, y)).collect();
    Picture { width, height, pixels }
}

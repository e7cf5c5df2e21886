//! Pixels: layers, mean and variance, and the channels of the image file.

use crate::{
    crop::Crop,
    path_state::{Guide, LAYERS, Layers},
};
use formats::{Channel, Image, Window};
use rayon::prelude::*;
use scene::DVec3;

/// The largest variance in a file.
const MAX_VARIANCE: DVec3 = DVec3::splat(f32::MAX as f64);

/// The number of pixels that one task copies to the channels.
const CHUNK: usize = 4096;

/// A pixel's values.
#[derive(Clone, Copy, Debug, Default)]
pub struct Pixel {
    layers: Layers,
    /// Estimate of the variance of the mean. As a square it exceeds float32 long before the pixel does; the file then
    /// contains the largest float32.
    variance: DVec3,
    guide: Guide,
}

impl Pixel {
    pub(crate) fn new(layers: Layers, variance: DVec3, guide: Guide) -> Pixel {
        Pixel { layers, variance, guide }
    }

    /// `L_o`, W/(m² sr).
    pub fn beauty(&self) -> DVec3 {
        self.layers.iter().sum()
    }

    pub fn variance(&self) -> DVec3 {
        self.variance
    }

    /// The numbers of the file, in the order of [`channel_names`]; the position is relative to `origin`, m.
    fn values(&self, origin: DVec3) -> [f32; 28] {
        let mut values = [0.0; 28];
        // The position is 0 where no surface was met, whatever the origin.
        let position = if self.guide.normal == DVec3::ZERO { DVec3::ZERO } else { self.guide.position - origin };
        let after = [self.variance.min(MAX_VARIANCE), self.guide.normal, position];
        let vectors = [self.beauty()].into_iter().chain(self.layers).chain(after);
        let numbers = vectors.flat_map(|v| v.to_array()).chain([self.guide.depth]);
        values.iter_mut().zip(numbers).for_each(|(value, x)| *value = x as f32);
        values
    }

    /// True if all numbers are finite.
    pub fn is_finite(&self) -> bool {
        self.variance.is_finite() && self.values(DVec3::ZERO).iter().all(|x| x.is_finite())
    }
}

fn channel_names() -> Vec<String> {
    let mut names: Vec<String> = ["R", "G", "B"].map(String::from).into();
    for layer in LAYERS.into_iter().chain(["variance"]) {
        names.extend(["R", "G", "B"].map(|c| format!("{layer}.{c}")));
    }
    for vector in ["N", "P"] {
        names.extend(["X", "Y", "Z"].map(|c| format!("{vector}.{c}")));
    }
    names.push("Z".into());
    names
}

/// The channels of the layer `albedo`, those of `id`, or both, of what the ray through each pixel's center meets.
pub fn guides(pixels: &[Pixel], albedo: bool, id: bool) -> Vec<Channel> {
    let channel = |name: &str, of: &dyn Fn(&Guide) -> f64| {
        let samples = pixels.iter().map(|pixel| of(&pixel.guide) as f32).collect();
        Channel { name: name.to_owned(), samples }
    };
    let mut channels = Vec::new();
    if albedo {
        channels.push(channel("albedo.R", &|guide| guide.albedo.x));
        channels.push(channel("albedo.G", &|guide| guide.albedo.y));
        channels.push(channel("albedo.B", &|guide| guide.albedo.z));
    }
    if id {
        channels.push(channel("id", &|guide| f64::from(guide.id)));
    }
    channels
}

/// The pixels of a part of an image of this size as a data window within the whole, without attributes. Positions are
/// relative to `origin`, m.
pub fn part(pixels: &[Pixel], part: Crop, size: [usize; 2], origin: DVec3) -> Image {
    let whole = Window { position: [0, 0], size };
    let display = (part.pixels() < size[0] * size[1]).then_some(whole);
    Image { window: [part.x as i32, part.y as i32], display, ..about(pixels, part.width, part.height, origin) }
}

/// The pixels as an image without attributes.
pub fn image(pixels: &[Pixel], width: usize, height: usize) -> Image {
    about(pixels, width, height, DVec3::ZERO)
}

/// The pixels as an image without attributes, with positions relative to `origin`, m.
fn about(pixels: &[Pixel], width: usize, height: usize, origin: DVec3) -> Image {
    let channel = |name| Channel { name, samples: vec![0.0; pixels.len()] };
    let mut channels: Vec<Channel> = channel_names().into_iter().map(channel).collect();
    let mut rest: Vec<_> = channels.iter_mut().map(|channel| channel.samples.chunks_mut(CHUNK)).collect();
    let parts: Vec<_> =
        pixels.chunks(CHUNK).map(|part| (part, rest.iter_mut().flat_map(Iterator::next).collect())).collect();
    parts.into_par_iter().for_each(|(part, mut columns): (&[Pixel], Vec<&mut [f32]>)| {
        for (row, pixel) in part.iter().enumerate() {
            columns.iter_mut().zip(pixel.values(origin)).for_each(|(column, x)| column[row] = x);
        }
    });
    Image { width, height, channels, ..Image::default() }
}

/// Pixels whose beauty is below zero in some channel of the file.
pub fn negative_count(pixels: &[Pixel]) -> usize {
    pixels.iter().filter(|p| p.beauty().to_array().iter().any(|x| (*x as f32) < 0.0)).count()
}

/// The relative standard error of the image: the root mean square of the pixels' standard errors over the root mean
/// square of their values, all channels; none for a black image.
pub fn relative_error(pixels: &[Pixel]) -> Option<f64> {
    let variance: f64 = pixels.iter().map(|p| p.variance.element_sum()).sum();
    let power: f64 = pixels.iter().map(|p| p.beauty().length_squared()).sum();
    (power > 0.0).then(|| (variance / power).sqrt())
}

/// The sources of error that [`relative_error`] and the variance of an image without a cloud include.
pub fn covers_of_walks(paths_per_pixel: u32) -> &'static str {
    if paths_per_pixel == 1 { "nothing: one path a pixel" } else { "camera paths and their walks" }
}

/// The sources of error that [`relative_error`] and the variance of an image include, by the number of samples drawn
/// for the second half of the cloud.
pub fn covers(paths_per_pixel: u32, second_half: u64) -> &'static str {
    match (paths_per_pixel, second_half) {
        (1, 0) => "nothing: one path a pixel, one sample",
        (1, _) => "cloud and gather, not the one path a pixel",
        (_, 0) => "camera paths, not the one sample",
        _ => "cloud, gather and camera paths",
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Positions are relative to the origin, and 0 where no surface is met.
    #[test]
    fn positions_relative_to_an_origin() {
        let position = DVec3::new(1e6 + 0.25, 2.0, 3.0);
        let met = Guide { normal: DVec3::Y, position, depth: 1.0, ..Guide::default() };
        let pixels = [met, Guide::default()].map(|guide| Pixel { guide, ..Pixel::default() });
        let crop = Crop { x: 0, y: 0, width: 2, height: 1 };
        let image = part(&pixels, crop, [2, 1], DVec3::new(1e6, 0.0, 1.0));
        let plane = |name: &str| &image.channels.iter().find(|c| c.name == name).expect("a channel").samples;
        assert_eq!(["P.X", "P.Y", "P.Z"].map(plane), [&[0.25, 0.0], &[2.0, 0.0], &[2.0, 0.0]]);
    }

    #[test]
    fn channels_and_values_go_together() {
        assert_eq!(channel_names().len(), Pixel::default().values(DVec3::ZERO).len());
        let guide = Guide { depth: 7.0, ..Guide::default() };
        let image = image(&[Pixel { guide, ..Pixel::default() }], 1, 1);
        assert_eq!(image.channel("Z"), Some(&[7.0][..]));
        assert_eq!(image.channels.len(), 28);
    }
}

//! Pixels: layers, mean and variance, and the channels of the image.

use formats::{Channel, Image};
use scene::DVec3;

/// What a path's light is filed under: its first event.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(usize)]
pub enum Layer {
    /// Light sources and the environment, seen directly or through the first interface.
    Emission = 0,
    /// Through the first interface and out again without being scattered.
    Transmission = 1,
    /// Scattered below the first surface.
    Subsurface = 2,
    /// Mirrored by the first interface.
    Specular = 3,
    /// Reflected by an opaque surface.
    Diffuse = 4,
}

const LAYERS: [&str; 5] = ["emission", "transmission", "subsurface", "specular", "diffuse"];

/// Light of one path, by layer, W/(m² sr).
pub type Layers = [DVec3; 5];

/// Sums over the paths of one pixel.
#[derive(Clone, Copy, Debug, Default)]
pub struct PixelSum {
    layers: Layers,
    count: f64,
    mean: DVec3,
    /// Σ (x − mean)².
    deviation: DVec3,
}

impl PixelSum {
    /// Adds a path (Welford's update: no difference of large squares).
    pub fn add(&mut self, path: &Layers) {
        let total: DVec3 = path.iter().sum();
        self.layers.iter_mut().zip(path).for_each(|(sum, x)| *sum += x);
        self.count += 1.0;
        let before = total - self.mean;
        self.mean += before / self.count;
        self.deviation += before * (total - self.mean);
    }

    /// The finished pixel.
    pub fn pixel(&self, guide: Guide) -> Pixel {
        let layers = self.layers.map(|sum| sum / self.count);
        let variance = if self.count > 1.0 { self.deviation / (self.count * (self.count - 1.0)) } else { DVec3::ZERO };
        Pixel { layers, variance, guide }
    }
}

/// What the ray through the pixel's centre meets first; zero where it meets nothing.
#[derive(Clone, Copy, Debug, Default)]
pub struct Guide {
    pub normal: DVec3,
    /// World position, m.
    pub position: DVec3,
    /// Distance along the view direction, m.
    pub depth: f64,
}

/// A pixel's values.
#[derive(Clone, Copy, Debug, Default)]
pub struct Pixel {
    layers: Layers,
    /// Variance of the mean.
    variance: DVec3,
    guide: Guide,
}

impl Pixel {
    /// `L_o`, W/(m² sr).
    pub fn beauty(&self) -> DVec3 {
        self.layers.iter().sum()
    }

    pub fn variance(&self) -> DVec3 {
        self.variance
    }

    /// All numbers that reach the file, in the order of [`channel_names`].
    fn values(&self) -> [f32; 28] {
        let mut values = [0.0; 28];
        let vectors = [&[self.beauty()], &self.layers[..], &[self.variance, self.guide.normal, self.guide.position]];
        let numbers = vectors.concat().into_iter().flat_map(|v| v.to_array()).chain([self.guide.depth]);
        values.iter_mut().zip(numbers).for_each(|(value, x)| *value = x as f32);
        values
    }

    /// True if every number can go into a file.
    pub fn is_finite(&self) -> bool {
        self.values().iter().all(|x| x.is_finite())
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

/// The pixels as an image without attributes.
pub fn image(pixels: &[Pixel], width: usize, height: usize) -> Image {
    let mut channels: Vec<Channel> =
        channel_names().into_iter().map(|name| Channel { name, samples: Vec::with_capacity(pixels.len()) }).collect();
    for pixel in pixels {
        channels.iter_mut().zip(pixel.values()).for_each(|(channel, x)| channel.samples.push(x));
    }
    Image { width, height, channels, ..Image::default() }
}

/// The relative standard error of the image: the root mean square of the pixels' standard errors over the root mean
/// square of their values, all channels; none for a black image or one path a pixel. It covers the camera paths and the
/// roulette, not the cloud, whose error all pixels share.
pub fn relative_error(pixels: &[Pixel], paths_per_pixel: u32) -> Option<f64> {
    let variance: f64 = pixels.iter().map(|p| p.variance.element_sum()).sum();
    let power: f64 = pixels.iter().map(|p| p.beauty().length_squared()).sum();
    (power > 0.0 && paths_per_pixel > 1).then(|| (variance / power).sqrt())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn mean_and_variance_of_four_paths() {
        let mut sum = PixelSum::default();
        for x in [1.0, 2.0, 3.0, 6.0] {
            let mut layers = [DVec3::ZERO; 5];
            layers[Layer::Subsurface as usize] = DVec3::splat(x);
            sum.add(&layers);
        }
        let pixel = sum.pixel(Guide::default());
        assert_eq!(pixel.beauty(), DVec3::splat(3.0));
        // Σ(x − 3)² = 14; 14/(4·3)
        assert!((pixel.variance() - DVec3::splat(14.0 / 12.0)).length() < 1e-15);
    }

    #[test]
    fn channels_and_values_go_together() {
        assert_eq!(channel_names().len(), Pixel::default().values().len());
        let guide = Guide { depth: 7.0, ..Guide::default() };
        let image = image(&[Pixel { guide, ..Pixel::default() }], 1, 1);
        assert_eq!(image.channel("Z"), Some(&[7.0][..]));
        assert_eq!(image.channels.len(), 28);
    }
}

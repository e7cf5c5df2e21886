//! Chooses how accurate the cut must be from the noise of the paths: a finer cut than they deserve costs time, and a
//! coarser one is most of the image's error.
//!
//! A few pixels all over the image are rendered with a few paths, and rendered again with the same paths and other
//! random numbers of the cut. The two images have the error of paths and cloud in common: the mean product of their
//! halves' differences expects its square, whatever the cut adds to each (docs/method.md 13.9).

use crate::{
    counts::Counts,
    edge::{self, Corner},
    image::Filter,
    passes::Passes,
    path_state::{Layer, ThreadContext},
    pixel_sum::PixelSum,
};
use rayon::prelude::*;
use scene::{
    random::{Purpose, Stream},
    sequence::Sequence,
};
use std::ops::RangeInclusive;
use sums::estimator::Estimator;

/// The relative error that a cut may add to one gather where nothing is known of the paths: of bunny, sphere and dragon
/// at 4 to 64 paths, the squared error times the time is then 1 to 2.5 times the least.
const BALANCED: f64 = 0.02;

/// The paths of a pixel that is tried. It is fixed, so that an image has the same gathers however many paths it has.
const PATHS: u32 = 8;

/// One pixel in so many is tried, of images with enough of them.
const PIXELS_FOR_ONE: usize = 128;
const TRIED: RangeInclusive<usize> = 64..=256;

/// Pixels that are looked at for each that is tried.
const SEEN_FOR_ONE: usize = 16;

/// The error of a gather over that of one path: of two bunnies, sphere, dragon and suzanne at 4 and 16 paths, the squared
/// error times the time is then at most 1.25 times the least.
const SHARE: f64 = 0.65;

/// The range of the error of one gather.
const RANGE: (f64, f64) = (0.005, 0.08);

/// The accuracy of the cut that goes with so many paths of unknown noise.
pub fn unmeasured(paths: u32) -> f64 {
    let least = Estimator::ALL.iter().find_map(|estimator| estimator.accuracy()).unwrap_or(1.0);
    least.min(BALANCED / f64::from(paths).sqrt())
}

impl Passes<'_> {
    /// Measures the noise of the paths, and sets the accuracy of the cut. Nothing changes if another estimator is asked
    /// for, if the image has too few pixels, or if it shows nothing scattered.
    pub(crate) fn balance(&mut self) {
        let paths = f64::from(self.settings().paths_per_pixel);
        if let Some(noise) = self.noise() {
            self.set_accuracy(rounded((SHARE * noise).clamp(RANGE.0, RANGE.1)) / paths.sqrt());
        }
    }

    /// The error of one path, over the root mean square of the scattered light, from [`PATHS`] of each of some pixels.
    fn noise(&mut self) -> Option<f64> {
        let settings = self.settings();
        let count = (settings.width * settings.height / PIXELS_FOR_ONE).min(*TRIED.end());
        let is_cut = settings.estimator.is_hierarchical() && settings.paths_per_pixel > 1 && !settings.reference;
        if !is_cut || count < *TRIED.start() {
            return None;
        }
        let (own, stream) = (self.renderer().gathers, Stream::new(settings.seed, Purpose::Balance));
        let pixels = self.pixels_to_try(count, stream);
        let tried = |passes: &Self| -> Vec<PixelSum> { pixels.par_iter().map(|pixel| passes.tried(pixel)).collect() };
        let [first, again] = [own, stream].map(|gathers| self.trying(PATHS, gathers, tried));
        relative_noise(pixels.iter().map(|pixel| pixel.weight).zip(first.iter().zip(&again)))
    }

    /// Up to `count` pixels, spread over the image by kind.
    fn pixels_to_try(&self, count: usize, stream: Stream) -> Vec<Tried> {
        let size = self.settings().size();
        let spread = Sequence::new(stream.item(0), stream);
        let seen = |index: u32| {
            let [x, y, ..] = spread.point(index);
            let at = [x * size.x, y * size.y].map(|place| place as usize);
            let corner = |[x, y]: [usize; 2]| self.seen_at_corner([at[0] + x, at[1] + y], &mut Counts::default());
            Tried { at, corners: [[0, 0], [1, 0], [0, 1], [1, 1]].map(corner), weight: 1.0 }
        };
        let seen: Vec<Tried> = (0..(SEEN_FOR_ONE * count) as u32).into_par_iter().map(seen).collect();
        let of_kind = |kind: Kind| {
            let mut pixels: Vec<Tried> = seen.iter().filter(|pixel| pixel.kind() == kind).copied().collect();
            let found = pixels.len();
            pixels.truncate(count * kind.eighths() / 8);
            let weight = found as f64 / pixels.len() as f64;
            pixels.into_iter().map(move |pixel| Tried { weight, ..pixel })
        };
        [Kind::Edge, Kind::Within, Kind::Beside].into_iter().flat_map(of_kind).collect()
    }

    /// The sums of a pixel of the image with [`PATHS`] paths.
    fn tried(&self, pixel: &Tried) -> PixelSum {
        let mut context = ThreadContext::new(self.renderer().objects.len());
        let edge = match self.settings().filter {
            Filter::Box => edge::is_between(pixel.corners),
            Filter::Point => false,
        };
        self.add_to(pixel.at, (PixelSum::default(), edge), 0..PATHS, &mut context)
    }
}

/// A pixel that is tried.
#[derive(Clone, Copy)]
struct Tried {
    at: [usize; 2],
    corners: [Corner; 4],
    /// The number of pixels that it stands for, relative to those of other kinds.
    weight: f64,
}

impl Tried {
    fn kind(&self) -> Kind {
        if edge::is_between(self.corners) {
            Kind::Edge
        } else if self.corners.iter().flatten().any(|[_, high]| *high > 0.0) {
            Kind::Within
        } else {
            Kind::Beside
        }
    }
}

/// A pixel at the silhouette of a translucent surface, within one, or beside all.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Kind {
    Edge,
    Within,
    Beside,
}

impl Kind {
    /// The share of the tried pixels. Half of the noise of an image may be that of one pixel in a hundred, at
    /// silhouettes; where no light is scattered there is little of it.
    fn eighths(self) -> usize {
        match self {
            Kind::Edge => 4,
            Kind::Within => 3,
            Kind::Beside => 1,
        }
    }
}

/// The error of one path over the root mean square of the scattered light, from two images of the same paths, whose
/// pixels have weights.
fn relative_noise<'a>(pixels: impl Iterator<Item = (f64, (&'a PixelSum, &'a PixelSum))>) -> Option<f64> {
    let (mut variance, mut power) = (0.0, 0.0);
    for (weight, (one, other)) in pixels {
        variance += weight * one.shared_variance(other).element_sum();
        power += weight * one.layers()[Layer::Subsurface as usize].length_squared();
    }
    (power > 0.0).then(|| (f64::from(PATHS) * variance.max(0.0) / power).sqrt())
}

/// Two digits of a number, as it is stated in files.
fn rounded(x: f64) -> f64 {
    format!("{x:.1e}").parse().unwrap_or(x)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::path_state::PathLight;
    use scene::DVec3;

    /// Paths of the noise 0.3 in pixels that count three times, and cuts that add twice as much; other pixels have twice
    /// the light without noise. Only the noise of the paths counts, by the weights: its square over that of the light is
    /// 3 · 0.09/(3 + 4). A fourth of the squared differences of 20,000 pixels has a standard deviation of 4 %, so that
    /// the tolerance is five of them.
    ///
    /// Seen to catch: the square of one image in place of the product; the error of a pixel for that of a path; weights
    /// left out of the light, of the noise and of both.
    #[test]
    fn what_the_cut_adds_is_not_counted() {
        let stream = Stream::new(3, Purpose::Balance);
        let normal = |item: u64| (0..12).map(|d| stream.item(item).uniform(d)).sum::<f64>() - 6.0;
        let image = |own: u64| -> Vec<PixelSum> {
            let pixel = |index: u64| {
                let mut sum = PixelSum::default();
                for path in 0..PATHS {
                    let item = index << 8 | u64::from(path);
                    let noise = 0.3 * normal(item) + 0.6 * normal(item | own << 32);
                    let (light, noise) = if index.is_multiple_of(2) { (2.0, noise) } else { (4.0, 0.0) };
                    let halves = [DVec3::splat(light * (1.0 + noise)); 2];
                    let mut of_path = PathLight { halves, ..PathLight::default() };
                    of_path.layers[Layer::Subsurface as usize] = DVec3::splat(light);
                    sum.add(path, false, &of_path);
                }
                sum
            };
            (0..40_000).map(pixel).collect()
        };
        let weights = [3.0, 1.0].into_iter().cycle();
        let noise = relative_noise(weights.zip(image(1).iter().zip(&image(2)))).expect("light");
        let expected = 0.3 * (3.0 / 7.0f64).sqrt();
        assert!((noise / expected - 1.0).abs() < 0.1, "{noise} for {expected}");
    }

    /// Seen to catch: within and beside exchanged; an edge by the first corner alone.
    #[test]
    fn pixels_are_of_three_kinds() {
        let kind =
            |corners: [f64; 4]| Tried { at: [0; 2], corners: corners.map(|c| [[c; 2], [0.0; 2]]), weight: 1.0 }.kind();
        assert!(kind([0.0; 4]) == Kind::Beside && kind([0.9; 4]) == Kind::Within);
        assert!(kind([0.9, 0.9, 0.9, 0.0]) == Kind::Edge);
        assert_eq!([Kind::Edge, Kind::Within, Kind::Beside].map(Kind::eighths).iter().sum::<usize>(), 8);
    }

    #[test]
    fn nothing_is_known_of_black_pixels() {
        assert_eq!(relative_noise([(1.0, (&PixelSum::default(), &PixelSum::default()))].into_iter()), None);
    }

    #[test]
    fn two_digits_are_stated() {
        assert_eq!([0.0123456, 0.005, 0.149].map(rounded), [0.012, 0.005, 0.15]);
    }
}

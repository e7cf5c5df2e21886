//! Chooses how accurate the cut must be from the noise of the paths: a finer cut than they deserve costs time, and a
//! coarser one is most of the image's error.
//!
//! A few pixels all over the image are rendered with a few paths, and rendered again with the same paths and other
//! random numbers of the cut. The two images have the error of paths and cloud in common: the mean product of their
//! halves' differences expects its square, whatever the cut adds to each (docs/method.md 13.9).

use crate::{
    counts::Counts,
    edge,
    image::Filter,
    passes::Passes,
    path_state::{Layer, ThreadContext},
    pixel_sum::{PixelSum, Sums},
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
const TRIED: RangeInclusive<usize> = 64..=512;

/// The error of a gather over that of an image of [`PATHS`] independent paths. The cost of a cut rises about as the
/// inverse of its accuracy, and half of a path's cost is not the cut's.
const SHARE: f64 = 0.35;

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
        let (size, own) = (settings.size(), self.renderer().gathers);
        let stream = Stream::new(settings.seed, Purpose::Balance);
        let spread = Sequence::new(stream.item(0), stream);
        let pixels: Vec<[usize; 2]> = (0..count as u32)
            .map(|index| {
                let [x, y, ..] = spread.point(index);
                [x * size.x, y * size.y].map(|place| place as usize)
            })
            .collect();
        let tried = |passes: &Self| -> Vec<Sums> { pixels.par_iter().map(|pixel| passes.tried(*pixel)).collect() };
        let [first, again] = [own, stream].map(|gathers| self.trying(PATHS, gathers, tried));
        relative_noise(first.iter().zip(&again))
    }

    /// The sums of a pixel of the image with [`PATHS`] paths.
    fn tried(&self, pixel: [usize; 2]) -> Sums {
        let mut context = ThreadContext::new(self.renderer().objects.len());
        let corner = |[x, y]: [usize; 2]| self.through_corner([pixel[0] + x, pixel[1] + y], &mut Counts::default());
        let edge = match self.settings().filter {
            Filter::Box => edge::across([[0, 0], [1, 0], [0, 1], [1, 1]].map(corner)),
            Filter::Point => None,
        };
        self.add_to(pixel, (PixelSum::default(), edge), 0..PATHS, &mut context)
    }
}

/// The error of one path over the root mean square of the scattered light, from two images of the same paths.
fn relative_noise<'a>(pairs: impl Iterator<Item = (&'a Sums, &'a Sums)>) -> Option<f64> {
    let (mut variance, mut power) = (0.0, 0.0);
    for ((one, edge), (other, other_edge)) in pairs {
        let (edge, other_edge) = (edge.as_deref(), other_edge.as_deref());
        variance += one.shared_variance(edge, other, other_edge).element_sum();
        power += one.layers(edge)[Layer::Subsurface as usize].length_squared();
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

    /// Paths of the noise 0.3, and cuts that add twice as much: only the first counts. A fourth of the squared
    /// differences of 20,000 pixels has a standard deviation of 4 %, so that the tolerance is five of them.
    ///
    /// Seen to catch: the square of one image in place of the product; the error of a pixel for that of a path.
    #[test]
    fn what_the_cut_adds_is_not_counted() {
        let stream = Stream::new(3, Purpose::Balance);
        let normal = |item: u64| (0..12).map(|d| stream.item(item).uniform(d)).sum::<f64>() - 6.0;
        let image = |own: u64| -> Vec<Sums> {
            let pixel = |index: u64| {
                let mut sum = PixelSum::default();
                for path in 0..PATHS {
                    let item = index << 8 | u64::from(path);
                    let light = DVec3::splat(2.0 * (1.0 + 0.3 * normal(item) + 0.6 * normal(item | own << 32)));
                    let mut of_path = PathLight { halves: [light; 2], ..PathLight::default() };
                    of_path.layers[Layer::Subsurface as usize] = DVec3::splat(2.0);
                    sum.add(path, false, &of_path);
                }
                (sum, None)
            };
            (0..20_000).map(pixel).collect()
        };
        let noise = relative_noise(image(1).iter().zip(&image(2))).expect("light");
        assert!((noise - 0.3).abs() < 0.03, "{noise}");
    }

    #[test]
    fn nothing_is_known_of_black_pixels() {
        assert_eq!(relative_noise([(&Sums::default(), &Sums::default())].into_iter()), None);
    }

    #[test]
    fn two_digits_are_stated() {
        assert_eq!([0.0123456, 0.005, 0.149].map(rounded), [0.012, 0.005, 0.15]);
    }
}

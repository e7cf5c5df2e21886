//! The sums over the paths of one pixel, with its mean and variance.

use crate::{
    film::Pixel,
    path_state::{Guide, Layers, PathLight},
};
use scene::DVec3;

/// Sums over the paths of one pixel.
#[derive(Clone, Copy, Debug, Default)]
pub struct PixelSum {
    layers: Layers,
    count: f64,
    /// Sums over the even and over the odd paths; each path counts as its own half of the cloud estimates it.
    halves: [DVec3; 2],
    /// Sums of the squares of the same values.
    squares: [DVec3; 2],
    pub(crate) counts: [f64; 2],
}

impl PixelSum {
    /// Adds a path. The only path of a pixel counts for both halves.
    pub fn add(&mut self, index: u32, alone: bool, path: &PathLight) {
        self.layers.iter_mut().zip(&path.layers).for_each(|(sum, x)| *sum += x);
        self.count += 1.0;
        for half in 0..2 {
            if alone || index as usize % 2 == half {
                self.halves[half] += path.halves[half];
                self.squares[half] += path.halves[half] * path.halves[half];
                self.counts[half] += 1.0;
            }
        }
    }

    /// How many numbers the sums consist of, without those that follow from the number of paths.
    pub(crate) const NUMBERS: usize = 27;

    /// The sums as numbers.
    pub(crate) fn numbers(&self) -> [f64; PixelSum::NUMBERS] {
        let mut vectors = self.layers.iter().chain(&self.halves).chain(&self.squares).flat_map(|v| v.to_array());
        std::array::from_fn(|_| vectors.next().unwrap_or_default())
    }

    /// The sums of so many paths, at least two, from their numbers.
    pub(crate) fn from_numbers(paths: u32, numbers: [f64; PixelSum::NUMBERS]) -> PixelSum {
        let vector = |k: usize| DVec3::new(numbers[3 * k], numbers[3 * k + 1], numbers[3 * k + 2]);
        PixelSum {
            layers: std::array::from_fn(vector),
            count: f64::from(paths),
            halves: [5, 6].map(vector),
            squares: [7, 8].map(vector),
            counts: [paths.div_ceil(2), paths / 2].map(f64::from),
        }
    }

    /// The light of the pixel, W/(m² sr).
    pub(crate) fn light(&self) -> DVec3 {
        self.layers().iter().sum()
    }

    /// The difference of the means of the two halves.
    pub(crate) fn difference(&self) -> DVec3 {
        let mean = |half: usize| self.halves[half] / self.counts[half];
        mean(0) - mean(1)
    }

    /// Two estimates of the pixel's variance: from the difference of the halves, which includes the error of the cloud,
    /// and from the variance of the paths within each half. The second expects the paths' part of the first if paths
    /// are independent, and more than that if they are stratified. Of a half with a single path nothing is known but
    /// what the other half tells; where both have one, all of their difference counts as the paths'.
    pub(crate) fn variances(&self) -> [DVec3; 2] {
        let difference = self.difference();
        let between = difference * difference / 4.0;
        let of_path = |half: usize| {
            let (n, mean) = (self.counts[half], self.halves[half] / self.counts[half]);
            (n > 1.0).then(|| (self.squares[half] / n - mean * mean).max(DVec3::ZERO) * (n / (n - 1.0)))
        };
        let of_mean = |variances: [DVec3; 2]| variances[0] / self.counts[0] + variances[1] / self.counts[1];
        let within = match [of_path(0), of_path(1)] {
            // Both halves of a single path have the same light but for the cloud.
            _ if self.count < 2.0 => DVec3::ZERO,
            [Some(one), Some(other)] => of_mean([one, other]) / 4.0,
            [Some(known), None] | [None, Some(known)] => of_mean([known; 2]) / 4.0,
            [None, None] => between,
        };
        [between, within]
    }

    /// A quarter of the product of the differences of the halves of two images of the same paths: their mean expects
    /// the pixel's variance without the part in which the images differ.
    pub(crate) fn shared_variance(&self, other: &PixelSum) -> DVec3 {
        self.difference() * other.difference() / 4.0
    }

    /// Mean light of each layer.
    pub(crate) fn layers(&self) -> Layers {
        self.layers.map(|sum| sum / self.count)
    }

    /// The finished pixel. The halves have the same expectation and are independent, so a quarter of the squared
    /// difference estimates the variance of their mean.
    pub fn pixel(&self, guide: Guide) -> Pixel {
        Pixel::new(self.layers(), self.variances()[0], guide)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::path_state::Layer;

    #[test]
    fn mean_and_variance_of_four_paths() {
        let mut sum = PixelSum::default();
        for (index, x) in [1.0, 2.0, 3.0, 6.0].into_iter().enumerate() {
            let mut path = PathLight { halves: [DVec3::splat(x), DVec3::splat(-x)], ..PathLight::default() };
            path.layers[Layer::Subsurface as usize] = DVec3::splat(x);
            sum.add(index as u32, false, &path);
        }
        let pixel = sum.pixel(Guide::default());
        assert_eq!(pixel.beauty(), DVec3::splat(3.0));
        // Even paths have the mean 2, odd ones, by their half, −4.
        assert_eq!(pixel.variance(), DVec3::splat(9.0));
    }

    /// By hand: of 1, 2, 3, 6 the even paths 1 and 3 vary by 2, the odd ones by 8: (2/2 + 8/2)/4; of three paths the odd
    /// one counts like the even ones, (2/2 + 2/1)/4; two paths differ by 1; one path tells nothing.
    ///
    /// Seen to catch: a half of one path that does not vary; the difference of two paths left to the cloud, and that of a
    /// single path's halves not.
    #[test]
    fn the_variance_of_paths_is_known_from_two_paths_on() {
        let within = |paths: &[f64]| {
            let mut sum = PixelSum::default();
            for (index, x) in paths.iter().enumerate() {
                let halves = [DVec3::splat(*x), DVec3::splat(if paths.len() == 1 { 9.0 } else { *x })];
                sum.add(index as u32, paths.len() == 1, &PathLight { halves, ..PathLight::default() });
            }
            sum.variances()[1].x
        };
        let found = [&[1.0, 2.0, 3.0, 6.0][..], &[1.0, 2.0, 3.0], &[1.0, 2.0], &[1.0]].map(within);
        assert_eq!(found, [1.25, 0.75, 0.25, 0.0]);
    }

    #[test]
    fn one_path_estimates_the_error_of_the_cloud() {
        let mut sum = PixelSum::default();
        sum.add(0, true, &PathLight { halves: [DVec3::splat(2.0), DVec3::splat(3.0)], ..PathLight::default() });
        assert_eq!(sum.pixel(Guide::default()).variance(), DVec3::splat(0.25));
    }
}

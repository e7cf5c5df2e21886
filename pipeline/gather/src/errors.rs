//! The errors of an image, estimated from the sums of its pixels.

use crate::{
    freedom::{self, Cells},
    path_state::Layer,
    pixel_sum::PixelSum,
};
use scene::DVec3;
use sums::confidence::Estimate;

/// Relative standard errors of an image: the root mean square of the pixels' errors over that of their values.
#[derive(Clone, Copy, Debug, Default)]
pub struct Errors {
    /// The error of cloud and paths together.
    pub total: f64,
    /// The error of the paths if they were independent; stratified ones have less.
    pub paths: f64,
    /// A lower bound of the error that more paths cannot remove.
    pub cloud: f64,
    /// Degrees of freedom of the estimate of the cloud's error.
    pub cloud_freedom: f64,
    /// Degrees of freedom of the estimate of the paths' error.
    pub paths_freedom: f64,
    /// Number of paths in one half of the pixel that has the fewest.
    pub half: f64,
    /// Root mean square of the scattered light, relative to that of all light.
    pub scattered: f64,
}

impl Errors {
    /// The errors of an image of this size from its pixels, row by row; none for a black image.
    pub fn of<'a>(size: [usize; 2], pixels: impl Iterator<Item = &'a PixelSum>) -> Option<Errors> {
        let (mut power, mut scattered, mut half) = (0.0, 0.0, f64::INFINITY);
        let (mut total, mut paths, mut squares, mut total_squares) = (0.0, 0.0, 0.0, 0.0);
        let mut cells = Cells::new(size);
        for (pixel, sum) in pixels.enumerate() {
            let layers = sum.layers();
            let [between, within] = sum.variances().map(DVec3::element_sum);
            power += layers.iter().sum::<DVec3>().length_squared();
            scattered += layers[Layer::Subsurface as usize].length_squared();
            total += between;
            paths += within;
            squares += within * within;
            total_squares += between * between;
            half = half.min(sum.counts[1]);
            cells.add(pixel, sum.difference());
        }
        let relative = |variance: f64| (variance.max(0.0) / power).sqrt();
        // The channels of a pixel are correlated and count as one value.
        let paths_freedom = paths_freedom([paths, squares], [total, total_squares]);
        let cloud_freedom = cells.freedom();
        let [total, paths, cloud, scattered] = [total, paths, total - paths, scattered].map(relative);
        (power > 0.0).then_some(Errors { total, paths, cloud, cloud_freedom, paths_freedom, half, scattered })
    }

    /// The error that is compared with a target. With few degrees of freedom the halves may agree by chance; then the
    /// error is at least that of stratified paths, whose variance falls with their number to the power 3/2 where edges
    /// cross a pixel. None if all paths agree, which gives no estimate.
    pub fn estimate(&self) -> Option<Estimate> {
        let (paths, cloud) = (self.paths.min(self.total), self.cloud);
        let parts = [(paths * paths, self.paths_freedom), (cloud * cloud, self.cloud_freedom)];
        let freedom = freedom::of_sum(parts);
        let floor = self.paths / self.half.max(1.0).powf(0.25);
        let error = if freedom < MIN_FREEDOM { self.total.max(floor) } else { self.total };
        (error > 0.0).then_some(Estimate { error, freedom })
    }
}

/// The degrees of freedom of the paths' error, from the sums over the pixels of their two variances and of the squares of
/// these: by the scatter within halves, and by the difference of the halves. The square of a difference has a mean square
/// of three times its squared mean.
fn paths_freedom([within, within_squares]: [f64; 2], [between, between_squares]: [f64; 2]) -> f64 {
    let freedom = |sum: f64, squares: f64| if squares > 0.0 { (sum * sum / squares).max(1.0) } else { 1.0 };
    freedom(within, within_squares).min(freedom(between, between_squares / 3.0))
}

/// Degrees of freedom that give an error a relative uncertainty of an eighth.
const MIN_FREEDOM: f64 = 32.0;

#[cfg(test)]
mod tests {
    use super::*;

    /// By hand: 100 pixels of variance 1, whose differences have the mean square 3; then so few of them that they are
    /// less certain than the scatter; then halves that agree.
    ///
    /// Seen to catch: the scatter within halves alone; the factor three left out.
    #[test]
    fn few_pixels_have_few_degrees_of_freedom() {
        assert_eq!(paths_freedom([100.0, 100.0], [100.0, 300.0]), 100.0);
        assert!((paths_freedom([100.0, 100.0], [50.0, 300.0]) - 25.0).abs() < 1e-9);
        assert_eq!(paths_freedom([100.0, 100.0], [0.0, 0.0]), 1.0);
        assert_eq!(paths_freedom([0.0; 2], [0.0; 2]), 1.0);
    }
}

//! A control variate for pixels at silhouettes, where the transmittance of the first interface varies more than the
//! light below it. A single ray gives that transmittance.
//!
//! A path's scattered light is `f = g s`, with the transmittance `g` of the first interface, 0 where the path meets
//! something else, and the light `s` below it. Many rays give a precise mean `G` of `g`. With the means `f̄` and `ḡ` of
//! the paths, `f̄ + c (G − ḡ)` has the expectation of `f` for any `c` that is independent of these paths. Each half of
//! a pixel takes its `c` from the other half, and has rays of its own. A pixel may become slightly negative; clamping
//! it would bias the mean.

use crate::path_state::{Layer, PathLight};
use scene::DVec3;

/// A pixel is at an edge if `g` differs by more than this between its corners.
const MIN_SPREAD: f64 = 0.1;

/// Number of rays for each path.
pub const RAYS: u32 = 16;

/// Sums over the paths and rays of one edge pixel, by halves.
#[derive(Clone, Copy, Debug, Default)]
pub struct Edge([Half; 2]);

#[derive(Clone, Copy, Debug, Default)]
struct Half {
    paths: f64,
    /// Sum of `f`.
    scattered: DVec3,
    /// Sums of `g`, of `g²`, and of `g` times all light of the path.
    through: f64,
    squares: f64,
    products: DVec3,
    rays: f64,
    /// Sum of `g` over the rays.
    through_rays: f64,
}

/// The sums of a pixel if it is an edge pixel, by the least and largest transmittance at its corners.
pub fn across(corners: [[f64; 2]; 4]) -> Option<Box<Edge>> {
    let highest = corners.into_iter().map(|[_, high]| high).fold(0.0, f64::max);
    let spread = highest - corners.into_iter().map(|[low, _]| low).fold(1.0, f64::min);
    (spread > MIN_SPREAD).then(Box::default)
}

impl Edge {
    /// Adds a path of one half.
    pub fn add_path(&mut self, half: usize, path: &PathLight) {
        let sum = &mut self.0[half];
        sum.paths += 1.0;
        sum.scattered += path.layers[Layer::Subsurface as usize];
        sum.through += path.through;
        sum.squares += path.through * path.through;
        sum.products += path.through * path.halves[half];
    }

    /// Adds a ray of one half.
    pub fn add_ray(&mut self, half: usize, through: f64) {
        self.0[half].rays += 1.0;
        self.0[half].through_rays += through;
    }

    /// How many numbers the sums consist of, without those that follow from the number of paths.
    pub const NUMBERS: usize = 18;

    /// The sums as numbers, one half after the other.
    pub fn numbers(&self) -> [f64; Edge::NUMBERS] {
        let mut numbers = self.0.iter().flat_map(|half| {
            let [scattered, products] = [half.scattered, half.products].map(|v| v.to_array());
            scattered.into_iter().chain(products).chain([half.through, half.squares, half.through_rays])
        });
        std::array::from_fn(|_| numbers.next().unwrap_or_default())
    }

    /// The sums of so many paths of a pixel from their numbers.
    pub fn from_numbers(paths: u32, numbers: [f64; Edge::NUMBERS]) -> Edge {
        let half = |half: usize| {
            let x = &numbers[half * Edge::NUMBERS / 2..];
            let own = if half == 0 { paths.div_ceil(2) } else { paths / 2 };
            Half {
                paths: f64::from(own),
                scattered: DVec3::new(x[0], x[1], x[2]),
                products: DVec3::new(x[3], x[4], x[5]),
                through: x[6],
                squares: x[7],
                rays: f64::from(own) * f64::from(RAYS),
                through_rays: x[8],
            }
        };
        Edge([half(0), half(1)])
    }

    /// `c` of one half: `Σf/Σg` of the other.
    fn factor(&self, half: usize) -> DVec3 {
        let other = &self.0[1 - half];
        if other.through > 0.0 { other.scattered / other.through } else { DVec3::ZERO }
    }

    /// `c (G − ḡ)` of one half.
    pub fn correction(&self, half: usize) -> DVec3 {
        let own = &self.0[half];
        if own.rays == 0.0 {
            return DVec3::ZERO;
        }
        self.factor(half) * (own.through_rays / own.rays - own.through / own.paths)
    }

    /// The amounts by which subtracting `c g` from the light of each path lowers the mean and the mean square of a
    /// half.
    pub fn removed(&self, half: usize) -> (DVec3, DVec3) {
        let (own, factor) = (&self.0[half], self.factor(half));
        let (mean, square) = (factor * own.through, factor * (2.0 * own.products - factor * own.squares));
        (mean / own.paths, square / own.paths)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Seen to catch: the mean square without the square of `g`.
    #[test]
    fn with_constant_light_below_the_rays_alone_decide() {
        let below = DVec3::new(3.0, 2.0, 1.0);
        let mut edge = Edge::default();
        for (half, through) in [(0, 0.9), (1, 0.0), (0, 0.5), (1, 0.8)] {
            let mut path = PathLight { halves: [below * through; 2], through, ..PathLight::default() };
            path.layers[Layer::Subsurface as usize] = below * through;
            edge.add_path(half, &path);
        }
        [(0, 0.6), (0, 0.8), (1, 0.7), (1, 0.3)].into_iter().for_each(|(half, g)| edge.add_ray(half, g));
        let means = [below * 0.7, below * 0.4];
        let squares = [below * below * 0.53, below * below * 0.32];
        for (half, rays) in [0.7, 0.5].into_iter().enumerate() {
            assert!((means[half] + edge.correction(half)).abs_diff_eq(below * rays, 1e-12));
            let (of_mean, of_square) = edge.removed(half);
            assert!(of_mean.abs_diff_eq(means[half], 1e-12) && of_square.abs_diff_eq(squares[half], 1e-12));
        }
    }
}

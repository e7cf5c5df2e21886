//! Edges and points, which are seen even where their color differs little, as first and second derivatives of light.

use super::contrast::PIXELS_PER_DEGREE;
use crate::metric::convolve::gaussian;

/// The width of the detectors in degrees, the paper's w.
const WIDTH: f64 = 0.082;

/// The taps of the detectors along one dimension.
#[derive(Clone, Debug)]
pub(super) struct Detectors {
    /// The taps across the direction of the derivative. They sum to 1.
    pub smooth: Vec<f32>,
    /// The taps of the first derivative. Each side sums to 1.
    pub edge: Vec<f32>,
    /// The taps of the second derivative. The positive ones of both sides sum to 1, the others with the middle to -1.
    pub point: Vec<f32>,
}

impl Default for Detectors {
    /// The detectors for the screen of [`PIXELS_PER_DEGREE`].
    fn default() -> Detectors {
        let sigma = 0.5 * WIDTH * PIXELS_PER_DEGREE;
        let smooth = gaussian(sigma, (3.0 * sigma).ceil() as usize);
        let times = |factor: fn(f64) -> f64| smooth.iter().enumerate().map(move |(i, g)| factor(i as f64 / sigma) * g);
        let edge: Vec<f64> = times(|x| x).collect();
        let side: f64 = edge.iter().sum();
        let point: Vec<f64> = times(|x| x * x - 1.0).collect();
        let both = |part: fn(f64) -> f64| 2.0 * point.iter().copied().map(part).sum::<f64>() - part(point[0]);
        let (positive, negative) = (both(|tap| tap.max(0.0)), both(|tap| (-tap).max(0.0)));
        let balanced = point.iter().map(|tap| tap / if *tap > 0.0 { positive } else { negative });
        Detectors {
            smooth: smooth.iter().map(|tap| *tap as f32).collect(),
            edge: edge.iter().map(|tap| (tap / side) as f32).collect(),
            point: balanced.map(|tap| tap as f32).collect(),
        }
    }
}

/// The difference, 0 to 1, of the edges and points of reference and test at a pixel. The paper's exponent q_f is a
/// half.
#[inline(always)]
pub(super) fn difference(edges: [f32; 2], points: [f32; 2]) -> f32 {
    let largest = (edges[0] - edges[1]).abs().max((points[0] - points[1]).abs());
    (largest * std::f32::consts::FRAC_1_SQRT_2).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::metric::tile::HALO;

    #[test]
    fn weights_are_normalized() {
        let Detectors { smooth, edge, point } = Detectors::default();
        assert_eq!(smooth.len(), 10);
        assert!(smooth.len() <= HALO + 1);
        assert!((edge.iter().sum::<f32>() - 1.0).abs() < 1e-6 && edge[0] == 0.0);
        let positive = 2.0 * point.iter().filter(|tap| **tap > 0.0).sum::<f32>();
        assert!((positive - 1.0).abs() < 1e-6);
        assert!((point[0] + 2.0 * point[1..].iter().sum::<f32>()).abs() < 1e-6);
    }

    #[test]
    fn the_larger_of_both_counts() {
        let step = 0.5 * std::f32::consts::SQRT_2;
        assert!((difference([1.0, 1.0 - step], [0.1, 0.0]) - 0.5f32.sqrt()).abs() < 1e-6);
        assert!((difference([0.2, 0.2], [0.0, step]) - 0.5f32.sqrt()).abs() < 1e-6);
        assert_eq!(difference([0.3; 2], [0.4; 2]), 0.0);
    }
}

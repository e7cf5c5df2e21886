//! Mixtures of directions about axes, whose density is known everywhere.

use scene::DVec3;
use std::f64::consts::TAU;

/// The most lobes of a mixture.
pub const MOST: usize = 32;

/// Directions at an angle θ from an axis: the density falls as `1/(c + 1 − cos θ)²`, which leaves no direction out.
#[derive(Clone, Copy, Debug, Default)]
struct Lobe {
    axis: DVec3,
    /// `c`: half the square of the angle, radians, within which about half of the directions lie.
    spread: f64,
    /// The sum of the weights of this lobe and all before it.
    weight_so_far: f64,
}

/// A mixture of lobes.
#[derive(Clone, Copy, Debug, Default)]
pub struct Lobes {
    lobes: [Lobe; MOST],
    count: usize,
    total: f64,
}

impl Lobes {
    /// Adds directions about a unit `axis` with a weight; half of them are within the angle `width`, radians. A lobe without
    /// weight is left out, and so are those beyond [`MOST`].
    pub fn add(&mut self, axis: DVec3, width: f64, weight: f64) {
        if weight > 0.0 && self.count < MOST {
            self.total += weight;
            self.lobes[self.count] = Lobe { axis, spread: 0.5 * width * width, weight_so_far: self.total };
            self.count += 1;
        }
    }

    pub fn is_empty(&self) -> bool {
        self.count == 0
    }

    /// A unit direction. There must be a lobe.
    pub fn sample(&self, [choice, across, around]: [f64; 3]) -> DVec3 {
        let lobes = &self.lobes[..self.count];
        let chosen = lobes.partition_point(|lobe| lobe.weight_so_far <= choice * self.total).min(self.count - 1);
        let Lobe { axis, spread: c, .. } = lobes[chosen];
        // Of a lobe, the share (1/c − 1/(c + u))/(1/c − 1/(c + 2)) has 1 − cos θ below u.
        let u = 2.0 * c * across / (2.0 + c - 2.0 * across);
        let (sine, cosine) = (TAU * around).sin_cos();
        let (x, y) = axis.any_orthonormal_pair();
        let radius = (u * (2.0 - u)).max(0.0).sqrt();
        (axis * (1.0 - u) + x * (radius * cosine) + y * (radius * sine)).normalize()
    }

    /// The density of [`Lobes::sample`], 1/sr.
    pub fn density(&self, direction: DVec3) -> f64 {
        let (mut sum, mut before) = (0.0, 0.0);
        for Lobe { axis, spread: c, weight_so_far } in &self.lobes[..self.count] {
            // Half the square of the distance is 1 − cos θ, and keeps its digits.
            let u = 0.5 * direction.distance_squared(*axis);
            sum += (weight_so_far - before) * c * (c + 2.0) / (2.0 * TAU * (c + u).powi(2));
            before = *weight_so_far;
        }
        sum / self.total
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use scene::random::{Purpose, Stream};

    fn mixture() -> Lobes {
        let mut lobes = Lobes::default();
        lobes.add(DVec3::Z, 0.02, 0.0);
        lobes.add(DVec3::new(0.6, 0.0, 0.8), 0.3, 2.0);
        lobes.add(DVec3::NEG_X, 1.0, 1.0);
        lobes
    }

    /// The mean of five functions over drawn directions is their integral with the density, over cells of equal solid
    /// angle; the density integrates to 1. Within 4.5 standard errors and 10⁻³: by chance once in 30,000 runs.
    ///
    /// Seen to catch: `c` for `c + 2`; draws of another distribution; weights that are not of their own lobe.
    #[test]
    fn directions_have_their_density() {
        let (lobes, item) = (mixture(), Stream::new(1, Purpose::Highlight));
        let functions = |d: DVec3| [d.x, d.y, d.z, f64::from(u8::from(d.x > 0.6 && d.z > 0.5)), d.z * d.z];
        let cells = 2000;
        let mut expected = [0.0; 6];
        for k in 0..cells * cells {
            let [z, angle] = [k / cells, k % cells].map(|k| (k as f64 + 0.5) / cells as f64);
            let (z, (sine, cosine)) = (2.0 * z - 1.0, (TAU * angle).sin_cos());
            let radius = (1.0 - z * z).sqrt();
            let direction = DVec3::new(radius * cosine, radius * sine, z);
            let share = lobes.density(direction) * 2.0 * TAU / (cells * cells) as f64;
            let values = functions(direction);
            (0..5).for_each(|k| expected[k] += values[k] * share);
            expected[5] += share;
        }
        assert!((expected[5] - 1.0).abs() < 1e-3, "{expected:?}");
        let count = 200_000;
        let (mut sums, mut squares) = ([0.0; 5], [0.0; 5]);
        for k in 0..count {
            let direction = lobes.sample([0, 1, 2].map(|d| item.item(k).uniform(d)));
            assert!((direction.length() - 1.0).abs() < 1e-12);
            for (k, value) in functions(direction).into_iter().enumerate() {
                sums[k] += value;
                squares[k] += value * value;
            }
        }
        for k in 0..5 {
            let mean = sums[k] / count as f64;
            let error = ((squares[k] / count as f64 - mean * mean) / count as f64).sqrt();
            assert!((mean - expected[k]).abs() < 4.5 * error + 1e-3, "{k}: {mean} +- {error}, {}", expected[k]);
        }
    }

    /// The ends of the numbers give directions; more lobes than there is room for are left out.
    #[test]
    fn ends_and_many_lobes() {
        let mut lobes = mixture();
        (0..2 * MOST).for_each(|_| lobes.add(DVec3::Y, 1e-3, 1.0));
        for choice in [0.0, 1.0 - f64::EPSILON] {
            for across in [0.0, 1.0 - f64::EPSILON] {
                let direction = lobes.sample([choice, across, 0.3]);
                assert!(direction.is_finite() && lobes.density(direction) > 0.0, "{choice} {across} {direction}");
            }
        }
        assert!(Lobes::default().is_empty() && !lobes.is_empty());
    }
}

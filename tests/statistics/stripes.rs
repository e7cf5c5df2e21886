//! Stripes of two media in a half-space: random walks through them, and what a model makes of them.

use bssrdf::{Medium, Model, Separation, half_space::exit_moment};
use glam::DVec3;
use rayon::prelude::*;
use test_support::random::Random;

/// Stripes of two media along x, of half a period each, in a half-space that light enters vertically.
pub struct Stripes {
    /// Extinction, 1/m, and albedo of each.
    pub media: [[f64; 2]; 2],
    /// The length of two stripes, m.
    pub period: f64,
    /// Steps of a period at which light is counted.
    pub bins: usize,
}

impl Stripes {
    fn at(&self, x: f64) -> usize {
        usize::from(x.rem_euclid(self.period) >= 0.5 * self.period)
    }

    /// The power that leaves in steps along x, over that which enters: by random walks.
    fn walks(&self) -> Vec<f64> {
        const TASKS: u64 = 64;
        const WALKS: u64 = 20_000;
        let most = self.media[0][0].max(self.media[1][0]);
        let task = |seed: u64| {
            let (mut random, mut left) = (Random(seed), vec![0.0; self.bins]);
            for _ in 0..WALKS {
                let (mut x, mut z, mut weight) = (self.period * random.uniform(), 0.0, 1.0);
                let mut direction = DVec3::Z;
                loop {
                    let step = -(1.0 - random.uniform()).ln() / most;
                    (x, z) = (x + step * direction.x, z + step * direction.z);
                    if z < 0.0 {
                        // Back to the surface.
                        let out = x - direction.x * z / direction.z;
                        let bin = (out.rem_euclid(self.period) / self.period * self.bins as f64) as usize;
                        left[bin.min(self.bins - 1)] += weight;
                        break;
                    }
                    // Woodcock: some collisions change nothing.
                    let [extinction, albedo] = self.media[self.at(x)];
                    if random.uniform() * most >= extinction {
                        continue;
                    }
                    weight *= albedo;
                    if weight < 0.1 {
                        if random.uniform() >= 0.5 {
                            break;
                        }
                        weight *= 2.0;
                    }
                    direction = random.direction();
                }
            }
            left
        };
        let tasks: Vec<Vec<f64>> = (1..=TASKS).into_par_iter().map(task).collect();
        let entered = (TASKS * WALKS) as f64 / self.bins as f64;
        (0..self.bins).map(|k| tasks.iter().map(|left| left[k]).sum::<f64>() / entered).collect()
    }

    /// The same by a symmetric kernel of the media of entry and exit, and of the distance of the lines between which it is
    /// the light, per length.
    pub fn model(&self, kernel: impl Fn(usize, usize, f64) -> f64 + Sync) -> Vec<f64> {
        const FINE: usize = 8;
        let width = self.period / (self.bins * FINE) as f64;
        let count = (2.0 * self.period / width) as i64;
        let table: Vec<[[f64; 2]; 2]> = (0..count as usize)
            .into_par_iter()
            .map(|k| {
                let x = (k as f64 + 0.5) * width;
                std::array::from_fn(|a| std::array::from_fn(|b| kernel(a, b, x)))
            })
            .collect();
        let at = |x: f64| {
            let pair = |(k, value): (usize, &[[f64; 2]; 2])| {
                let d = (k as f64 + 0.5) * width;
                width * (value[self.at(x - d)][self.at(x)] + value[self.at(x + d)][self.at(x)])
            };
            table.iter().enumerate().map(pair).sum::<f64>()
        };
        (0..self.bins).map(|k| at(self.middle(k))).collect()
    }

    /// The middle of a step, m.
    fn middle(&self, bin: usize) -> f64 {
        (bin as f64 + 0.5) / self.bins as f64 * self.period
    }

    /// The largest relative error of a model, more than 1 m from the edges of the stripes.
    pub fn worst(&self, model: &[f64]) -> f64 {
        let error = |(bin, (walks, model)): (usize, (f64, &f64))| {
            let place = self.middle(bin).rem_euclid(0.5 * self.period);
            if place.min(0.5 * self.period - place) > 1.0 { (model / walks - 1.0).abs() } else { 0.0 }
        };
        self.walks().into_iter().zip(model).enumerate().map(error).fold(0.0, f64::max)
    }
}

/// The medium of one extinction, 1/m, and albedo, without boundary.
pub fn medium([extinction, albedo]: [f64; 2]) -> Medium {
    let (a, s) = (extinction * (1.0 - albedo), extinction * albedo);
    let text = format!(r#"{{"name":"m","unit":"1/m","sigma_a":[{a},{a},{a}],"sigma_s":[{s},{s},{s}],"eta":1.0}}"#);
    Medium::from_json(&text).expect("a medium")
}

/// The light between two lines, per length: the integral along y, in rings of equal ratio.
pub fn along(medium: &Medium) -> impl Fn(f64) -> f64 + use<> {
    let model = Model::HalfSpace.of(medium);
    let leaving = exit_moment(0, 1.0);
    move |x: f64| {
        let value = |y: f64| {
            let offset = DVec3::new(x, y, 0.0);
            let (normal_in, normal_out, refracted) = (DVec3::Z, DVec3::Z, DVec3::NEG_Z);
            leaving * model.bare(0, &Separation { offset, normal_in, refracted, normal_out })
        };
        let (step, first) = (1.1f64, 1e-3);
        let ring = |k: i32| {
            let y = first * step.powi(k);
            2.0 * value(y * step.sqrt()) * y * (step - 1.0)
        };
        2.0 * value(0.0) * first + (0..120).map(ring).sum::<f64>()
    }
}

//! Adjoint random walks in a half-space of isotropic scatterers behind a smooth boundary.
//!
//! Lengths are mean free paths. `P(z, ρ)` is the power that leaves per area, at the lateral distance `ρ`, of an
//! isotropic source of power 1 at depth `z`. By reciprocity it is `∫ μ T dω/(4π)` times the fluence at `(z, ρ)` of a
//! source on the boundary whose directions into the medium have the density `μ T(μ)`, and the density of collisions is
//! the fluence. A beam that enters at the cosine `μ12` is a row of isotropic sources: its exitance is
//! `M = α ∫ e^{−s} P(s μ12, ‖r − s ω12‖) ds`, r and ω12 along the surface (docs/method.md 15.9). So one set of walks serves
//! every albedo, by the number of collisions, and every direction, by their depths.

use crate::grid::{ALBEDOS, ANGLES, BINS, albedo, back, bin_of, cosines};
use bssrdf::{DVec3, fresnel};
use rayon::prelude::*;
use scene::random::{Item, Purpose, Stream};
use std::f64::consts::TAU;

/// Walks in one task; tasks are added in order.
const PORTION: u64 = 20_000;

/// A walk ends after so many collisions: at the largest albedo of the grid its weight is then below 10⁻³ of what it was.
const COLLISIONS: u32 = 12_000;

/// After so many collisions, and each time their number has quadrupled, every second walk ends and the others count
/// twice. As many as `1/√n` walks survive n collisions, so that the effort is spread evenly over the powers of two.
const ROULETTE: u32 = 32;

/// Collisions deeper than this hardly see the beam, `e^{−16}`.
const DEEPEST: f64 = 16.0;

/// A number for each albedo of the grid.
pub type Row = [f64; ALBEDOS];

/// What the light of two and more scatterings does, over `α`: the power that leaves in each ring, for each angle of the
/// light; the sum, that times the cosine of the azimuth, and that of the light that goes [`back`].
pub struct Tally(pub Vec<[[Row; 3]; BINS]>);

impl Tally {
    fn new() -> Tally {
        Tally(vec![[[[0.0; ALBEDOS]; 3]; BINS]; ANGLES])
    }

    fn add(&mut self, other: &Tally, scale: f64) {
        let added = other.0.as_flattened().as_flattened().as_flattened();
        let sums = self.0.as_flattened_mut().as_flattened_mut().as_flattened_mut();
        for (sum, more) in sums.iter_mut().zip(added) {
            *sum += more * scale;
        }
    }
}

/// The walks of one index.
pub fn walks(eta: f64, count: u64, seed: u64) -> Tally {
    let stream = Stream::new(seed ^ eta.to_bits(), Purpose::HalfSpaceTable);
    let start = Start::new(eta);
    let portion = |index: u64| simd::dispatch(Portion { start: &start, stream, index });
    let portions = count.div_ceil(PORTION);
    let mut sum = Tally::new();
    // In groups, so that few tallies are held at a time.
    for group in (0..portions).collect::<Vec<_>>().chunks(64) {
        let tallies: Vec<Tally> = group.par_iter().map(|index| portion(*index)).collect();
        for tally in &tallies {
            sum.add(tally, start.strength / (portions * PORTION) as f64);
        }
    }
    sum
}

/// The walks of one task.
struct Portion<'a> {
    start: &'a Start,
    stream: Stream,
    index: u64,
}

impl simd::Kernel for Portion<'_> {
    type Output = Tally;

    #[inline(always)]
    fn run(self) -> Tally {
        let mut tally = Tally::new();
        for walk in self.index * PORTION..(self.index + 1) * PORTION {
            self.start.walk(&mut Random { item: self.stream.item(walk), dimension: 0 }, &mut tally);
        }
        tally
    }
}

/// The numbers of one walk.
struct Random {
    item: Item,
    dimension: u64,
}

impl Random {
    #[inline(always)]
    fn uniform(&mut self) -> f64 {
        self.dimension += 1;
        self.item.uniform(self.dimension)
    }
}

/// How walks of one index start.
struct Start {
    eta: f64,
    /// `∫ μ T dω/(4π)` over the directions inside.
    strength: f64,
    cosines: [f64; ANGLES],
    albedos: Row,
}

impl Start {
    fn new(eta: f64) -> Start {
        // ∫ μ T dω inside is 1/η² of the integral outside, where the cosines run from 0 to 1 without a critical angle.
        Start {
            eta,
            strength: bssrdf::half_space::exit_moment(0, eta) / (4.0 * std::f64::consts::PI * eta * eta),
            cosines: cosines(eta),
            albedos: std::array::from_fn(albedo),
        }
    }

    /// Adds one walk to a tally.
    #[inline(always)]
    fn walk(&self, random: &mut Random, tally: &mut Tally) {
        // A cosine outside with the density μ T by rejection, refracted into the medium.
        let outside = loop {
            let cosine = random.uniform().sqrt();
            if random.uniform() < fresnel::transmittance(cosine, self.eta) {
                break cosine;
            }
        };
        let inside = (1.0 - (1.0 - outside * outside) / (self.eta * self.eta)).max(0.0).sqrt();
        let step = -(1.0 - random.uniform()).ln();
        let (y, x) = (TAU * random.uniform()).sin_cos();
        let across = step * (1.0 - inside * inside).sqrt();
        let mut position = DVec3::new(x * across, y * across, step * inside);
        let mut weights = [1.0; ALBEDOS];
        let mut next_roulette = ROULETTE;
        for collision in 1..COLLISIONS {
            if collision == next_roulette {
                next_roulette *= 4;
                if random.uniform() < 0.5 {
                    return;
                }
                for weight in &mut weights {
                    *weight *= 2.0;
                }
            }
            for i in 0..ALBEDOS {
                weights[i] *= self.albedos[i];
            }
            let cosine = 2.0 * random.uniform() - 1.0;
            let (y, x) = (TAU * random.uniform()).sin_cos();
            let step = -(1.0 - random.uniform()).ln();
            let across = step * (1.0 - cosine * cosine).sqrt();
            position += DVec3::new(x * across, y * across, cosine * step);
            if position.z < 0.0 {
                if random.uniform() < fresnel::transmittance(-cosine, 1.0 / self.eta) {
                    return;
                }
                position.z = -position.z; // the next direction does not depend on this one
            }
            if position.z < DEEPEST {
                self.collide(position, &weights, tally);
            }
        }
    }

    /// Adds a collision to the exitance of each beam.
    #[inline(always)]
    fn collide(&self, position: DVec3, weights: &Row, tally: &mut Tally) {
        for (k, cosine) in self.cosines.iter().enumerate() {
            let along = position.z / cosine;
            if along > DEEPEST {
                continue;
            }
            let strength = (-along).exp() / cosine;
            let x = position.x + along * (1.0 - cosine * cosine).sqrt();
            let r2 = x * x + position.y * position.y;
            if let Some(bin) = bin_of(r2) {
                add(&mut tally.0[k][bin], weights, strength, x / r2.sqrt());
            }
        }
    }
}

#[inline(always)]
fn add(sums: &mut [Row; 3], weights: &Row, strength: f64, azimuth: f64) {
    let second = strength * azimuth;
    let third = strength * back(azimuth);
    for i in 0..ALBEDOS {
        sums[0][i] += strength * weights[i];
        sums[1][i] += second * weights[i];
        sums[2][i] += third * weights[i];
    }
}

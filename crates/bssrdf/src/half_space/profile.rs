//! The half-space model of one channel: the images and their corrections, ready to be evaluated.
//!
//! Lengths are reduced mean free paths, `1/σ_t'`. Corrections are kept at fixed steps of the squared distance, as integers: the
//! reference in float64 and the lanes read the same ones.

use super::{
    GRAZING,
    boundary::critical_cosine,
    images::{Images, forwardness},
    layout::{FIRST, UNIT},
    table::{Corrections, forward_ratio, parabola},
};
use std::f64::consts::PI;

/// Steps of the squared distance for each doubling: as many as the mantissa of a float32 has values of its first bits.
const STEPS_PER_DOUBLING: u32 = 8;
/// The shift that leaves the exponent and those bits.
pub const SHIFT: u32 = 20;
/// The squared distances within which corrections vary: `FIRST²` and `2¹⁴`.
pub const NEAREST2: f32 = (FIRST * FIRST) as f32;
pub const FARTHEST2: f32 = 16384.0;
/// The number that belongs to [`NEAREST2`].
pub const START: u32 = NEAREST2.to_bits() >> SHIFT;
/// Words of a profile, two for each step, rounded up to a power of two, so that a mask keeps indices in bounds.
pub const WORDS: usize = 1024;

/// The constants of one channel.
#[derive(Clone, Debug)]
pub struct Profile {
    pub images: Images,
    /// The terms of each step in pairs of 16 bits: `c₀` above `c₁`, then `c₂` above `p`, in units of [`UNIT`].
    pub words: Box<[u32; WORDS]>,
    /// The coefficients of `m⁰` to `m⁴` that hold at any distance.
    pub constant: [f64; 5],
    /// `m = scale μ12 + shift`.
    pub place: [f64; 2],
}

impl Profile {
    /// The profile for an absorbed share `1 − α'` of each collision.
    pub fn new(absorbed: f64, asymmetry: f64, eta: f64) -> Profile {
        let corrections = Corrections::new(absorbed, eta);
        let [a, b, c] = forward_ratio(absorbed, asymmetry, eta);
        let [d, e] = corrections.high;
        let mut profile = Profile {
            images: Images::new(absorbed, eta),
            words: words(&corrections),
            constant: [a, b, c, d, e],
            place: place(eta),
        };
        profile.restore_power();
        profile
    }

    /// Gives back the power that [`blur`] took, where light does not fall exactly as `1/r`: by a parabola in `m`.
    fn restore_power(&mut self) {
        const PLACES: [f64; 3] = [0.3, 0.65, 1.0];
        let lost = PLACES.map(|m| {
            let [blurred, sharp] = self.powers((m - self.place[1]) / self.place[0]);
            (sharp / blurred).log2()
        });
        for (constant, correction) in self.constant.iter_mut().zip(parabola(&PLACES, &lost)) {
            *constant += correction;
        }
    }

    /// Sums that are proportional to the power that leaves, with and without [`blur`].
    fn powers(&self, cosine: f64) -> [f64; 2] {
        const AZIMUTHS: usize = 12;
        let step = 0.4f64.exp2();
        let sine = (1.0 - cosine * cosine).max(0.0).sqrt();
        let ring = |r: f64| {
            let at = |k: usize| {
                let forward = sine * (PI * (k as f64 + 0.5) / AZIMUTHS as f64).cos();
                r * r * self.exitance(&Place { r2: r * r, along: r * forward, depth: 0.0, cosine, forward })
            };
            (0..AZIMUTHS).map(at).sum::<f64>()
        };
        // Within the first ring light is constant, or rises as 1/r: geometric series.
        let nearest = 8.0 * FIRST;
        let first = ring(nearest);
        let mut powers = [first / (step * step - 1.0), first / blur(nearest * nearest) / (step - 1.0)];
        for k in 0..33 {
            let r = nearest * step.powi(k);
            let power = ring(r);
            powers[0] += power;
            powers[1] += power / blur(r * r);
        }
        powers
    }

    /// The exitance over `α'` (docs/method.md 15.6) of a place on the surface, per unit of power that entered.
    pub fn exitance(&self, place: &Place) -> f64 {
        let m = (self.place[0] * place.cosine + self.place[1]).clamp(0.0, 1.0);
        let forward = forwardness(place.forward.min(GRAZING - 0.01));
        let near = (place.r2 as f32).clamp(NEAREST2, FARTHEST2.next_down());
        let step = (near.to_bits() >> SHIFT) - START;
        let t = f64::from(near.to_bits() & ((1 << SHIFT) - 1)) / f64::from(1u32 << SHIFT);
        let at = |step: u32| {
            let [high, low] = [self.words[2 * step as usize], self.words[2 * step as usize + 1]];
            let [a, b, c, d] =
                [high >> 16, high & 0xFFFF, low >> 16, low & 0xFFFF].map(|word| f64::from(word as u16 as i16));
            a + m * (b + m * c) + d * forward
        };
        let exponent = (at(step) * (1.0 - t) + at(step + 1) * t) * UNIT;
        let exponent = self.constant.iter().rev().fold(0.0, |sum, c| sum * m + c) + exponent;
        self.images.exitance(place.r2, place.along, place.depth, place.cosine) * exponent.exp2()
    }
}

/// `scale` and `shift` of `m = scale μ12 + shift` (docs/method.md 15.5).
pub fn place(eta: f64) -> [f64; 2] {
    let critical = critical_cosine(eta);
    let scale = 1.0 / (1.0 - critical);
    [scale, -critical * scale]
}

/// The terms at the steps of the squared distance.
fn words(corrections: &Corrections) -> Box<[u32; WORDS]> {
    let mut words = Box::new([0; WORDS]);
    let steps = (FARTHEST2.to_bits() >> SHIFT) - START + 1;
    for step in 0..steps as usize {
        let r2 = f64::from(f32::from_bits((START + step as u32) << SHIFT));
        let [first, second, third, power] = corrections.at(0.5 * (r2 / (FIRST * FIRST)).log2());
        let [a, b, c, d] = [first + blur(r2).log2(), second, third, power].map(|term| {
            let bounded = (term / UNIT).round().clamp(f64::from(i16::MIN), f64::from(i16::MAX));
            bounded as i16 as u16
        });
        let pair = |high: u16, low: u16| u32::from(high) << 16 | u32::from(low);
        (words[2 * step], words[2 * step + 1]) = (pair(a, b), pair(c, d));
    }
    words
}

/// The extent of the beam, squared: light of one scattering rises as `1/r` towards where it enters, of which sums over
/// samples have noise and eyes see nothing.
const EXTENT2: f64 = 0.06 * 0.06;

/// `r f` with `f = 1/√(r² + ε²) + ε²/(r² + ε²)^{3/2}`, which is finite and has the integral of `1/r` over a plane
/// (docs/method.md 15.12).
fn blur(r2: f64) -> f64 {
    let softened = r2 + EXTENT2;
    (r2 / softened).sqrt() * (1.0 + EXTENT2 / softened)
}

/// An exitant point as seen from where light enters.
#[derive(Clone, Copy, Debug)]
pub struct Place {
    /// The squared distance.
    pub r2: f64,
    /// `x_t·ω12`, of the part of the offset along the surface.
    pub along: f64,
    /// `|x·n_i|`.
    pub depth: f64,
    /// `μ12`.
    pub cosine: f64,
    /// `w`, the cosine of the angle between `x_t` and `ω12` where the offset lies in the surface.
    pub forward: f64,
}

const _: () = assert!(STEPS_PER_DOUBLING == 1 << (23 - SHIFT));
const _: () = assert!((((FARTHEST2.to_bits() >> SHIFT) - START + 1) * 2) as usize <= WORDS);

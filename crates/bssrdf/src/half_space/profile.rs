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

/// The bits of `c₂`, `q` and `p` in the second word of a step, and the multiples of [`UNIT`] that they count.
const LOW_BITS: [u32; 3] = [11, 9, 12];
pub const LOW_UNITS: [f64; 3] = [16.0, 16.0, 4.0];

/// `c₂`, `q` and `p` of the second word of a step.
#[inline(always)]
pub fn low_terms(word: u32) -> [i32; 3] {
    let [third, square, power] = LOW_BITS;
    [
        word as i32 >> (32 - third),
        (word << third) as i32 >> (32 - square),
        (word << (32 - power)) as i32 >> (32 - power),
    ]
}

/// The constants of one channel.
#[derive(Clone, Debug)]
pub struct Profile {
    pub images: Images,
    /// The terms of each step: `c₀` above `c₁`, of 16 bits each, then `c₂` above `q` above `p` (see [`low_terms`]).
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
            words: words(&corrections, &[0.0; 3]),
            constant: [a, b, c, d, e],
            place: place(eta),
        };
        profile.words = words(&corrections, &profile.gains());
        profile
    }

    /// The gains at [`GAIN_PLACES`] that give back the power which [`blur`] took where light does not fall exactly as
    /// `1/r`.
    fn gains(&self) -> [f64; 3] {
        GAIN_PLACES.map(|m| {
            let [blurred, sharp, near] = self.powers((m - self.place[1]) / self.place[0]);
            (sharp - blurred) / near
        })
    }

    /// Sums that are proportional to the power that leaves: with [`blur`], without it, and with it and [`nearness`].
    fn powers(&self, cosine: f64) -> [f64; 3] {
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
        let inside = first / (step * step - 1.0);
        let mut powers = [inside, first / blur(nearest * nearest) / (step - 1.0), inside];
        for k in 0..33 {
            let r = nearest * step.powi(k);
            let power = ring(r);
            powers[0] += power;
            powers[1] += power / blur(r * r);
            powers[2] += power * nearness(r * r);
        }
        powers
    }

    /// The exitance over `α'` (docs/method.md 15.6) of a place on the surface, per unit of power that entered.
    pub fn exitance(&self, place: &Place) -> f64 {
        let m = (self.place[0] * place.cosine + self.place[1]).clamp(0.0, 1.0);
        let w = place.forward.min(GRAZING - 0.01);
        let forward = forwardness(w);
        let near = (place.r2 as f32).clamp(NEAREST2, FARTHEST2.next_down());
        let step = (near.to_bits() >> SHIFT) - START;
        let t = f64::from(near.to_bits() & ((1 << SHIFT) - 1)) / f64::from(1u32 << SHIFT);
        let at = |step: u32| {
            let [high, low] = [self.words[2 * step as usize], self.words[2 * step as usize + 1]];
            let [first, second] = [high >> 16, high & 0xFFFF].map(|word| f64::from(word as u16 as i16));
            let low = low_terms(low);
            let [third, square, power] = std::array::from_fn(|k| f64::from(low[k]) * LOW_UNITS[k]);
            first + m * (second + m * third) + square * w * w + power * forward
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

/// The terms at the steps of the squared distance, with these gains at [`GAIN_PLACES`] where it is small.
fn words(corrections: &Corrections, gains: &[f64; 3]) -> Box<[u32; WORDS]> {
    let mut words = Box::new([0; WORDS]);
    let steps = (FARTHEST2.to_bits() >> SHIFT) - START + 1;
    for step in 0..steps as usize {
        let r2 = f64::from(f32::from_bits((START + step as u32) << SHIFT));
        let [first, second, third, power, square] = corrections.at(0.5 * (r2 / (FIRST * FIRST)).log2());
        let gained = parabola(&GAIN_PLACES, &gains.map(|gain| (1.0 + gain * nearness(r2)).log2()));
        let (first, second, third) = (first + gained[0], second + gained[1], third + gained[2]);
        let low = [third, square, power];
        let low: [i32; 3] = std::array::from_fn(|k| integer(low[k] / LOW_UNITS[k], LOW_BITS[k]));
        // What c₂ is rounded by goes to the straight line that is closest to it.
        let rounded = third - f64::from(low[0]) * LOW_UNITS[0] * UNIT;
        let high = [first + blur(r2).log2() - rounded / 8.0, second + rounded].map(|term| integer(term, 16));
        words[2 * step] = packed(&high, &[16, 16]);
        words[2 * step + 1] = packed(&low, &LOW_BITS);
    }
    words
}

/// Integers of so many bits in one word, the first on top.
fn packed(terms: &[i32], bits: &[u32]) -> u32 {
    terms.iter().zip(bits).fold(0, |word, (term, bits)| word << bits | *term as u32 & ((1 << bits) - 1))
}

/// The next integer of so many bits, in units of [`UNIT`].
fn integer(term: f64, bits: u32) -> i32 {
    let limit = f64::from(1u32 << (bits - 1));
    (term / UNIT).round().clamp(-limit, limit - 1.0) as i32
}

/// The extent of the beam, squared: light of one scattering rises as `1/r` towards where it enters, of which sums over
/// samples have noise and eyes see nothing.
const EXTENT2: f64 = 0.07 * 0.07;

/// `r f` with `f = 1/√(r² + ε²) + ε²/(r² + ε²)^{3/2}`, which is finite and has the integral of `1/r` over a plane
/// (docs/method.md 15.12).
fn blur(r2: f64) -> f64 {
    let softened = r2 + EXTENT2;
    (r2 / softened).sqrt() * (1.0 + EXTENT2 / softened)
}

/// `m` of the angles at which the power is the same with the extent and without it.
const GAIN_PLACES: [f64; 3] = [0.3, 0.65, 1.0];

/// How much light near the beam makes up for the power that its extent changes: far from it nothing must change.
fn nearness(r2: f64) -> f64 {
    1.0 / (1.0 + 16.0 * r2)
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

const _: () = assert!(LOW_BITS[0] + LOW_BITS[1] + LOW_BITS[2] == 32);
const _: () = assert!(STEPS_PER_DOUBLING == 1 << (23 - SHIFT));
const _: () = assert!((((FARTHEST2.to_bits() >> SHIFT) - START + 1) * 2) as usize <= WORDS);

//! The reflectance of Henyey and Greenstein's phase function over that of isotropic scatterers with the same reduced
//! albedo: similarity is exact only for light that is scattered often.

use crate::reflectance::Exact;
use bssrdf::{
    DVec3, fresnel,
    half_space::{
        critical_cosine,
        layout::forward::{ASYMMETRIES, PLACES, STEPS},
    },
};
use rayon::prelude::*;
use scene::random::{Item, Purpose, Stream};
use std::f64::consts::{PI, TAU};

/// Walks of each angle, and in one task.
const WALKS: u64 = 120_000;
const PORTION: u64 = 2_000;

/// As in [`crate::walks`]: every second walk ends after so many collisions and whenever they have quadrupled.
const ROULETTE: u32 = 32;

/// A walk ends after so many collisions.
const COLLISIONS: u32 = 40_000;

/// From deeper than this no light leaves without a collision, `e^{−40}`.
const DEEPEST: f64 = 40.0;

/// A number for each albedo, of which the first, 1, is left out: the ratio is 1 there.
type Row = [f64; STEPS.len() - 1];

/// `log₂` of the ratios of one index: for each asymmetry, albedo and angle.
pub fn ratios(eta: f64, seed: u64) -> Vec<f64> {
    let critical = critical_cosine(eta);
    let cosines = PLACES.map(|m| critical + m * (1.0 - critical));
    let exact: Vec<[f64; PLACES.len()]> = STEPS[1..]
        .iter()
        .map(|step| {
            let exact = Exact::new(step * step, eta);
            cosines.map(|cosine| exact.leaving(cosine).reflectance)
        })
        .collect();
    let of_asymmetry = |g: &f64| {
        let rows = cosines.map(|cosine| Forward::new(eta, *g, cosine).reflectances(seed));
        let ratio = |step: usize, place: usize| (rows[place][step] / exact[step][place]).log2();
        (0..STEPS.len() - 1)
            .flat_map(|step| (0..PLACES.len()).map(move |place| (step, place)))
            .map(|(s, p)| ratio(s, p))
            .collect::<Vec<f64>>()
    };
    ASYMMETRIES.iter().flat_map(of_asymmetry).collect()
}

/// Walks of one index, asymmetry and angle.
struct Forward {
    eta: f64,
    critical: f64,
    g: f64,
    /// `μ12`.
    cosine: f64,
    albedos: Row,
}

impl Forward {
    fn new(eta: f64, g: f64, cosine: f64) -> Forward {
        let albedo = |k: usize| {
            let reduced = 1.0 - STEPS[k + 1] * STEPS[k + 1];
            reduced / (1.0 - g + g * reduced)
        };
        Forward { eta, critical: critical_cosine(eta), g, cosine, albedos: std::array::from_fn(albedo) }
    }

    /// The reflectances over the reduced albedo.
    fn reflectances(&self, seed: u64) -> Row {
        let stream = Stream::new(seed ^ self.eta.to_bits() ^ self.g.to_bits().rotate_left(17), Purpose::HalfSpaceTable);
        let portion = |index: u64| {
            let mut sums = [0.0; STEPS.len() - 1];
            for walk in index * PORTION..(index + 1) * PORTION {
                self.walk(stream.item(walk), &mut sums);
            }
            sums
        };
        let portions: Vec<Row> = (0..WALKS / PORTION).into_par_iter().map(portion).collect();
        let reduced = |k: usize| 1.0 - STEPS[k + 1] * STEPS[k + 1];
        // α/α', as a walk counts its first collision without α
        let first = |k: usize| 1.0 / (1.0 - self.g + self.g * reduced(k));
        std::array::from_fn(|k| portions.iter().map(|sums| sums[k]).sum::<f64>() * first(k) / WALKS as f64)
    }

    fn walk(&self, item: Item, sums: &mut Row) {
        let mut dimension = 0;
        let mut uniform = || {
            dimension += 1;
            item.uniform(dimension)
        };
        let mut direction = DVec3::new((1.0 - self.cosine * self.cosine).sqrt(), 0.0, self.cosine);
        let mut depth = 0.0;
        let mut weights = [1.0; STEPS.len() - 1];
        let mut next_roulette = ROULETTE;
        for collision in 1..COLLISIONS {
            depth -= (1.0 - uniform()).ln() * direction.z;
            if depth < 0.0 {
                if uniform() < fresnel::transmittance(-direction.z, 1.0 / self.eta) {
                    return;
                }
                (depth, direction.z) = (-depth, -direction.z);
            }
            // Light that leaves after this collision: of light that goes down, in one direction of those that can leave,
            // for few of its own do; of light that goes up, in its next direction, for the phase function has a peak.
            let turns = direction.z > 0.0;
            if turns && depth < DEEPEST {
                let outward = self.critical + (1.0 - self.critical) * uniform();
                let (y, x) = (TAU * uniform()).sin_cos();
                let across = (1.0 - outward * outward).sqrt();
                let cosine = direction.dot(DVec3::new(x * across, y * across, -outward));
                let chance = self.phase(cosine) * TAU * (1.0 - self.critical);
                add(sums, &weights, chance * self.leaves(depth, outward));
            }
            let next = self.scatter(direction, [uniform(), uniform()]);
            if !turns && next.z < 0.0 && depth < DEEPEST {
                add(sums, &weights, self.leaves(depth, -next.z));
            }
            direction = next;
            if collision == next_roulette {
                next_roulette *= 4;
                if uniform() < 0.5 {
                    return;
                }
                weights.iter_mut().for_each(|weight| *weight *= 2.0);
            }
            for k in 0..weights.len() {
                weights[k] *= self.albedos[k];
            }
        }
    }

    /// The share of light from this depth, in a direction of this cosine, that leaves without a collision.
    fn leaves(&self, depth: f64, cosine: f64) -> f64 {
        (-depth / cosine).exp() * fresnel::transmittance(cosine, 1.0 / self.eta)
    }

    /// The phase function, 1/sr.
    fn phase(&self, cosine: f64) -> f64 {
        let g = self.g;
        (1.0 - g * g) / (4.0 * PI * (1.0 + g * g - 2.0 * g * cosine).powf(1.5))
    }

    fn scatter(&self, direction: DVec3, [first, second]: [f64; 2]) -> DVec3 {
        let g = self.g;
        let s = (1.0 - g * g) / (1.0 - g + 2.0 * g * first);
        let cosine = ((1.0 + g * g - s * s) / (2.0 * g)).clamp(-1.0, 1.0);
        let sine = (1.0 - cosine * cosine).sqrt();
        let (b, a) = (TAU * second).sin_cos();
        let (x, y) = direction.any_orthonormal_pair();
        (x * (sine * a) + y * (sine * b) + direction * cosine).normalize()
    }
}

fn add(sums: &mut Row, weights: &Row, strength: f64) {
    for (sum, weight) in sums.iter_mut().zip(weights) {
        *sum += weight * strength;
    }
}

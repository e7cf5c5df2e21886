//! Shares of light that half-spaces and slabs reflect and transmit, by random walks: the exact solution that the models
//! approximate. Lengths are mean free paths.

use bssrdf::{Coefficients, fresnel};
use glam::DVec3;
use rayon::prelude::*;
use scene::random::{Purpose, Stream};
use walks::{End, Sequence, Slab, Start, walk};

/// A medium in units of its mean free path.
#[derive(Clone, Copy, Debug)]
pub struct Matter {
    pub albedo: f64,
    /// Mean cosine of the Henyey-Greenstein phase function.
    pub asymmetry: f64,
    /// Index inside over index outside.
    pub eta: f64,
}

/// A mean with its standard error.
#[derive(Clone, Copy, Debug)]
pub struct Estimate {
    pub mean: f64,
    pub error: f64,
}

/// Shares of the incident light that a slab reflects and transmits; reflection at the first boundary is not counted.
#[derive(Clone, Copy, Debug)]
pub struct Balance {
    pub reflected: Estimate,
    pub transmitted: Estimate,
}

/// Number of walks in one task.
const PORTION: u64 = 10_000;

/// Light of incidence cosine `cosine` on a slab of `thickness` mean free paths, infinite for a half-space. Only
/// scattered light counts.
pub fn slab(matter: &Matter, thickness: f64, cosine: f64, walks: u64, seed: u64) -> Balance {
    let light = DVec3::new((1.0 - cosine * cosine).sqrt(), 0.0, -cosine);
    let none = Estimate { mean: 0.0, error: 0.0 };
    let coefficients =
        Coefficients { sigma_a: 1.0 - matter.albedo, sigma_s: matter.albedo, asymmetry: matter.asymmetry };
    let Some((entry, channel)) =
        fresnel::enter(DVec3::NEG_Z, light, matter.eta).zip(walks::Matter::new(&coefficients, matter.eta))
    else {
        return Balance { reflected: none, transmitted: none };
    };
    let start = Start { position: DVec3::ZERO, direction: entry.direction, face: Some(Slab::FRONT) };
    let stream = Stream::new(seed, Purpose::LightWalk);
    let portion = |index: u64| {
        let mut sums = [[0.0; 2]; 2];
        for k in index * PORTION..(index + 1) * PORTION {
            let mut random = Sequence::new(stream.item(k));
            if let End::Scattered(exit) = walk(&Slab { thickness }, &channel, &start, &mut random, |_, _| ()) {
                let [sum, squares] = &mut sums[exit.face as usize];
                *sum += exit.weight;
                *squares += exit.weight * exit.weight;
            }
        }
        sums
    };
    let portions: Vec<[[f64; 2]; 2]> = (0..walks.div_ceil(PORTION)).into_par_iter().map(portion).collect();
    let walks = (walks.div_ceil(PORTION) * PORTION) as f64;
    let share = |face: u32| {
        let [mean, square] = [0, 1].map(|k| portions.iter().map(|p| p[face as usize][k]).sum::<f64>() / walks);
        let error = ((square - mean * mean) / walks).sqrt();
        Estimate { mean: entry.transmittance * mean, error: entry.transmittance * error }
    };
    Balance { reflected: share(Slab::FRONT), transmitted: share(Slab::BACK) }
}

/// Where light that entered a half-space below z = 0 along `refracted` leaves it scattered: the offset along the surface,
/// and the share of the light; none if it is absorbed.
pub fn exit(matter: &walks::Matter, refracted: DVec3, random: &mut Sequence) -> Option<(DVec3, f64)> {
    let down = DVec3::new(refracted.x, refracted.y, -refracted.z);
    let start = Start { position: DVec3::ZERO, direction: down, face: Some(Slab::FRONT) };
    match walk(&Slab { thickness: f64::INFINITY }, matter, &start, random, |_, _| ()) {
        End::Scattered(exit) => Some((exit.position, exit.weight)),
        _ => None,
    }
}

//! Random walks in a scattering medium behind a smooth boundary, the exact solution that the models approximate.
//!
//! Lengths are mean free paths. All weights are 1: absorption ends a walk, so that every walk ends.

use crate::random::Random;
use bssrdf::fresnel;
use glam::DVec3;
use rayon::prelude::*;
use std::f64::consts::TAU;

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

impl Estimate {
    fn of_share(hits: u64, walks: u64) -> Estimate {
        let mean = hits as f64 / walks as f64;
        Estimate { mean, error: (mean * (1.0 - mean) / walks as f64).sqrt() }
    }
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
    let portion = |index: u64| {
        let mut random = Random(seed.wrapping_mul(0x9E37_79B9).wrapping_add(index << 40));
        let mut ends = [0u64; 2];
        for _ in 0..PORTION {
            match walk(matter, thickness, cosine, &mut random) {
                End::Front => ends[0] += 1,
                End::Back => ends[1] += 1,
                End::Lost => {}
            }
        }
        ends
    };
    let portions: Vec<[u64; 2]> = (0..walks.div_ceil(PORTION)).into_par_iter().map(portion).collect();
    let walks = walks.div_ceil(PORTION) * PORTION;
    let sum = |k: usize| Estimate::of_share(portions.iter().map(|p| p[k]).sum(), walks);
    Balance { reflected: sum(0), transmitted: sum(1) }
}

enum End {
    Front,
    Back,
    Lost,
}

/// One walk; depth and the z of the direction grow downwards.
fn walk(matter: &Matter, thickness: f64, cosine: f64, random: &mut Random) -> End {
    let light = DVec3::new((1.0 - cosine * cosine).sqrt(), 0.0, cosine);
    let Some(entry) = fresnel::enter(DVec3::Z, light, matter.eta) else {
        return End::Lost;
    };
    if random.uniform() >= entry.transmittance {
        return End::Lost;
    }
    let mut direction = DVec3::new(entry.direction.x, entry.direction.y, -entry.direction.z);
    let (mut depth, mut scattered) = (0.0, false);
    loop {
        let step = free_path(random);
        let next = depth + step * direction.z;
        if next < 0.0 || next > thickness {
            // The walk continues at the boundary: free paths have no memory.
            depth = if next < 0.0 { 0.0 } else { thickness };
            if random.uniform() < fresnel::transmittance(direction.z.abs(), 1.0 / matter.eta) {
                return match (scattered, next < 0.0) {
                    (false, _) => End::Lost,
                    (true, true) => End::Front,
                    (true, false) => End::Back,
                };
            }
            direction.z = -direction.z;
            continue;
        }
        depth = next;
        if random.uniform() >= matter.albedo {
            return End::Lost;
        }
        direction = scatter(direction, matter.asymmetry, random);
        scattered = true;
    }
}

/// Where light that entered a half-space along `refracted` leaves it scattered: the offset along the surface; none if
/// it is absorbed. The normal is Z.
pub fn exit(matter: &Matter, refracted: DVec3, random: &mut Random) -> Option<DVec3> {
    let (mut position, mut direction, mut scattered) = (DVec3::ZERO, refracted, false);
    loop {
        position += direction * free_path(random);
        if position.z > 0.0 {
            // The walk continues at the boundary: free paths have no memory.
            position -= direction * (position.z / direction.z);
            if random.uniform() < fresnel::transmittance(direction.z, 1.0 / matter.eta) {
                return scattered.then_some(position);
            }
            direction.z = -direction.z;
            continue;
        }
        if random.uniform() >= matter.albedo {
            return None;
        }
        direction = scatter(direction, matter.asymmetry, random);
        scattered = true;
    }
}

/// Exponential with mean 1.
pub fn free_path(random: &mut Random) -> f64 {
    -(1.0 - random.uniform()).ln()
}

/// A new direction after Henyey and Greenstein 1941.
pub fn scatter(direction: DVec3, g: f64, random: &mut Random) -> DVec3 {
    let xi = random.uniform();
    let cosine = if g.abs() < 1e-6 {
        1.0 - 2.0 * xi
    } else {
        let s = (1.0 - g * g) / (1.0 - g + 2.0 * g * xi);
        ((1.0 + g * g - s * s) / (2.0 * g)).clamp(-1.0, 1.0)
    };
    let sine = (1.0 - cosine * cosine).sqrt();
    let (b, a) = (TAU * random.uniform()).sin_cos();
    let (x, y) = direction.any_orthonormal_pair();
    (x * (sine * a) + y * (sine * b) + direction * cosine).normalize()
}

/// Reflectance of a half-space of isotropic scatterers without a boundary, `1 − H(μ)√(1−ϖ)` (Chandrasekhar 1950),
/// with `H` from its integral equation by iteration. The walk is checked against it.
pub fn chandrasekhar(albedo: f64, cosine: f64) -> f64 {
    const NODES: usize = 400;
    let root = (1.0 - albedo).sqrt();
    let node = |k: usize| (k as f64 + 0.5) / NODES as f64;
    let mut h = vec![1.0; NODES];
    let next = |h: &[f64], mu: f64| {
        let integral: f64 = (0..NODES).map(|k| node(k) * h[k] / (mu + node(k))).sum::<f64>() / NODES as f64;
        1.0 / (root + 0.5 * albedo * integral)
    };
    for _ in 0..2000 {
        h = (0..NODES).map(|k| 0.5 * (h[k] + next(&h, node(k)))).collect();
    }
    1.0 - next(&h, cosine) * root
}

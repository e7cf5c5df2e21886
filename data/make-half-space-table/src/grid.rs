//! What is tabulated: albedos, angles, distances.

use bssrdf::half_space::critical_cosine;

/// `s = √(1 − α)` of the albedos that walks are tallied for.
pub const STEPS: [f64; ALBEDOS] =
    [0.025, 0.05, 0.075, 0.1, 0.15, 0.2, 0.25, 0.3, 0.35, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 0.95];
pub const ALBEDOS: usize = 16;

pub fn albedo(k: usize) -> f64 {
    1.0 - STEPS[k] * STEPS[k]
}

/// Angles of the light.
pub const ANGLES: usize = 5;

/// `m` of the angles: `μ12 = μ_c + m (1 − μ_c)`.
pub const PLACES: [f64; ANGLES] = [0.03, 0.2, 0.5, 0.8, 1.0];

pub fn cosines(eta: f64) -> [f64; ANGLES] {
    let critical = critical_cosine(eta);
    PLACES.map(|m| critical + m * (1.0 - critical))
}

/// Rings: `2^{k/4}` from `FIRST`.
pub const BINS: usize = bssrdf::half_space::layout::RINGS;
use bssrdf::half_space::layout::FIRST;

/// The ring of a squared distance.
pub fn bin_of(r2: f64) -> Option<usize> {
    const HALF_OCTAVE: u64 = std::f64::consts::SQRT_2.to_bits() & ((1 << 52) - 1);
    let bits = (r2 / (FIRST * FIRST)).to_bits();
    let octave = (bits >> 52) as i64 - 1023;
    let place = 2 * octave + i64::from(bits & ((1 << 52) - 1) >= HALF_OCTAVE);
    usize::try_from(place).ok().filter(|place| *place < BINS)
}

/// Inner radius of a ring.
pub fn radius(k: usize) -> f64 {
    FIRST * (k as f64 / 4.0).exp2()
}

/// 1 for light that leaves within 60 degrees of where it came from, by the cosine of its azimuth.
#[inline(always)]
pub fn back(azimuth: f64) -> f64 {
    if azimuth < -0.5 { 1.0 } else { 0.0 }
}

//! The near part of a BSSRDF on a plane: how it falls with the distance, and its integral.

use bssrdf::{Bssrdf, Partition, Separation};
use glam::DVec3;
use rayon::prelude::*;
use std::f64::consts::PI;

/// Rings of equal ratio between the shortest distance and the end of the near part, beside the disc inside them.
const RINGS: usize = 64;

/// The shortest distance, in units of the shortest reduced mean free path: the models are smooth inside it.
const SHORTEST: f64 = 1e-3;

/// Azimuths over half a turn, and the two places of Gauss's rule in a ring, in units of half its width.
const AZIMUTHS: usize = 16;
const GAUSS: f64 = 0.577_350_269_189_625_8;

/// Cosines of the refracted light for which the integrals are tabulated, and the least of them: light that grazes below
/// the surface, in media of an index below 1.03, gives the directional dipole a peak that no table of rings resolves.
const COSINES: usize = 13;
const GRAZING: f64 = 0.25;

/// Distances from the exitant point in the plane, drawn nearly in proportion to the light from there.
pub struct Radii {
    /// The outer radius of each ring, m; that of the disc first.
    ends: Vec<f64>,
    /// The probability of all rings up to each.
    cumulative: Vec<f64>,
}

impl Radii {
    /// The probability of a point per area at a distance, 1/m².
    pub fn density(&self, distance: f64) -> f64 {
        let ring = self.ends.partition_point(|end| *end < distance);
        if ring == self.ends.len() {
            return 0.0;
        }
        let (inner, below) = if ring == 0 { (0.0, 0.0) } else { (self.ends[ring - 1], self.cumulative[ring - 1]) };
        (self.cumulative[ring] - below) / (PI * (self.ends[ring] * self.ends[ring] - inner * inner))
    }

    /// The distance for a uniform number, m.
    pub fn sample(&self, xi: f64) -> f64 {
        let ring = self.cumulative.partition_point(|sum| *sum <= xi).min(self.ends.len() - 1);
        let (inner, below) = if ring == 0 { (0.0, 0.0) } else { (self.ends[ring - 1], self.cumulative[ring - 1]) };
        let share = (xi - below) / (self.cumulative[ring] - below);
        (inner * inner + share * (self.ends[ring] * self.ends[ring] - inner * inner)).sqrt().min(self.ends[ring])
    }
}

/// The integral of the near part over a plane, for any angle of the light.
pub struct PlaneIntegral {
    /// The smallest cosine of refracted light.
    lowest: f64,
    /// For each channel, the integral at cosines of equal steps from the lowest to 1, 1/sr.
    values: [[f64; COSINES]; 3],
}

impl PlaneIntegral {
    /// `∫ (1 − w) S_bare dA` of the channels for light whose cosine below the surface is `cosine`, 1/sr; none for light
    /// that is not tabulated.
    pub fn at(&self, cosine: f64) -> Option<DVec3> {
        // The critical cosine itself may be rounded down.
        if cosine < self.lowest - 1e-6 {
            return None;
        }
        let place = ((cosine - self.lowest) / (1.0 - self.lowest)).clamp(0.0, 1.0) * (COSINES - 1) as f64;
        let first = (place as usize).saturating_sub(1).min(COSINES - 4);
        let t = place - first as f64;
        let weights = cubic(t);
        Some(DVec3::from_array(self.values.each_ref().map(|v| (0..4).map(|k| weights[k] * v[first + k]).sum())))
    }
}

/// Lagrange's weights of the values at 0, 1, 2 and 3 for the place `t`.
fn cubic(t: f64) -> [f64; 4] {
    let [a, b, c, d] = [t, t - 1.0, t - 2.0, t - 3.0];
    [-b * c * d / 6.0, a * c * d / 2.0, -a * b * d / 2.0, a * b * c / 6.0]
}

/// The near part of a model in rings.
pub struct Profile<'a> {
    pub model: &'a dyn Bssrdf,
    pub partition: Partition,
    /// The end of the near part, m.
    pub reach: f64,
    pub eta: f64,
}

impl Profile<'_> {
    /// Distances in proportion to the mean of the channels, and the integrals. `shortest` is the shortest reduced mean
    /// free path, m.
    pub fn tabulate(&self, shortest: f64) -> (Radii, PlaneIntegral) {
        let first = (SHORTEST * shortest).min(0.5 * self.reach);
        let ratio = (self.reach / first).powf(1.0 / RINGS as f64);
        let ends: Vec<f64> = (0..=RINGS).map(|k| first * ratio.powi(k as i32)).collect();
        let lowest = (1.0 - 1.0 / (self.eta * self.eta)).max(GRAZING * GRAZING).sqrt();
        let cosine = |k: usize| lowest + (1.0 - lowest) * k as f64 / (COSINES - 1) as f64;
        let by_cosine: Vec<Vec<DVec3>> = (0..COSINES).into_par_iter().map(|k| self.rings(&ends, cosine(k))).collect();
        let mut values = [[0.0; COSINES]; 3];
        let mut rings = vec![0.0; ends.len()];
        for (k, shares) in by_cosine.iter().enumerate() {
            for channel in 0..3 {
                let sum: f64 = shares.iter().map(|ring| ring[channel]).sum();
                values[channel][k] = sum;
                if sum > 0.0 {
                    rings.iter_mut().zip(shares).for_each(|(all, ring)| *all += ring[channel] / sum);
                }
            }
        }
        let total: f64 = rings.iter().sum();
        let cumulative = rings.iter().scan(0.0, |sum, ring| {
            *sum += ring / total;
            Some(*sum)
        });
        (Radii { cumulative: cumulative.collect(), ends }, PlaneIntegral { lowest, values })
    }

    /// The integral over each ring, 1/sr.
    fn rings(&self, ends: &[f64], cosine: f64) -> Vec<DVec3> {
        let refracted = DVec3::new((1.0 - cosine * cosine).max(0.0).sqrt(), 0.0, -cosine);
        let mean = |distance: f64| {
            let at = |k: usize| self.value(distance, PI * (k as f64 + 0.5) / AZIMUTHS as f64, refracted);
            (0..AZIMUTHS).map(at).sum::<DVec3>() / AZIMUTHS as f64
        };
        let ring = |k: usize| {
            let inner = if k == 0 { 0.0 } else { ends[k - 1] };
            let (middle, half) = (0.5 * (inner + ends[k]), 0.5 * (ends[k] - inner));
            let at = |place: f64| 2.0 * PI * place * half * mean(place);
            at(middle - GAUSS * half) + at(middle + GAUSS * half)
        };
        (0..ends.len()).map(ring).collect()
    }

    fn value(&self, distance: f64, azimuth: f64, refracted: DVec3) -> DVec3 {
        let offset = distance * DVec3::new(azimuth.cos(), azimuth.sin(), 0.0);
        self.near(&Separation { offset, normal_in: DVec3::Z, refracted, normal_out: DVec3::Z })
    }

    /// `(1 − w) S_bare` of the channels, 1/(m² sr).
    pub fn near(&self, s: &Separation) -> DVec3 {
        let share = 1.0 - self.partition.far(s.offset.length_squared());
        DVec3::from_array([0, 1, 2].map(|channel| share * self.model.bare(channel, s)))
    }
}

#[cfg(test)]
mod tests;

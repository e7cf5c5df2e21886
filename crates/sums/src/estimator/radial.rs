//! How fast a BSSRDF varies, by distance: what the cut decides by. Only its efficiency depends on these numbers.

use bssrdf::{Bssrdf, DVec3, Medium, Separation, fresnel};
use std::f64::consts::PI;

/// Bits of a float32 that are dropped to index the tables: sixteen steps for each doubling of the squared distance.
const SHIFT: u32 = 19;
const ENTRIES: usize = 1 << (32 - 1 - SHIFT);

/// Tables over all float32 squared distances, m²; sums over the channels.
#[derive(Clone, Debug)]
pub struct Radial {
    /// Mean of `S_bare`, 1/(m² sr).
    value: Box<[f32; ENTRIES]>,
    /// Mean of `value` over a disc of this squared radius around the point, 1/(m² sr).
    disc: Box<[f32; ENTRIES]>,
    /// Standard deviation over points per root mean square distance from their mean, 1/(m³ sr). Never grows with
    /// distance.
    slope: Box<[f32; ENTRIES]>,
    /// Standard deviation over diffuse directions of light, 1/(m² sr).
    scatter: Box<[f32; ENTRIES]>,
}

/// What the tables say at one distance.
#[derive(Clone, Copy, Debug, Default)]
struct Variation {
    value: f64,
    slope: f64,
    scatter: f64,
}

impl Radial {
    pub fn new(medium: &Medium, model: &dyn Bssrdf) -> Radial {
        let table = || -> Box<[f32; ENTRIES]> { Box::new([0.0; ENTRIES]) };
        let mut radial = Radial { value: table(), disc: table(), slope: table(), scatter: table() };
        let directions = directions(medium.eta);
        let (nearest, farthest) = reach(medium, model);
        let mut slope = 0.0f64;
        let mut last = Variation::default();
        for k in (0..ENTRIES).rev() {
            let distance = f64::from(middle(k)).sqrt();
            if distance > farthest || !distance.is_finite() {
                continue;
            }
            if distance > nearest {
                last = variation(model, distance, &directions);
            }
            slope = slope.max(last.slope);
            (radial.value[k], radial.scatter[k]) = (last.value as f32, last.scatter as f32);
            radial.slope[k] = slope as f32;
        }
        radial.average();
        radial
    }

    /// `∫ S 2πr dr/(πR²)`: the mean over the squared distance.
    fn average(&mut self) {
        let mut sum = 0.0;
        for k in 0..ENTRIES {
            let (from, to) = (f64::from(start(k)), f64::from(start(k + 1)));
            if to.is_finite() && to > 0.0 {
                sum += f64::from(self.value[k]) * (to - from);
                self.disc[k] = (sum / to) as f32;
            }
        }
    }

    #[inline(always)]
    pub fn value(&self, distance_squared: f32) -> f32 {
        self.value[index(distance_squared)]
    }

    #[inline(always)]
    pub fn disc(&self, radius_squared: f32) -> f32 {
        self.disc[index(radius_squared)]
    }

    #[inline(always)]
    pub fn slope(&self, distance_squared: f32) -> f32 {
        self.slope[index(distance_squared)]
    }

    #[inline(always)]
    pub fn scatter(&self, distance_squared: f32) -> f32 {
        self.scatter[index(distance_squared)]
    }
}

#[inline(always)]
fn index(distance_squared: f32) -> usize {
    (distance_squared.to_bits() >> SHIFT) as usize & (ENTRIES - 1)
}

/// The squared distance where a table's step begins.
fn start(index: usize) -> f32 {
    f32::from_bits((index as u32) << SHIFT)
}

/// The squared distance in the middle of a table's step.
fn middle(index: usize) -> f32 {
    f32::from_bits((index as u32) << SHIFT | 1 << (SHIFT - 1))
}

/// The distances, m, that are worth evaluating: from a thousandth of the shortest mean free path to where the channel that
/// reaches farthest is gone.
fn reach(medium: &Medium, model: &dyn Bssrdf) -> (f64, f64) {
    let scattering = medium.channels.iter().filter(|c| c.scatters());
    let shortest = scattering.map(|c| 1.0 / c.reduced_extinction()).fold(f64::INFINITY, f64::min);
    let transport = model.transport().into_iter().filter(|t| *t > 0.0).fold(f64::INFINITY, f64::min);
    let farthest = if transport.is_finite() { 200.0 / transport } else { f64::INFINITY };
    (1e-3 * shortest, farthest.min(1e4 * shortest.max(1.0 / transport)))
}

/// Refracted directions of diffuse light at four angles and eight azimuths, by azimuth.
fn directions(eta: f64) -> [Vec<DVec3>; 8] {
    std::array::from_fn(|azimuth| {
        let (sine, cosine) = (PI / 4.0 * azimuth as f64).sin_cos();
        let light = |k: usize| {
            let squared = (k as f64 + 0.5) / 4.0;
            let across = (1.0 - squared).sqrt();
            DVec3::new(across * cosine, across * sine, squared.sqrt())
        };
        (0..4).filter_map(|k| fresnel::enter(DVec3::Z, light(k), eta)).map(|e| e.direction).collect()
    })
}

/// `S_bare` on a plane, by channel, for all directions in order.
fn on_plane(model: &dyn Bssrdf, channel: usize, distance: f64, directions: &[Vec<DVec3>; 8]) -> Vec<f64> {
    let value = |refracted: &DVec3| {
        let offset = DVec3::new(distance, 0.0, 0.0);
        let separation = Separation { offset, normal_in: DVec3::Z, refracted: *refracted, normal_out: DVec3::Z };
        model.bare(channel, &separation)
    };
    directions.iter().flatten().map(value).collect()
}

fn variation(model: &dyn Bssrdf, distance: f64, directions: &[Vec<DVec3>; 8]) -> Variation {
    const STEP: f64 = 1.05;
    let mut sum = Variation::default();
    for channel in 0..3 {
        let at = |d| on_plane(model, channel, d, directions);
        let (near, here, far) = (at(distance / STEP), at(distance), at(distance * STEP));
        let n = here.len().max(1) as f64;
        let mean = here.iter().sum::<f64>() / n;
        let width = distance * (STEP - 1.0 / STEP);
        let radial = near.iter().zip(&far).map(|(a, b)| ((a - b) / width).powi(2)).sum::<f64>() / n;
        // The next azimuth lies as many directions further on as an azimuth has.
        let turned = here.iter().cycle().skip(here.len() / 8).zip(&here);
        let across = turned.take(here.len()).map(|(a, b)| ((a - b) / (PI / 4.0 * distance)).powi(2)).sum::<f64>() / n;
        sum.value += mean;
        sum.slope += (0.5 * (radial + across)).sqrt();
        sum.scatter += (here.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / n).sqrt();
    }
    sum
}

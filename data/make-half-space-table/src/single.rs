//! Light that is scattered once, by quadrature.

use crate::grid::{ANGLES, BINS, back, cosines, radius};
use bssrdf::fresnel::transmittance;
use std::f64::consts::{PI, TAU};

/// As [`crate::walks::Tally`] for one scattering, over `α`.
pub struct Single {
    /// Power that leaves in each ring, for each angle: the sum, that times the cosine of the azimuth, and that of the light
    /// that goes [`back`].
    pub rings: Vec<[[f64; 3]; BINS]>,
}

const AZIMUTHS: usize = 48;
const DEPTHS: usize = 400;

/// The exitance at a distance and the cosine of an azimuth, `∫ e^{−s} T(μ) μ e^{−d}/(4π d²) ds`.
pub fn exitance(eta: f64, cosine: f64, r: f64, azimuth: f64) -> f64 {
    let sine = (1.0 - cosine * cosine).sqrt();
    // s = r sinh(u): graded around r.
    let top = (40.0 / r).asinh();
    let low = 0.0;
    let step = (top - low) / DEPTHS as f64;
    let at = |k: usize| {
        let u = low + (k as f64 + 0.5) * step;
        let s = r * u.sinh();
        let z = s * cosine;
        let d2 = r * r - 2.0 * r * azimuth * s * sine + s * s;
        let d = d2.sqrt();
        let mu = z / d;
        r * u.cosh() * (-s - d).exp() * transmittance(mu, 1.0 / eta) * mu / (4.0 * PI * d2)
    };
    (0..DEPTHS).map(at).sum::<f64>() * step
}

pub fn rings(eta: f64) -> Single {
    let cosines = cosines(eta);
    let mut rings = vec![[[0.0; 3]; BINS]; ANGLES];
    for (k, cosine) in cosines.iter().enumerate() {
        for (bin, ring) in rings[k].iter_mut().enumerate() {
            // Power in the ring by its middle and ends, M r² being nearly linear in ln r.
            for (r, weight) in [
                (radius(bin), 1.0 / 6.0),
                ((radius(bin) * radius(bin + 1)).sqrt(), 4.0 / 6.0),
                (radius(bin + 1), 1.0 / 6.0),
            ] {
                let width = r * (radius(bin + 1) / radius(bin)).ln();
                for a in 0..AZIMUTHS {
                    let azimuth = (PI * (a as f64 + 0.5) / AZIMUTHS as f64).cos();
                    let power = exitance(eta, *cosine, r, azimuth) * TAU * r * width * weight / AZIMUTHS as f64;
                    ring[0] += power;
                    ring[1] += power * azimuth;
                    ring[2] += power * back(azimuth);
                }
            }
        }
    }
    Single { rings }
}

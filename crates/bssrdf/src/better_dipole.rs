//! The better dipole: d'Eon 2012, with Grosjean's 1956 diffusion coefficient and the Fresnel moments of the boundary.
//! Method.md section 4.

use crate::{Bssrdf, Medium, Separation};
use std::f64::consts::PI;

/// One channel; lengths in m.
#[derive(Clone, Copy, Debug)]
struct Channel {
    transport: f64,
    real_depth: f64,
    virtual_depth: f64,
    /// `C_φ/D`, 1/m.
    fluence: f64,
    /// `C_E`.
    vector: f64,
    /// α'²/(4π) over the exit normalisation `4π C_φ(1/η)`.
    prefactor: f64,
}

/// The better dipole of one medium.
#[derive(Clone, Debug)]
pub struct BetterDipole {
    channels: [Channel; 3],
}

impl BetterDipole {
    pub fn new(medium: &Medium) -> Self {
        let boundary = &medium.interface;
        let channels = medium.channels.map(|c| {
            let diffusion = c.grosjean_diffusion();
            let real_depth = 1.0 / c.reduced_extinction();
            Channel {
                transport: c.grosjean_transport(),
                real_depth,
                virtual_depth: real_depth + 4.0 * boundary.reflection * diffusion,
                fluence: boundary.c_phi / diffusion,
                vector: boundary.c_e,
                prefactor: c.reduced_albedo().powi(2) / (4.0 * PI) / (PI * boundary.exit_norm),
            }
        });
        BetterDipole { channels }
    }
}

impl Bssrdf for BetterDipole {
    /// `R_d(r)/(4π C_φ(1/η))` (method.md 4.3, 4.5).
    fn bare(&self, channel: usize, separation: &Separation) -> f64 {
        let c = &self.channels[channel];
        if c.prefactor == 0.0 {
            return 0.0; // σ_s' = 0: nothing scatters, and a vacuum has no depth
        }
        let r2 = separation.offset.length_squared();
        let source = |depth: f64, sign: f64| {
            let d2 = r2 + depth * depth;
            let d = d2.sqrt();
            let q = c.transport * d;
            (c.vector * depth * (1.0 + q) / d2 + sign * c.fluence) * (-q).exp() / d
        };
        // Rounding can leave a difference of equal terms below zero far away.
        (c.prefactor * (source(c.real_depth, 1.0) + source(c.virtual_depth, -1.0))).max(0.0)
    }

    fn transport(&self) -> [f64; 3] {
        self.channels.map(|c| c.transport)
    }
}

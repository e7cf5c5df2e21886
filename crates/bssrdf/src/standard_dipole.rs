//! The standard dipole: Jensen, Marschner, Levoy and Hanrahan 2001, after Farrell, Patterson and Wilson 1992.
//!
//! Departures from the paper's print: the misplaced 1/σ_t' of its equation is left out (the form here integrates to
//! the paper's total reflectance), and there is no exit normalisation, as published. Method.md section 3.

use crate::{Bssrdf, Medium, Separation};
use std::f64::consts::PI;

/// One channel; lengths in m.
#[derive(Clone, Copy, Debug)]
struct Channel {
    transport: f64,
    real_depth: f64,
    virtual_depth: f64,
    /// α'/(4π²): the albedo, the dipole's 1/(4π), and the 1/π of a Lambertian exit.
    prefactor: f64,
}

/// The standard dipole of one medium.
#[derive(Clone, Debug)]
pub struct StandardDipole {
    channels: [Channel; 3],
}

impl StandardDipole {
    pub fn new(medium: &Medium) -> Self {
        let reflection = medium.interface.reflection_egan;
        let channels = medium.channels.map(|c| {
            let real_depth = 1.0 / c.reduced_extinction();
            Channel {
                transport: c.transport(),
                real_depth,
                virtual_depth: real_depth + 4.0 * reflection * c.diffusion(),
                prefactor: c.reduced_albedo() / (4.0 * PI * PI),
            }
        });
        StandardDipole { channels }
    }
}

/// `z (1 + σ_tr d) e^{−σ_tr d}/d³` with `d = √(r² + z²)`: one source of (3.4), 1/m².
fn source(distance_squared: f64, depth: f64, transport: f64) -> f64 {
    let d = (distance_squared + depth * depth).sqrt();
    let q = transport * d;
    depth * (1.0 + q) * (-q).exp() / (d * d * d)
}

impl Bssrdf for StandardDipole {
    /// `R_d(r)/π` (method.md 3.4, 3.6).
    fn bare(&self, channel: usize, separation: &Separation) -> f64 {
        let c = &self.channels[channel];
        if c.prefactor == 0.0 {
            return 0.0; // σ_s' = 0: nothing scatters, and a vacuum has no depth
        }
        let r2 = separation.offset.length_squared();
        c.prefactor * (source(r2, c.real_depth, c.transport) + source(r2, c.virtual_depth, c.transport))
    }

    fn transport(&self) -> [f64; 3] {
        self.channels.map(|c| c.transport)
    }
}

//! The standard dipole: Jensen, Marschner, Levoy and Hanrahan 2001, after Farrell, Patterson and Wilson 1992.
//!
//! The equations are those of docs/method.md section 3. Departure from the paper's print: the misplaced 1/σ_t' of its
//! equation is left out; the form here integrates to the paper's total reflectance. As published, the model has no exit
//! normalization.

use crate::{
    accuracy::ReflectanceErrors,
    evaluate::{Bssrdf, Separation},
    medium::Medium,
};
use std::f64::consts::PI;

/// Relative error of this model's reflectance, see [`ReflectanceErrors`].
pub const REFLECTANCE_ERRORS: ReflectanceErrors = [
    [0.13, 0.11, 0.12, 0.10, 0.06, 0.02, -0.04, -0.06, -0.08, -0.08, -0.07],
    [0.60, 0.50, 0.50, 0.46, 0.34, 0.24, 0.09, -0.01, -0.08, -0.10, -0.10],
];

/// The constants of one channel (docs/method.md 3.2).
#[derive(Clone, Copy, Debug)]
struct Channel {
    /// `σ_tr`, 1/m.
    transport: f64,
    /// `z_r` and `z_v`, m.
    real_depth: f64,
    virtual_depth: f64,
    /// `α'/(4π²)`: that of (3.4), and the `1/π` of (3.6).
    prefactor: f64,
}

/// The standard dipole of one medium, channel by channel.
#[derive(Clone, Debug)]
pub struct StandardDipole([Channel; 3]);

impl StandardDipole {
    pub fn new(medium: &Medium) -> Self {
        let reflection = medium.interface.reflection_egan;
        StandardDipole(medium.channels.map(|c| {
            let real_depth = 1.0 / c.reduced_extinction();
            Channel {
                transport: c.transport(),
                real_depth,
                virtual_depth: real_depth + 4.0 * reflection * c.diffusion(),
                prefactor: c.reduced_albedo() / (4.0 * PI * PI),
            }
        }))
    }
}

/// One source: `z (1 + σ_tr d) e^{−σ_tr d}/d³` with `d = √(r² + z²)` (docs/method.md 3.3, 3.4), 1/m².
fn source(distance_squared: f64, depth: f64, transport: f64) -> f64 {
    let d = (distance_squared + depth * depth).sqrt();
    let q = transport * d;
    depth * (1.0 + q) * (-q).exp() / (d * d * d)
}

impl Bssrdf for StandardDipole {
    /// `R_d(r)/π` (docs/method.md 3.4, 3.6).
    fn bare(&self, channel: usize, separation: &Separation) -> f64 {
        let c = &self.0[channel];
        if c.prefactor == 0.0 {
            return 0.0; // σ_s' = 0: nothing scatters, and a vacuum has no depth
        }
        let r2 = separation.offset.length_squared();
        c.prefactor * (source(r2, c.real_depth, c.transport) + source(r2, c.virtual_depth, c.transport))
    }

    fn transport(&self) -> [f64; 3] {
        self.0.map(|c| c.transport)
    }
}

//! The better dipole: d'Eon 2012, with Grosjean's 1956 diffusion coefficient and the Fresnel moments of the boundary.
//! The equations are those of docs/method.md section 4.

use crate::{
    accuracy::ReflectanceErrors,
    evaluate::{Bssrdf, Separation},
    medium::Medium,
};
use std::f64::consts::PI;

/// Relative error of this model's reflectance, see [`ReflectanceErrors`].
pub const REFLECTANCE_ERRORS: ReflectanceErrors = [
    [-1.00, -0.90, -0.72, -0.54, -0.37, -0.27, -0.17, -0.09, -0.04, -0.02, -0.00],
    [-1.00, -0.89, -0.70, -0.53, -0.37, -0.29, -0.18, -0.12, -0.06, -0.03, -0.00],
];

/// The constants of one channel (docs/method.md 4.1, 4.2).
#[derive(Clone, Copy, Debug)]
struct Channel {
    /// `σ_tr`, 1/m.
    transport: f64,
    /// `z_r` and `z_v`, m.
    real_depth: f64,
    virtual_depth: f64,
    /// `C_φ/D`, 1/m.
    fluence: f64,
    /// `C_E`.
    vector: f64,
    /// `α'²/(4π)` of (4.3) over `4π C_φ(1/η)` of (4.5).
    prefactor: f64,
}

/// The better dipole of one medium, channel by channel.
#[derive(Clone, Debug)]
pub struct BetterDipole([Channel; 3]);

impl BetterDipole {
    pub fn new(medium: &Medium) -> Self {
        let boundary = &medium.interface;
        BetterDipole(medium.channels.map(|c| {
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
        }))
    }
}

impl Bssrdf for BetterDipole {
    /// `R_d(r)/(4π C_φ(1/η))` (docs/method.md 4.3, 4.5).
    fn bare(&self, channel: usize, separation: &Separation) -> f64 {
        let c = &self.0[channel];
        if c.prefactor == 0.0 {
            return 0.0; // σ_s' = 0: nothing scatters, and a vacuum has no depth
        }
        let r2 = separation.offset.length_squared();
        // One line of (4.3).
        let source = |depth: f64, sign: f64| {
            let d2 = r2 + depth * depth;
            let d = d2.sqrt();
            let q = c.transport * d;
            (c.vector * depth * (1.0 + q) / d2 + sign * c.fluence) * (-q).exp() / d
        };
        // Far away the terms cancel, and rounding can leave a value below zero.
        (c.prefactor * (source(c.real_depth, 1.0) + source(c.virtual_depth, -1.0))).max(0.0)
    }

    fn transport(&self) -> [f64; 3] {
        self.0.map(|c| c.transport)
    }
}

//! The directional dipole: Frisvad, Hachisuka and Kjeldsen 2014.
//!
//! Departures from the paper's print: the mirrored source vector is written out (docs/method.md 5.8), and a cross
//! product replaces a difference of squares, which rounding makes negative. `S = 0` where nothing scatters, although
//! the published formula does not tend to zero there (docs/method.md section 8). The model is not reciprocal.

use crate::{
    accuracy::ReflectanceErrors,
    evaluate::{Bssrdf, Separation},
    medium::Medium,
};
use glam::DVec3;
use std::f64::consts::PI;

/// Relative error of this model's reflectance, see [`ReflectanceErrors`].
pub const REFLECTANCE_ERRORS: ReflectanceErrors = [
    [91.67, 17.46, 5.12, 2.54, 1.36, 0.97, 0.63, 0.48, 0.37, 0.33, 0.27],
    [101.50, 18.68, 5.44, 2.68, 1.38, 0.94, 0.57, 0.40, 0.30, 0.26, 0.22],
];

/// Below this length rounding has taken the direction of a projected unit vector (docs/method.md 5.6).
const NULL_DIRECTION: f64 = 1e-12;

/// Below this distance, m, `1/d³` leaves the range of float64.
const NULL_DISTANCE: f64 = 1e-100;

/// The constants of one channel (docs/method.md 5.1).
#[derive(Clone, Copy, Debug)]
struct Channel {
    /// `σ_tr`, 1/m.
    transport: f64,
    /// `D`, m.
    diffusion: f64,
    /// `d_e`, m.
    extrapolation: f64,
    /// `h = 2 A_C d_e`: the distance of the virtual source from the entry point, m.
    mirror: f64,
    /// `z² = 1/(3σ_t)²` of a source that is lit from behind (5.3), m².
    back_lit_depth2: f64,
    scatters: bool,
}

/// The directional dipole of one medium.
#[derive(Clone, Debug)]
pub struct DirectionalDipole {
    channels: [Channel; 3],
    c_phi: f64,
    c_e: f64,
    /// `1/(4π² · 4C_φ(1/η))` (5.10).
    prefactor: f64,
}

/// A source, seen from the exitant point (docs/method.md 5.8).
struct Source {
    /// `X = x·ω`, m.
    x: f64,
    /// `W = ω·n_o`.
    w: f64,
    /// `N = x·n_o`, m.
    n: f64,
    /// `d`, m.
    distance: f64,
}

impl DirectionalDipole {
    pub fn new(medium: &Medium) -> Self {
        let boundary = &medium.interface;
        let channels = medium.channels.map(|c| {
            let diffusion = c.diffusion();
            let extrapolation = 2.131 * diffusion / c.reduced_albedo().sqrt();
            Channel {
                transport: c.transport(),
                diffusion,
                extrapolation,
                mirror: 2.0 * boundary.reflection * extrapolation,
                back_lit_depth2: (3.0 * c.extinction()).powi(-2),
                scatters: c.scatters(),
            }
        });
        let prefactor = 1.0 / (4.0 * PI * PI * boundary.exit_norm);
        DirectionalDipole { channels, c_phi: boundary.c_phi, c_e: boundary.c_e, prefactor }
    }

    /// `K(X, W, N, d)` (docs/method.md 5.9).
    fn kernel(&self, c: &Channel, s: &Source) -> f64 {
        let d2 = s.distance * s.distance;
        let q = c.transport * s.distance; // σ_tr d
        let one_q = 1.0 + q;
        let three_d = 3.0 * c.diffusion; // 3D
        let fluence = d2 / c.diffusion + 3.0 * one_q * s.x; // the bracket of C_φ
        let gradient = (one_q + three_d * (3.0 * one_q + q * q) / d2 * s.x) * s.n;
        let vector = three_d * one_q * s.w - gradient; // the bracket of C_E
        (-q).exp() / (d2 * s.distance) * (self.c_phi * fluence - self.c_e * vector)
    }
}

/// `n*`: the normal of the plane that mirrors the source (docs/method.md 5.5, 5.6); zero if nothing defines it.
fn mirror_normal(s: &Separation, distance: f64) -> DVec3 {
    if distance == 0.0 {
        return s.normal_in;
    }
    let x = s.offset / distance;
    let across = |v: DVec3| x.cross(v.cross(x));
    for candidate in [across(s.normal_in), -across(s.refracted), across(s.normal_out)] {
        let length = candidate.length();
        if length > NULL_DIRECTION {
            return candidate / length;
        }
    }
    DVec3::ZERO
}

impl Bssrdf for DirectionalDipole {
    /// `max(0, K_real − K_virtual)/(4π² · 4C_φ(1/η))` (docs/method.md 5.10).
    fn bare(&self, channel: usize, s: &Separation) -> f64 {
        let c = &self.channels[channel];
        if !c.scatters {
            return 0.0;
        }
        let r2 = s.offset.length_squared();
        let mu0 = -s.normal_out.dot(s.refracted); // μ₀ (5.2)
        // z² (5.3)
        let depth_squared = if mu0 > 0.0 {
            let across = s.offset.cross(s.refracted).length();
            let beta = across / (r2 + c.extrapolation * c.extrapolation).sqrt(); // β̂ (5.2)
            let d_mu0 = c.diffusion * mu0;
            d_mu0 * (d_mu0 + 2.0 * c.extrapolation * beta)
        } else {
            c.back_lit_depth2
        };
        let distance = (r2 + depth_squared).sqrt(); // d_r (5.4)
        if distance < NULL_DISTANCE {
            return 0.0; // μ₀ → 0 at r = 0: the limit depends on the path (docs/method.md section 8)
        }
        let normal = mirror_normal(s, r2.sqrt());
        let (a, b) = (normal.dot(s.refracted), normal.dot(s.normal_out)); // (5.7)
        let (x, n) = (s.offset.dot(s.refracted), s.offset.dot(s.normal_out));
        let real = Source { x, w: -mu0, n, distance };
        let virtual_source = Source {
            x: x + c.mirror * a,
            w: -mu0 - 2.0 * a * b,
            n: n - c.mirror * b,
            distance: (r2 + c.mirror * c.mirror).sqrt(), // d_v (5.4)
        };
        let difference = self.kernel(c, &real) - self.kernel(c, &virtual_source);
        debug_assert!(difference.is_finite(), "{s:?}");
        difference.max(0.0) * self.prefactor
    }

    fn transport(&self) -> [f64; 3] {
        self.channels.map(|c| c.transport)
    }
}

//! The directional dipole: Frisvad, Hachisuka and Kjeldsen 2014.
//!
//! Written without its mirrored source vector (method.md 5.8) and with a cross product where the paper takes the
//! difference of squares: that difference goes negative in rounding. `S = 0` where nothing scatters, although the
//! published formula does not tend to zero there (method.md section 8). The model is not reciprocal.

use crate::{Bssrdf, Medium, Separation};
use glam::DVec3;
use std::f64::consts::PI;

/// Below this length a projected unit vector has no direction left (method.md 5.6).
const NULL_DIRECTION: f64 = 1e-12;

/// Below this distance, m, 1/d³ leaves the range of numbers.
const NULL_DISTANCE: f64 = 1e-100;

/// One channel; lengths in m.
#[derive(Clone, Copy, Debug)]
struct Channel {
    transport: f64,
    /// `D`, m.
    diffusion: f64,
    /// `d_e`, m.
    extrapolation: f64,
    /// `h = 2 A_C d_e`: how far the virtual source is mirrored, m.
    mirror: f64,
    /// `1/(3σ_t)²`: squared depth of the real source when lit from behind, m².
    back_lit: f64,
    scatters: bool,
}

/// The directional dipole of one medium.
#[derive(Clone, Debug)]
pub struct DirectionalDipole {
    channels: [Channel; 3],
    c_phi: f64,
    c_e: f64,
    /// `1/(4π² · 4C_φ(1/η))`.
    prefactor: f64,
}

/// Projections of one source (method.md 5.8).
struct Source {
    x: f64,
    w: f64,
    n: f64,
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
                back_lit: (3.0 * c.extinction()).powi(-2),
                scatters: c.scatters(),
            }
        });
        let prefactor = 1.0 / (4.0 * PI * PI * boundary.exit_norm);
        DirectionalDipole { channels, c_phi: boundary.c_phi, c_e: boundary.c_e, prefactor }
    }

    /// `K(X, W, N, d)` (method.md 5.9).
    fn kernel(&self, c: &Channel, s: &Source) -> f64 {
        let d2 = s.distance * s.distance;
        let q = c.transport * s.distance;
        let one_q = 1.0 + q;
        let three_d = 3.0 * c.diffusion;
        let fluence = d2 / c.diffusion + 3.0 * one_q * s.x;
        let gradient = (one_q + three_d * (3.0 * one_q + q * q) / d2 * s.x) * s.n;
        let vector = three_d * one_q * s.w - gradient;
        (-q).exp() / (d2 * s.distance) * (self.c_phi * fluence - self.c_e * vector)
    }
}

/// `n*`: the surface normal seen from the line between the points (method.md 5.5, 5.6); zero if nothing defines it.
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
    /// `max(0, K_real − K_virtual)/(4π² · 4C_φ(1/η))` (method.md 5.10).
    fn bare(&self, channel: usize, s: &Separation) -> f64 {
        let c = &self.channels[channel];
        if !c.scatters {
            return 0.0;
        }
        let r2 = s.offset.length_squared();
        let mu0 = -s.normal_out.dot(s.refracted);
        let depth_squared = if mu0 > 0.0 {
            let across = s.offset.cross(s.refracted).length();
            let beta = across / (r2 + c.extrapolation * c.extrapolation).sqrt();
            let d_mu = c.diffusion * mu0;
            d_mu * (d_mu + 2.0 * c.extrapolation * beta)
        } else {
            c.back_lit
        };
        let distance = (r2 + depth_squared).sqrt();
        if distance < NULL_DISTANCE {
            return 0.0; // μ0 → 0 at r = 0: the limit depends on the path, method.md section 8
        }
        let normal = mirror_normal(s, r2.sqrt());
        let (a, b) = (normal.dot(s.refracted), normal.dot(s.normal_out));
        let (x, n) = (s.offset.dot(s.refracted), s.offset.dot(s.normal_out));
        let real = Source { x, w: -mu0, n, distance };
        let virtual_source = Source {
            x: x + c.mirror * a,
            w: -mu0 - 2.0 * a * b,
            n: n - c.mirror * b,
            distance: (r2 + c.mirror * c.mirror).sqrt(),
        };
        let difference = self.kernel(c, &real) - self.kernel(c, &virtual_source);
        debug_assert!(difference.is_finite(), "{s:?}");
        difference.max(0.0) * self.prefactor
    }

    fn transport(&self) -> [f64; 3] {
        self.channels.map(|c| c.transport)
    }
}

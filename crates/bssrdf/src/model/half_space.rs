//! The half-space model: right on a half-space of any reduced albedo, index and angle of the light.
//!
//! Two sources of diffuse light, one below the surface and its image above it, times a tabulated ratio to random walks
//! (docs/method.md section 15). Ours. The shape of light that is scattered along its direction is that by similarity, with
//! the reduced coefficients; its power is that of Henyey and Greenstein's phase function.

use crate::{
    evaluate::{Bssrdf, Separation},
    half_space::{
        exit_moment,
        layout::FIRST,
        profile::{Place, Profile},
        table::lobe_slope,
    },
    medium::{Coefficients, Medium},
};

/// The constants of one channel.
#[derive(Clone, Debug)]
struct Channel {
    /// `σ_t'`, 1/m.
    reduced: f64,
    profile: Profile,
    /// `α' σ_t'²/m_0`, 1/(m² sr).
    prefactor: f64,
}

/// The half-space model of one medium; a channel that does not scatter is none.
#[derive(Clone, Debug)]
pub struct HalfSpace {
    channels: [Option<Channel>; 3],
    /// The squared distance within which the direction of an offset loses its meaning, m².
    blur2: f64,
}

/// `1 − α'` without cancellation.
pub(super) fn absorbed(c: &Coefficients) -> f64 {
    c.sigma_a / c.reduced_extinction()
}

/// [`FIRST`] of the channel with the shortest mean free path, m²; the same for all channels, so that they share `w`.
pub(super) fn blur2(medium: &Medium) -> f64 {
    let shortest = medium.channels.iter().filter(|c| c.scatters()).map(|c| 1.0 / c.reduced_extinction());
    (FIRST * shortest.fold(f64::INFINITY, f64::min)).powi(2)
}

impl HalfSpace {
    pub fn new(medium: &Medium) -> Self {
        let norm = exit_moment(0, medium.eta);
        let channel = |c: &Coefficients| {
            let reduced = c.reduced_extinction();
            let profile = Profile::new(absorbed(c), c.asymmetry, medium.eta);
            Channel { reduced, profile, prefactor: c.reduced_albedo() * reduced * reduced / norm }
        };
        let channels = [0, 1, 2].map(|k| Some(&medium.channels[k]).filter(|c| c.scatters()).map(channel));
        HalfSpace { channels, blur2: blur2(medium) }
    }
}

/// `a` and `b` of the light that leaves in proportion to `T21 (a + b μ)` (docs/method.md 15.8), for each channel.
pub fn exit_lobe(medium: &Medium) -> [[f64; 2]; 3] {
    let mean = exit_moment(1, medium.eta) / exit_moment(0, medium.eta);
    [0, 1, 2].map(|k| {
        let c = &medium.channels[k];
        if !c.scatters() {
            return [1.0, 0.0];
        }
        let slope = lobe_slope(absorbed(c), medium.eta);
        [1.0 - slope * mean, slope]
    })
}

impl Bssrdf for HalfSpace {
    /// (docs/method.md 15.7)
    fn bare(&self, channel: usize, s: &Separation) -> f64 {
        let Some(c) = &self.channels[channel] else {
            return 0.0;
        };
        let normal = s.offset.dot(s.normal_in);
        let cosine = -s.normal_in.dot(s.refracted);
        let along = s.offset.dot(s.refracted) + normal * cosine;
        let r2 = s.offset.length_squared();
        let place = Place {
            r2: r2 * c.reduced * c.reduced,
            along: along * c.reduced,
            depth: normal.abs() * c.reduced,
            cosine,
            forward: along / (r2 + self.blur2).sqrt(),
        };
        c.prefactor * c.profile.exitance(&place)
    }

    fn transport(&self) -> [f64; 3] {
        [0, 1, 2].map(|k| self.channels[k].as_ref().map_or(0.0, |c| c.profile.images.transport * c.reduced))
    }
}

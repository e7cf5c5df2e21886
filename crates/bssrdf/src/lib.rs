//! How a translucent medium scatters: coefficients, the Fresnel interface, and three BSSRDF models.
//!
//! No I/O and no random numbers. Lengths are metres, coefficients 1/m, `S` is in 1/(m² sr).
//!
//! Three values of the BSSRDF are kept apart everywhere (method.md 1.1 to 1.3):
//!
//! ```text
//! S        = T12 · T21 · S_bare      the full BSSRDF
//! S_gather = T12 · S_bare            what the gather sums after the roulette on R = 1 − T21
//! ```
//!
//! *Fresnel is said once, here:* the light's way in is `T12`, stored with each sample's flux; the way out is consumed
//! by the choice between reflection and refraction at the exitant point, so the sum over samples uses `S_gather`.

mod accuracy;
mod albedo;
mod better_dipole;
mod directional_dipole;
mod error;
pub mod fresnel;
pub mod lanes;
mod media;
mod medium;
mod medium_file;
mod standard_dipole;

pub use accuracy::GOOD;
pub use albedo::single_scattering_albedo;
pub use better_dipole::BetterDipole;
pub use directional_dipole::DirectionalDipole;
pub use error::MediumError;
pub use glam::DVec3;
pub use media::{built_in, built_in_names};
pub use medium::{Coefficients, ETA_MAX, ETA_MIN, Interface, Medium};
pub use medium_file::{MediumFile, Optics, Unit};
pub use simd;
pub use standard_dipole::StandardDipole;

use lanes::{BetterLanes, DirectionalLanes, LaneModel, StandardLanes};

/// Where light enters: position (m), outward unit normal, unit direction towards the light.
#[derive(Clone, Copy, Debug)]
pub struct Incident {
    pub position: DVec3,
    pub normal: DVec3,
    pub direction: DVec3,
}

/// Where light leaves: position (m), outward unit normal, unit direction towards the viewer.
#[derive(Clone, Copy, Debug)]
pub struct Exitant {
    pub position: DVec3,
    pub normal: DVec3,
    pub direction: DVec3,
}

/// What `S_bare` depends on, once the interface has been dealt with.
#[derive(Clone, Copy, Debug)]
pub struct Separation {
    /// `x = x_o − x_i`, m.
    pub offset: DVec3,
    /// `n_i`, outward unit normal where light enters.
    pub normal_in: DVec3,
    /// `ω12`, unit direction of the refracted light, into the medium.
    pub refracted: DVec3,
    /// `n_o`, outward unit normal where light leaves.
    pub normal_out: DVec3,
}

/// A BSSRDF of one medium, in float64: the reference that faster evaluations are tested against.
pub trait Bssrdf: Sync {
    /// `S_bare` of one color channel, 1/(m² sr): finite and never negative.
    fn bare(&self, channel: usize, separation: &Separation) -> f64;

    /// `σ_tr` of the three channels as this model defines it, 1/m: what the roulette's rules are made of.
    fn transport(&self) -> [f64; 3];
}

/// The models by name.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Model {
    /// Frisvad, Hachisuka, Kjeldsen 2014.
    DirectionalDipole,
    /// d'Eon 2012.
    BetterDipole,
    /// Jensen, Marschner, Levoy, Hanrahan 2001.
    StandardDipole,
}

impl Model {
    pub const ALL: [Model; 3] = [Model::DirectionalDipole, Model::BetterDipole, Model::StandardDipole];

    /// The name users type.
    pub fn name(self) -> &'static str {
        match self {
            Model::DirectionalDipole => "directional-dipole",
            Model::BetterDipole => "better-dipole",
            Model::StandardDipole => "standard-dipole",
        }
    }

    /// The model of one medium, as a float64 evaluator.
    pub fn of(self, medium: &Medium) -> Box<dyn Bssrdf> {
        match self {
            Model::DirectionalDipole => Box::new(DirectionalDipole::new(medium)),
            Model::BetterDipole => Box::new(BetterDipole::new(medium)),
            Model::StandardDipole => Box::new(StandardDipole::new(medium)),
        }
    }

    /// The model of one medium, as an evaluator of sixteen samples at a time in float32.
    pub fn lanes(self, medium: &Medium) -> AnyLanes {
        match self {
            Model::DirectionalDipole => AnyLanes::Directional(DirectionalLanes::new(medium)),
            Model::BetterDipole => AnyLanes::Better(BetterLanes::new(medium)),
            Model::StandardDipole => AnyLanes::Standard(StandardLanes::new(medium)),
        }
    }

    /// `σ̃_t` of the unscattered light that `L_t` follows through the medium, 1/m (method.md 5.11): the delta-Eddington
    /// extinction goes with the directional dipole, which counts forward scattered light as unscattered.
    pub fn unscattered_extinction(self, medium: &Medium) -> [f64; 3] {
        medium.channels.map(|c| match self {
            Model::DirectionalDipole => c.sigma_a + (1.0 - c.asymmetry * c.asymmetry) * c.sigma_s,
            Model::BetterDipole | Model::StandardDipole => c.extinction(),
        })
    }
}

/// A model in float32 that is chosen when the program runs.
#[derive(Clone, Debug)]
pub enum AnyLanes {
    Directional(DirectionalLanes),
    Better(BetterLanes),
    Standard(StandardLanes),
}

/// Work that is compiled once for each model, so that the model's evaluation is inlined into its loops.
pub trait LaneWork {
    type Output;

    fn run<M: LaneModel>(self, model: &M) -> Self::Output;
}

impl AnyLanes {
    /// Does the work with this model.
    pub fn run<W: LaneWork>(&self, work: W) -> W::Output {
        match self {
            AnyLanes::Directional(model) => work.run(model),
            AnyLanes::Better(model) => work.run(model),
            AnyLanes::Standard(model) => work.run(model),
        }
    }
}

/// The values of the BSSRDF at one pair of points, one channel (method.md 1.1, 1.2).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Values {
    /// Entry and exit transmittance included, 1/(m² sr).
    pub full: f64,
    /// Entry transmittance included, 1/(m² sr).
    pub gather: f64,
    /// Neither, 1/(m² sr).
    pub bare: f64,
}

impl Values {
    const ZERO: Values = Values { full: 0.0, gather: 0.0, bare: 0.0 };
}

/// `S`, `S_gather` and `S_bare` of one channel; all zero where no light can enter (method.md 1.3).
pub fn evaluate(model: &dyn Bssrdf, eta: f64, channel: usize, incident: &Incident, exitant: &Exitant) -> Values {
    let Some(entry) = fresnel::enter(incident.normal, incident.direction, eta) else {
        return Values::ZERO;
    };
    let separation = Separation {
        offset: exitant.position - incident.position,
        normal_in: incident.normal,
        refracted: entry.direction,
        normal_out: exitant.normal,
    };
    let bare = model.bare(channel, &separation);
    let gather = entry.transmittance * bare;
    let exit = fresnel::transmittance(exitant.normal.dot(exitant.direction), eta);
    Values { full: exit * gather, gather, bare }
}

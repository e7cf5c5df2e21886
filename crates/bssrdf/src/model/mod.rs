//! The models: their names, and everything that is chosen by one.

mod better_dipole;
mod better_lanes;
mod directional_dipole;
mod directional_lanes;
mod half_space;
mod half_space_lanes;
mod reflectance;
mod standard_dipole;
mod standard_lanes;

pub use better_dipole::BetterDipole;
pub use better_lanes::BetterLanes;
pub use directional_dipole::DirectionalDipole;
pub use directional_lanes::DirectionalLanes;
pub use half_space::HalfSpace;
pub use half_space_lanes::HalfSpaceLanes;
pub use standard_dipole::StandardDipole;
pub use standard_lanes::StandardLanes;

use crate::{
    accuracy::{GOOD, interpolated},
    evaluate::Bssrdf,
    lanes::block::{Block, Lane, LaneModel},
    medium::{Coefficients, Medium},
    partition::{Far, Partition},
    rough_interface::{RoughEntry, RoughInterface},
};

/// A model of the BSSRDF.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Model {
    /// Ours: exact on a half-space, from random walks.
    HalfSpace,
    /// Frisvad, Hachisuka, Kjeldsen 2014.
    DirectionalDipole,
    /// d'Eon 2012.
    BetterDipole,
    /// Jensen, Marschner, Levoy, Hanrahan 2001.
    StandardDipole,
}

impl Model {
    /// All models, the default first.
    pub const ALL: [Model; 4] =
        [Model::HalfSpace, Model::DirectionalDipole, Model::BetterDipole, Model::StandardDipole];

    /// The name that users type.
    pub fn name(self) -> &'static str {
        match self {
            Model::DirectionalDipole => "directional-dipole",
            Model::HalfSpace => "half-space",
            Model::BetterDipole => "better-dipole",
            Model::StandardDipole => "standard-dipole",
        }
    }

    /// The model of one medium, as a float64 evaluator.
    pub fn of(self, medium: &Medium) -> Box<dyn Bssrdf> {
        match self {
            Model::DirectionalDipole => Box::new(DirectionalDipole::new(medium)),
            Model::HalfSpace => Box::new(HalfSpace::new(medium)),
            Model::BetterDipole => Box::new(BetterDipole::new(medium)),
            Model::StandardDipole => Box::new(StandardDipole::new(medium)),
        }
    }

    /// The model of one medium, as an evaluator of sixteen samples at a time in float32.
    pub fn lanes(self, medium: &Medium) -> AnyLanes {
        match self {
            Model::DirectionalDipole => AnyLanes::Directional(Far::new(medium)),
            Model::HalfSpace => AnyLanes::HalfSpace(Far::new(medium)),
            Model::BetterDipole => AnyLanes::Better(Far::new(medium)),
            Model::StandardDipole => AnyLanes::Standard(Far::new(medium)),
        }
    }

    /// Extinction `σ̃_t` of the unscattered light `L_t`, 1/m (docs/method.md 5.11): the delta-Eddington extinction goes
    /// with the directional dipole, which counts light that is scattered forward as unscattered.
    pub fn unscattered_extinction(self, medium: &Medium) -> [f64; 3] {
        medium.channels.map(|c| match self {
            Model::DirectionalDipole => c.sigma_a + (1.0 - c.asymmetry * c.asymmetry) * c.sigma_s,
            Model::HalfSpace | Model::BetterDipole | Model::StandardDipole => c.extinction(),
        })
    }

    /// Whether images of this model are calibrated unless the user says otherwise. The dipoles are used as published.
    pub fn is_for_calibration(self) -> bool {
        self == Model::HalfSpace
    }

    /// `a` and `b` of the light that leaves in proportion to `T21 (a + b μ)`, `μ` being its cosine outside, for each
    /// channel: with as much power as `T21` alone (docs/method.md 15.8). `[1, 0]` for the dipoles.
    pub fn exit_lobe(self, medium: &Medium) -> [[f64; 2]; 3] {
        match self {
            Model::HalfSpace => half_space::exit_lobe(medium),
            Model::DirectionalDipole | Model::BetterDipole | Model::StandardDipole => [[1.0, 0.0]; 3],
        }
    }

    /// The same behind a rough interface.
    pub fn rough_exit_lobe(self, medium: &Medium, interface: &RoughInterface) -> [[f64; 2]; 3] {
        let smooth = self.exit_lobe(medium);
        match self {
            Model::HalfSpace => [0, 1, 2].map(|c| interface.lobe_below(&medium.channels[c], smooth[c])),
            Model::DirectionalDipole | Model::BetterDipole | Model::StandardDipole => smooth,
        }
    }

    /// How light enters below a rough interface.
    pub fn rough_entry(self, medium: &Medium, interface: &RoughInterface) -> RoughEntry {
        match self {
            Model::HalfSpace => RoughEntry::new(interface).gaining(medium, interface),
            Model::DirectionalDipole | Model::BetterDipole | Model::StandardDipole => RoughEntry::new(interface),
        }
    }

    /// Relative error of this model's reflectance of a half-space under normal incidence, for one channel.
    pub fn reflectance_error(self, channel: &Coefficients, eta: f64) -> f64 {
        let errors = match self {
            Model::HalfSpace => return 0.0,
            Model::DirectionalDipole => &directional_dipole::REFLECTANCE_ERRORS,
            Model::BetterDipole => &better_dipole::REFLECTANCE_ERRORS,
            Model::StandardDipole => &standard_dipole::REFLECTANCE_ERRORS,
        };
        interpolated(errors, channel.reduced_albedo(), eta)
    }

    /// The errors of the three channels if that of any channel which scatters exceeds [`GOOD`].
    pub fn poor_reflectance(self, medium: &Medium) -> Option<[f64; 3]> {
        let errors = medium.map(|c| self.reflectance_error(c, medium.eta));
        let poor = |(c, e): (&Coefficients, &f64)| c.scatters() && e.abs() > GOOD;
        medium.channels.iter().zip(&errors).any(poor).then_some(errors)
    }
}

/// A model in float32 that is chosen when the program runs.
#[derive(Clone, Debug)]
pub enum AnyLanes {
    Directional(Far<DirectionalLanes>),
    HalfSpace(Far<HalfSpaceLanes>),
    Better(Far<BetterLanes>),
    Standard(Far<StandardLanes>),
}

/// Work that is compiled once for each model, so that the model's evaluation is inlined into its loops.
pub trait LaneWork {
    type Output;

    fn run<M: LaneModel>(self, model: &M) -> Self::Output;
}

impl AnyLanes {
    /// The far part of the model.
    pub fn far(mut self, partition: Partition) -> AnyLanes {
        match &mut self {
            AnyLanes::Directional(far) => far.partition = partition,
            AnyLanes::HalfSpace(far) => far.partition = partition,
            AnyLanes::Better(far) => far.partition = partition,
            AnyLanes::Standard(far) => far.partition = partition,
        }
        self
    }

    /// `S_bare` as of [`LaneModel::bare`], for one block; [`AnyLanes::run`] is for many.
    pub fn bare(&self, block: &Block, normal_out: [f32; 3]) -> [Lane; 3] {
        match self {
            AnyLanes::Directional(model) => model.bare(block, normal_out),
            AnyLanes::HalfSpace(model) => model.bare(block, normal_out),
            AnyLanes::Better(model) => model.bare(block, normal_out),
            AnyLanes::Standard(model) => model.bare(block, normal_out),
        }
    }

    /// Does the work with this model.
    pub fn run<W: LaneWork>(&self, work: W) -> W::Output {
        match self {
            AnyLanes::Directional(model) => work.run(model),
            AnyLanes::HalfSpace(model) => work.run(model),
            AnyLanes::Better(model) => work.run(model),
            AnyLanes::Standard(model) => work.run(model),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::built_in;

    #[test]
    fn known_strengths_and_weaknesses() {
        let spectralon = built_in("spectralon").expect("a medium");
        assert!(Model::BetterDipole.poor_reflectance(&spectralon).is_none());
        assert!(Model::DirectionalDipole.poor_reflectance(&spectralon).is_some_and(|e| e[0] > 0.2));
        let ketchup = built_in("ketchup").expect("a medium");
        assert!(Model::BetterDipole.poor_reflectance(&ketchup).is_some_and(|e| e[1] < -0.5));
    }
}

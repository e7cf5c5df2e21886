//! The parts that the tests share: the programs in a temporary folder, glTF files and meshes, random numbers; with the
//! feature `transport` also statistics with stated false-alarm rates, quadrature, and the two phases as functions from
//! a scene to a number.
//!
//! ```
//! use glam::DVec3;
//! use test_support::meshes::{Light, Part, sphere, world};
//!
//! let sun = Light::Directional { towards: DVec3::Z, irradiance: DVec3::ONE };
//! let world = world(&[Part::translucent(sphere(0.01, 2))], &[sun], DVec3::ZERO);
//! assert_eq!(world.scene.mesh.triangles.len(), 8 * 4 * 4);
//! ```

pub mod bench;
#[cfg(feature = "transport")]
pub mod chi_square;
pub mod glb;
#[cfg(feature = "transport")]
pub mod half_space;
#[cfg(feature = "transport")]
pub mod lit;
pub mod meshes;
#[cfg(feature = "transport")]
pub mod pipeline;
#[cfg(feature = "transport")]
pub mod planted;
#[cfg(feature = "transport")]
pub mod quadrature;
pub mod random;
pub mod transfer;
#[cfg(feature = "transport")]
pub mod walk;
#[cfg(feature = "transport")]
pub mod z_test;

pub use bench::{Bench, Limits, Run, data, program};
pub use random::Random;

/// Factor on the samples and seeds of the statistics: more of them with the feature `slow`.
pub const EFFORT: u64 = if cfg!(feature = "slow") { 16 } else { 1 };

/// Chance that a correct program fails any of the statistical decisions, were its seeds drawn anew. They are fixed,
/// so that a test that passed once passes always.
pub const FALSE_ALARM_RATE: f64 = 1e-3;

/// Upper bound of the number of statistical decisions in all tests together.
pub const DECISIONS: f64 = 400.0;

/// The p-value below which one decision fails (Šidák's correction of [`FALSE_ALARM_RATE`] for [`DECISIONS`]).
pub fn significance() -> f64 {
    -((-FALSE_ALARM_RATE).ln_1p() / DECISIONS).exp_m1()
}

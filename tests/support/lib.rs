//! What the tests share: statistics with stated false-alarm rates, quadrature, small scenes, and the two phases as
//! functions from a scene to a number.

pub mod chi_square;
pub mod half_space;
pub mod lit;
pub mod meshes;
pub mod pipeline;
pub mod planted;
pub mod quadrature;
pub mod random;
pub mod walk;
pub mod z_test;

/// How many times more samples and seeds the statistics use than in the fast run.
pub const EFFORT: u64 = if cfg!(feature = "slow") { 16 } else { 1 };

/// Chance that a correct program fails any of the statistical decisions, were its seeds drawn anew; they are fixed, so
/// that a test that passed once passes always.
pub const FALSE_ALARM_RATE: f64 = 1e-3;

/// Statistical decisions in all tests together, at most.
pub const DECISIONS: f64 = 400.0;

/// The p-value below which one decision fails (Šidák's correction of [`FALSE_ALARM_RATE`] for [`DECISIONS`]).
pub fn significance() -> f64 {
    -((-FALSE_ALARM_RATE).ln_1p() / DECISIONS).exp_m1()
}

//! What happens to light below a surface: coefficients of media, and four models of the BSSRDF, in float64 and sixteen
//! samples at a time in float32. What happens *at* a surface is in [`bsdf`].
//!
//! The crate has no I/O and no random numbers. Lengths are in m, coefficients in 1/m, `S` is in 1/(m² sr). Three values
//! of the BSSRDF are kept apart (docs/method.md 1.1 to 1.3):
//!
//! ```text
//! S        = T12 · T21 · S_bare      the full BSSRDF
//! S_gather = T12 · S_bare            the term of the sum, after the choice by R = 1 − T21
//! ```
//!
//! The sum over samples uses `S_gather`, because the choice between reflection and refraction at the exitant point
//! accounts for `T21`.
//!
//! ```
//! use bssrdf::{DVec3, Exitant, Incident, Model, built_in, evaluate};
//!
//! let milk = built_in("skimmilk")?;
//! let dipole = Model::StandardDipole.of(&milk);
//! let incident = Incident { position: DVec3::ZERO, normal: DVec3::Z, direction: DVec3::Z };
//! let exitant = |x: f64| Exitant { position: DVec3::X * x, normal: DVec3::Z, direction: DVec3::Z };
//! let red = |x: f64| evaluate(&*dipole, milk.eta, 0, &incident, &exitant(x));
//! assert!(red(1e-3).full > red(2e-3).full);
//! assert!(red(1e-3).full < red(1e-3).gather && red(1e-3).gather < red(1e-3).bare);
//! # Ok::<(), bssrdf::MediumError>(())
//! ```

mod accuracy;
mod albedo;
mod evaluate;
pub mod half_space;
pub mod lanes;
mod media;
mod medium;
mod medium_file;
mod model;
mod partition;
mod rough_interface;

pub use accuracy::GOOD;
pub use albedo::single_scattering_albedo;
pub use bsdf::fresnel;
pub use evaluate::{Bssrdf, Exitant, Incident, Separation, Values, evaluate};
pub use glam::DVec3;
pub use media::{built_in, built_in_names};
pub use medium::{Coefficients, ETA_MAX, ETA_MIN, Interface, Medium};
pub use medium_file::{MediumError, MediumFile, Optics, Unit};
pub use model::{AnyLanes, BetterDipole, DirectionalDipole, HalfSpace, LaneWork, Model, StandardDipole};
pub use partition::{Far, Partition};
pub use rough_interface::{RoughEntry, RoughInterface};
pub use simd;

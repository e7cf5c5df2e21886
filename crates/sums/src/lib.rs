//! The sum over the samples of a cloud at one exitant point. Phase two renders with it; phase one uses it to choose the
//! number of samples.
//!
//! A [`Scatterer`](estimator::Scatterer) is a medium under a BSSRDF model; a [`Summation`] joins it with the samples
//! that light it; an [`Estimator`](estimator::Estimator) says which of them are evaluated.
//!
//! ```
//! use bssrdf::{Model, built_in};
//! use formats::cloud::{Node, Record, Sample, tile};
//! use glam::{DVec3, Vec3};
//! use std::sync::Arc;
//! use sums::{
//!     Summation,
//!     drawn::DrawnCounts,
//!     estimator::{Estimator, Scatterer, Scratch},
//!     samples::{Exit, LitSamples},
//! };
//!
//! let medium = built_in("marble").expect("it is built in");
//! let scatterer = Arc::new(Scatterer::new(Model::StandardDipole, &medium, f64::INFINITY));
//! // One sample: 1 W falls vertically on the plane z = 0, at the origin. The tree over one tile is its root alone.
//! let sample = Sample { position: Vec3::ZERO, normal: DVec3::Z, direction: DVec3::Z, flux: Vec3::ONE };
//! let (tiles, nodes) = ([tile(&[Record::new(&sample)])], [Node::default(); 2]);
//! let halves = [1, 0].map(|samples| LitSamples::of(&tiles, &nodes, samples, medium.eta));
//! let summation = Summation::new(scatterer, vec![halves], DrawnCounts::new(vec![[1, 0]]));
//!
//! // The light that leaves the plane fades with the distance.
//! let leaving = |x: f64| {
//!     let exit = |key: usize| Exit::new(DVec3::X * x, DVec3::Z, key as u64);
//!     summation.whole(Estimator::Exhaustive, exit, &mut Scratch::default()).radiance
//! };
//! assert!(leaving(1e-3).cmpgt(leaving(2e-3)).all() && leaving(2e-3).min_element() > 0.0);
//! ```

pub mod confidence;
pub mod drawn;
pub mod estimator;
pub mod samples;
mod summation;

pub use summation::{Leaving, Summation};

//! Tests whether two sets of images differ by more than their noise.
//!
//! All pixels of an image are computed from one cloud and share its error, so neither pixels nor their sample variances
//! are evidence; images from independent clouds are. Each image of such a set, a *replicate*, is reduced to a few
//! statistics ([`Kind`]). Their means are compared by Student's t-test ([`judge()`]), with Šidák's correction over all
//! tests.

mod error;
mod folder;
mod judge;
mod report;
mod statistic;
mod summary;

pub use error::ReplicateError;
pub use folder::{MIN_REPLICATES, Replicates};
pub use judge::{FALSE_ALARM_RATE, corrected_level, judge};
pub use report::{Judged, NoiseReport, Scatter};
pub use statistic::Kind;
pub use summary::{MEAN_IMAGE, SUMMARY, Summarised, Summary};

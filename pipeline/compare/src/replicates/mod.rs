//! Are two sets of images the same but for their noise?
//!
//! All pixels of an image read one cloud and share its error, so neither pixels nor their sample variances are
//! evidence; images from independent clouds are. A set of them, the *replicates*, is reduced to few statistics each
//! ([`statistic`]), whose means are compared by Student's t-test ([`mod@judge`]), Šidák's correction over all of them.

mod error;
mod folder;
mod judge;
mod report;
mod statistic;
mod summary;

pub use error::ReplicateError;
pub use folder::Replicates;
pub use judge::{FALSE_ALARM_RATE, Judged, Scatter, corrected_level, judge};
pub use report::NoiseReport;
pub use statistic::Kind;
pub use summary::{MEAN_IMAGE, SUMMARY, Summarised, Summary};

/// Fewest replicates of either side: what fewer say of their own scatter is too little.
pub const FEWEST: usize = 8;

//! The sum over the samples of a cloud at one exitant point: what phase two is made of, and what phase one chooses the
//! number of its samples by.

pub mod confidence;
pub mod estimator;
pub mod samples;

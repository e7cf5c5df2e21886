//! The samples that metrics are measured on.

/// The samples of a channel in the reference and in the test image, which have the same length.
pub type Pair<'a> = (&'a [f32], &'a [f32]);

//! The samples that metrics are measured on.

/// Samples of both images, plane by plane; all planes have the same length.
#[derive(Clone, Debug)]
pub struct Samples<'a> {
    /// Reference and test image, for each channel.
    pub planes: Vec<(&'a [f32], &'a [f32])>,
}

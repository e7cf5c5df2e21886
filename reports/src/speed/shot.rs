//! One image to render.

use crate::speed::configuration::{Configuration, Medium, Subject};

/// The input and the settings of an image.
#[derive(Clone)]
pub struct Shot<'a> {
    pub subject: &'a Subject,
    pub medium: Medium,
    pub configuration: Configuration,
    /// `K`
    pub samples: u64,
    pub spp: u64,
    pub cloud_seed: u64,
    pub gather_seed: u64,
    /// Width and height, pixels.
    pub size: [u64; 2],
    pub threads: usize,
    /// Random walks of each channel of a calibration; none for the model as it is.
    pub walks: Option<u64>,
    /// More flags of `gather`.
    pub more: Vec<String>,
}

//! The pixels of a panorama, and their limits.

use crate::memory::zeros;

/// An environment map in linear Rec. 709. Numbers of the file that are no radiance, negative or not finite, are kept.
#[derive(Clone, Debug, PartialEq)]
pub struct Panorama {
    /// Pixels per row.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// Red, green and blue, row after row from the top.
    pub pixels: Vec<[f32; 3]>,
    /// The changes to the numbers of the file, a sentence each.
    pub warnings: Vec<String>,
}

/// The size of a picture as its header states it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PanoramaSize {
    /// Pixels per row.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// Largest memory of [`Panorama::read`].
    pub reading_bytes: u64,
}

/// Most pixels of a picture.
const MAX_PIXELS: usize = 1 << 27;
/// Bytes of a pixel.
pub(super) const PIXEL_BYTES: u64 = 12;
pub(super) fn check_size([width, height]: [usize; 2]) -> Result<(), String> {
    match width.checked_mul(height) {
        Some(1..=MAX_PIXELS) => Ok(()),
        _ => Err(format!("{width} x {height} pixels; scale the picture down to at most {MAX_PIXELS}")),
    }
}

/// Black pixels, if there is memory for them.
pub(super) fn black(width: usize, height: usize) -> Result<Vec<[f32; 3]>, String> {
    let scarce = || format!("not enough memory for {width} x {height} pixels; scale the picture down");
    zeros(width * height).ok_or_else(scarce)
}

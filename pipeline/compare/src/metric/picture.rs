//! The samples that metrics are measured on: those of one channel, and of the picture that both images show in three
//! colors.

use formats::image::Image;
use rayon::prelude::*;

/// The samples of a channel in the reference and in the test image, which have the same length.
pub type Pair<'a> = (&'a [f32], &'a [f32]);

/// R, G and B of both images: linear light, `width * height` samples each.
#[derive(Clone, Copy, Debug)]
pub struct Picture<'a> {
    /// Width and height in pixels; neither is zero.
    pub(super) size: [usize; 2],
    pub(super) reference: [&'a [f32]; 3],
    pub(super) test: [&'a [f32]; 3],
}

impl<'a> Picture<'a> {
    /// Returns `None` if one of the images has no R, G and B, or no pixels. Both must have the same size.
    pub fn new(reference: &'a Image, test: &'a Image) -> Option<Picture<'a>> {
        let size = [reference.width, reference.height];
        let pixels = size[0].checked_mul(size[1]).filter(|pixels| *pixels > 0)?;
        let channel = |image: &'a Image, name| image.channel(name).filter(|samples| samples.len() == pixels);
        let colors = |image| Some([channel(image, "R")?, channel(image, "G")?, channel(image, "B")?]);
        Some(Picture { size, reference: colors(reference)?, test: colors(test)? })
    }

    /// Whether all samples of the pixel of this index are finite in both images.
    pub(super) fn is_finite(&self, pixel: usize) -> bool {
        self.reference.iter().chain(&self.test).all(|samples| samples[pixel].is_finite())
    }

    /// Whether all samples of both images are finite.
    pub(super) fn all_finite(&self) -> bool {
        let mut planes = self.reference.iter().chain(&self.test);
        planes.all(|samples| samples.par_iter().all(|sample| sample.is_finite()))
    }
}

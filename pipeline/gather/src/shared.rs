//! Images whose pixels share their paths, and what that does to their error.

use crate::{
    allotment::Allotment,
    image::{Input, Settings},
    passes::Passes,
    path_state::Layer,
};
use rayon::prelude::*;
use scene::random::{Purpose, Stream};

/// Whether the pixels of an image can share their paths: not those of random walks, nor of several clouds, whose shards
/// are picked for all paths of a pixel.
pub fn can_share(input: &Input, settings: &Settings) -> bool {
    !settings.reference && input.clouds.len() == 1
}

impl Passes<'_> {
    /// Shares all further paths out by the noise of those that there are, once. Nothing changes before there is a path for
    /// each half of the cloud.
    pub fn share_out(&mut self) {
        if self.allotment.is_some() || !can_share(&self.renderer().input, self.settings()) || self.paths() < 2 {
            return;
        }
        let part = self.settings().part();
        let noise = |pixel: usize| (self.sums(pixel).variances()[1].element_sum(), self.is_edge(pixel));
        let (variances, edges): (Vec<f64>, Vec<bool>) = (0..part.pixels()).into_par_iter().map(noise).unzip();
        self.allotment = Some(Allotment::by_noise(self.paths(), part.width, &variances, &edges, self.rounding()));
    }

    /// The random numbers by which the pixels' numbers of paths are rounded.
    pub(crate) fn rounding(&self) -> Stream {
        Stream::new(self.settings().seed, Purpose::Allotment)
    }

    /// The paths of a pixel of the part where pixels have so many, or share so many.
    pub(crate) fn paths_of(&self, pixel: usize, level: u32) -> u32 {
        self.allotment.as_ref().map_or(level, |allotment| allotment.paths(pixel, level))
    }

    /// Whether pixels share their paths.
    pub fn shares(&self) -> bool {
        self.allotment.is_some()
    }

    /// The paths that are added to all pixels together until they have, or share, so many for each.
    pub fn paths_until(&self, level: u32) -> u64 {
        let added = |pixel: usize| self.paths_of(pixel, level).saturating_sub(self.paths_of(pixel, self.paths()));
        (0..self.settings().part().pixels()).map(|pixel| u64::from(added(pixel))).sum()
    }

    /// The variance that is expected of the image where pixels have, or share, so many paths for each, in units of its
    /// own.
    pub fn expected_variance(&self, level: u32) -> f64 {
        let alike = || 1.0 / f64::from(level);
        self.allotment.as_ref().map_or_else(alike, |allotment| allotment.expected_variance(level))
    }

    /// The paths per pixel for which the cut must be as accurate, so that it adds what it may to the image: where pixels
    /// share them, their harmonic mean by the scattered light.
    pub(crate) fn effective_paths(&self, level: u32) -> f64 {
        let (mut power, mut by_paths) = (0.0, 0.0);
        if self.allotment.is_some() {
            for pixel in 0..self.settings().part().pixels() {
                let light = self.sums(pixel).layers()[Layer::Subsurface as usize].length_squared();
                power += light;
                by_paths += light / f64::from(self.paths_of(pixel, level));
            }
        }
        if by_paths > 0.0 { power / by_paths } else { f64::from(level) }
    }
}

//! Estimates of how wrong the model was, and is with the factor.

use crate::{
    fit::{Counts, Fit, Smoothness},
    surface::Surface,
};
use bsdf::fresnel;
use formats::calibration::ChannelErrors;
use glam::DVec3;
use std::f64::consts::PI;

/// The model's light on each patch.
pub struct Light {
    /// For each channel, the power that leaves each patch, W.
    pub power: [Vec<f64>; 3],
    /// For each channel, the mean radiance that leaves each patch, W/(m² sr).
    radiance: [Vec<f64>; 3],
    /// The share of the surface that each patch is.
    share: Vec<f64>,
}

impl Light {
    /// The mean radiance of one channel that leaves each patch, W/(m² sr).
    pub fn radiance(&self, channel: usize) -> &[f64] {
        &self.radiance[channel]
    }

    /// From the sums over the cloud at the points of a surface, W/(m² sr).
    pub fn new(sums: &[DVec3], patch_of: &[u32], surface: &Surface, eta: f64, patches: usize) -> Light {
        let (mut total, mut count) = (vec![DVec3::ZERO; patches], vec![0.0; patches]);
        for (sum, patch) in sums.iter().zip(patch_of) {
            total[*patch as usize] += *sum;
            count[*patch as usize] += 1.0;
        }
        let [transmitted, ..] = fresnel::exit_moments(eta);
        let area = surface.area / sums.len().max(1) as f64;
        let of = |f: &dyn Fn(usize) -> DVec3| [0, 1, 2].map(|c| (0..patches).map(|p| f(p)[c]).collect());
        Light {
            power: of(&|p| total[p] * (area * transmitted)),
            radiance: of(&|p| total[p] * (transmitted / PI / f64::max(count[p], 1.0))),
            share: count.iter().map(|n| n / sums.len().max(1) as f64).collect(),
        }
    }
}

/// The squared radiance that is added to the denominator of relMSE.
const DARK: f64 = 0.01;

/// Patches that fewer counts leave than this are unresolved.
const FEW: f64 = 4.0;

/// The relMSE of a channel before and after the fit.
pub fn channel_errors(
    smoothness: &Smoothness,
    light: &Light,
    channel: usize,
    counts: &Counts,
    fit: &Fit,
) -> ChannelErrors {
    let [both, one, two] = [&fit.both, &fit.halves[0], &fit.halves[1]].map(|f| smoothness.at_patches(f));
    let (mut before, mut noise, mut unresolved) = (0.0, 0.0, 0.0);
    for p in 0..both.len() {
        let (share, model) = (light.share[p], light.radiance[channel][p]);
        let truth = model * both[p].exp();
        let denominator = truth * truth + DARK;
        before += share * (model - truth).powi(2) / denominator;
        noise += share * (truth * 0.5 * (one[p] - two[p])).powi(2) / denominator;
        if counts.halves[0][p] + counts.halves[1][p] < FEW {
            unresolved += share;
        }
    }
    ChannelErrors { before, after: noise, uncertainty: noise, unresolved }
}

//! One channel of the model's light on a material beside that of the walks.

use crate::{
    errors::{Evidence, Light},
    factors::{mean_square_turn, shift},
    fit::Smoothness,
    patches::Patches,
    tally::Walking,
    views::{Leaving, Views},
};
use bssrdf::{Medium, fresnel, half_space::exit_lobe};
use formats::calibration::ChannelErrors;
use scene::DVec3;
use walks::Roughness;

/// The largest share of walks that may leave through holes.
const HOLES: f64 = 1e-3;

/// The model's light on one material, and the walks that it is compared with.
pub struct Compared<'a> {
    pub medium: &'a Medium,
    pub patches: &'a Patches,
    pub smoothness: Smoothness,
    pub light: Light,
    pub walking: Walking<'a>,
    pub views: Views<'a>,
    /// Walks of each channel.
    pub walks: u64,
}

/// What is found for one channel.
pub struct Found {
    /// For each patch, the natural logarithm of the factor, and the gradient of that of the light, 1/m.
    pub log_factors: Vec<f64>,
    pub slopes: Vec<DVec3>,
    pub lobe: [f64; 2],
    pub errors: ChannelErrors,
}

impl Compared<'_> {
    /// Compares one channel; none if no light leaves in it. The error is the share of the walks that left through holes.
    pub fn channel(&self, channel: usize, progress: &(impl Fn(u64) + Sync)) -> Result<Option<Found>, f64> {
        let Compared { medium, patches, smoothness, light, walking, views, .. } = self;
        let tally = walking.tally(channel, &medium.channels[channel], self.walks, progress);
        let share = tally.holes as f64 / tally.walks.max(1) as f64;
        if share > HOLES {
            return Err(share);
        }
        let Some(counted) = tally.counted(walking.entries.power(channel), &light.power[channel]) else {
            return Ok(None);
        };
        let counts = counted.at_patches(patches);
        let fit = smoothness.fit(&counts);
        let fitted = smoothness.at_patches(&fit.both);
        let logarithms: Vec<f64> = fitted.iter().zip(&counts.model).map(|(f, m)| f + m.ln()).collect();
        let slopes = patches.gradient(&logarithms);
        let mean_cosine = tally.cosines / tally.sum();
        let lobe = match walking.rough {
            None => exit_lobe(medium.eta, mean_cosine),
            Some(rough) => rough.interface().exit_lobe(mean_cosine),
        };
        let transmittance = |cosine: f64| match walking.rough.map(Roughness::interface) {
            None => fresnel::transmittance(cosine, medium.eta),
            Some(rough) => rough.boundary.transmittance(cosine, rough.roughness),
        };
        let shift = shift(&medium.channels[channel], medium.eta);
        let patch_of = |cell: u32| patches.patch_of_cell(cell);
        let turn = |cell: u32| mean_square_turn(shift * slopes[patch_of(cell) as usize].length());
        let leaving = Leaving { transmittance: &transmittance, lobe, shift, slopes: &slopes, channel };
        let evidence = Evidence {
            light,
            channel,
            both: smoothness.at_cells(&fit.both),
            halves: fit.halves.each_ref().map(|f| smoothness.at_cells(f)),
            turn: (0..patches.cells() as u32).map(turn).collect(),
            shares: views.shares(&leaving, patch_of),
            counted: &counted,
            views,
        };
        Ok(Some(Found { lobe, errors: evidence.errors(patches), log_factors: fit.both, slopes }))
    }
}

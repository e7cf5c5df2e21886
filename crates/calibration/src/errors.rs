//! Estimates of how wrong the model was, and is with the factor.

use crate::{
    fit::{Counts, Fit, Smoothness},
    patches::Patches,
    tally::Counted,
};
use bssrdf::half_space::exit_moment;
use formats::calibration::ChannelErrors;
use glam::DVec3;
use std::f64::consts::PI;

/// The model's light on each cell.
pub struct Light {
    /// For each channel, the power that leaves each cell, W (docs/method.md 16.2).
    pub power: [Vec<f64>; 3],
    /// For each channel, the mean radiance that leaves each cell, in units of `white`.
    radiance: [Vec<f64>; 3],
    /// The share of the surface that each cell is.
    share: Vec<f64>,
}

impl Light {
    /// From the sums over the cloud at points of a surface, which lie in the cells `cell_of`, and the areas of the cells,
    /// m². `white` is the radiance of a white diffuse surface that faces the light, W/(m² sr).
    pub fn new(sums: &[DVec3], cell_of: &[u32], areas: &[f64], eta: f64, white: f64) -> Light {
        let cells = areas.len();
        let (mut total, mut count) = (vec![DVec3::ZERO; cells], vec![0.0; cells]);
        for (sum, cell) in sums.iter().zip(cell_of) {
            total[*cell as usize] += *sum;
            count[*cell as usize] += 1.0;
        }
        let transmitted = exit_moment(0, eta);
        let mean = |cell: usize| total[cell] / f64::max(count[cell], 1.0);
        let of = |f: &dyn Fn(usize) -> DVec3| [0, 1, 2].map(|c| (0..cells).map(|p| f(p)[c]).collect());
        let area: f64 = areas.iter().sum();
        Light {
            power: of(&|cell| mean(cell) * (areas[cell] * transmitted)),
            radiance: of(&|cell| mean(cell) * (transmitted / (PI * white))),
            share: areas.iter().map(|own| own / area).collect(),
        }
    }
}

/// The squared radiance that is added to the denominator of relMSE, in units of white.
const DARK: f64 = 0.01;

/// Patches that fewer counts leave than this are unresolved.
const FEW: f64 = 4.0;

/// What calibration cannot mend on smooth shapes, as relMSE of bright light: the change of the light within a cell, and
/// with the angle of view (docs/reports/accuracy.md).
const FLOOR: f64 = 5e-5;

/// The relMSE of a channel before and after the fit, at the size of a cell (docs/method.md 16.6).
///
/// The misfits of the two halves of the walks at a cell are independent, so that their product estimates the square of
/// what both share, without any noise on average: what the fit leaves. The fits of the halves themselves have less noise
/// by far, and their product is most of the model's error; the misfits are a part of it where they exceed their scatter.
/// `turn` is, at each patch, the mean square of the factor by the eye's angle, less 1: without a calibration no image has it.
pub fn channel_errors(
    smoothness: &Smoothness,
    patches: &Patches,
    light: &Light,
    channel: usize,
    counted: &Counted,
    fit: &Fit,
    turn: &[f64],
) -> ChannelErrors {
    let [both, one, two] = [&fit.both, &fit.halves[0], &fit.halves[1]].map(|f| smoothness.at_cells(f));
    let (mut smooth, mut turned, mut misfit, mut noise, mut spread, mut bright) = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0);
    for cell in 0..both.len() {
        let (share, model, expected) = (light.share[cell], light.radiance[channel][cell], counted.model[cell]);
        if expected <= 0.0 {
            continue;
        }
        let truth = model * both[cell].exp();
        let weight = share / (truth * truth + DARK);
        let [a, b] = [0, 1].map(|half| counted.halves[half][cell] / expected);
        smooth += weight * model * model * one[cell].exp_m1() * two[cell].exp_m1();
        turned += weight * model * model * turn[patches.patch_of_cell(cell as u32) as usize];
        bright += weight * truth * truth;
        let product = truth * truth * (a * (-one[cell]).exp() - 1.0) * (b * (-two[cell]).exp() - 1.0);
        misfit += weight * product;
        spread += (weight * product).powi(2);
        noise += weight * (truth * 0.5 * (one[cell] - two[cell])).powi(2);
    }
    let unresolved = unresolved(patches, counted);
    let scatter = spread.sqrt();
    ChannelErrors {
        before: turned + smooth.max(0.0) + if misfit > scatter { misfit } else { 0.0 },
        after: misfit.max(0.0) + noise + FLOOR * bright,
        uncertainty: scatter + noise,
        unresolved,
    }
}

/// The share of patches that few walks leave, of those that the model sees light leave: not of those inside the solid.
fn unresolved(patches: &Patches, counted: &Counted) -> f64 {
    let Counts { model, halves } = counted.at_patches(patches);
    let few = |(model, left): (&f64, f64)| (*model > 0.0).then_some(left < FEW);
    let left = halves[0].iter().zip(&halves[1]).map(|(a, b)| a + b);
    let seen: Vec<bool> = model.iter().zip(left).filter_map(few).collect();
    seen.iter().filter(|few| **few).count() as f64 / seen.len().max(1) as f64
}

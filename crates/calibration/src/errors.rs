//! Estimates of how wrong the model was, and is with the factor.

use crate::{
    fit::{Fit, Smoothness},
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
    /// For each channel, the mean radiance that leaves each cell, W/(m² sr).
    radiance: [Vec<f64>; 3],
    /// The share of the surface that each cell is.
    share: Vec<f64>,
}

impl Light {
    /// From the sums over the cloud at points of a surface, W/(m² sr), which lie in the cells `cell_of`, and the areas of
    /// the cells, m².
    pub fn new(sums: &[DVec3], cell_of: &[u32], areas: &[f64], eta: f64) -> Light {
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
            radiance: of(&|cell| mean(cell) * (transmitted / PI)),
            share: areas.iter().map(|own| own / area).collect(),
        }
    }
}

/// The squared radiance that is added to the denominator of relMSE.
const DARK: f64 = 0.01;

/// Patches that fewer counts leave than this are unresolved.
const FEW: f64 = 4.0;

/// What calibration cannot mend on smooth shapes, as relMSE: the change of the light within a cell, and with the angle
/// of view (docs/reports/accuracy.md).
const FLOOR: f64 = 2e-4;

/// The relMSE of a channel before and after the fit, at the size of a cell (docs/method.md 16.6).
///
/// The misfits of the two halves of the walks at a cell are independent, so that their product estimates the square of
/// what both share, the error of the model, without any noise on average.
pub fn channel_errors(
    smoothness: &Smoothness,
    patches: &Patches,
    light: &Light,
    channel: usize,
    counted: &Counted,
    fit: &Fit,
) -> ChannelErrors {
    let [both, one, two] = [&fit.both, &fit.halves[0], &fit.halves[1]].map(|f| smoothness.at_cells(f));
    let (mut before, mut misfit, mut noise, mut spread) = (0.0, 0.0, 0.0, 0.0);
    for cell in 0..both.len() {
        let (share, model, expected) = (light.share[cell], light.radiance[channel][cell], counted.model[cell]);
        if expected <= 0.0 {
            continue;
        }
        let truth = model * both[cell].exp();
        let weight = share / (truth * truth + DARK);
        let [a, b] = [0, 1].map(|half| counted.halves[half][cell] / expected);
        before += weight * model * model * (a - 1.0) * (b - 1.0);
        let product = truth * truth * (a * (-one[cell]).exp() - 1.0) * (b * (-two[cell]).exp() - 1.0);
        misfit += weight * product;
        spread += (weight * product).powi(2);
        noise += weight * (truth * 0.5 * (one[cell] - two[cell])).powi(2);
    }
    let mut left = vec![0.0; patches.count()];
    for half in &counted.halves {
        half.iter().enumerate().for_each(|(cell, n)| left[patches.patch_of_cell(cell as u32) as usize] += n);
    }
    let unresolved = left.iter().filter(|n| **n < FEW).count() as f64 / left.len() as f64;
    ChannelErrors {
        before: before.max(0.0),
        after: misfit.max(0.0) + noise + FLOOR,
        uncertainty: spread.sqrt() + noise,
        unresolved,
    }
}

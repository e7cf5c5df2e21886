//! Estimates of how wrong the model was, and is with the factor.

use crate::{
    fit::Counts,
    misfit::{DARK, Misfit, Part},
    patches::Patches,
    tally::Counted,
    views::{PerView, REGION_LEVELS, VIEWS, Views},
};
use bssrdf::half_space::exit_moment;
use formats::calibration::ChannelErrors;
use glam::DVec3;
use std::{f64::consts::PI, ops::Range};

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

/// Patches that fewer counts leave than this are unresolved, and parts that expect fewer are left out.
const FEW: f64 = 4.0;

/// What the shift by the angle of view leaves of the mean square of what it changes, since it is no more than the first
/// moment of the light: as much is left on the spheres of docs/reports/accuracy.md under suns, spots and each other.
const OF_TURN: f64 = 0.07;

/// What the errors of a channel are found from.
pub struct Evidence<'a> {
    pub light: &'a Light,
    pub channel: usize,
    pub counted: &'a Counted,
    /// The logarithms of the factor at each cell: of the fit, and of those of the two halves of the walks.
    pub both: Vec<f64>,
    pub halves: [Vec<f64>; 2],
    /// At each cell, the mean square of the factor by the eye's angle, less 1: without a calibration no image has it.
    pub turn: Vec<f64>,
    pub views: &'a Views<'a>,
    /// The light towards each view as a share of what leaves each cell ([`Views::shares`]).
    pub shares: Vec<PerView>,
}

impl Evidence<'_> {
    /// The relMSE of a channel before and after the fit, as images from all around show it (docs/method.md 16.6).
    ///
    /// What the fits of the halves differ by is the noise of the fit; what the walks differ by from the fits of their own
    /// halves, in place and in direction, is what it cannot hold. Where the walks are too few to show that of a single
    /// patch or of the angle of view, what the fit itself holds just above says how much it is.
    pub fn errors(&self, patches: &Patches) -> ChannelErrors {
        let visible = self.visible();
        let (mut smooth, mut turned, mut noise, mut angle) = (0.0, 0.0, 0.0, 0.0);
        let [one, two] = &self.halves;
        for cell in self.lit() {
            let (model, truth) = (self.model(cell), self.truth(cell));
            let weight = visible[cell] / (truth * truth + DARK);
            smooth += weight * model * model * one[cell].exp_m1() * two[cell].exp_m1();
            turned += weight * model * model * self.turn[cell];
            noise += weight * (truth * 0.5 * (one[cell] - two[cell])).powi(2);
            angle += weight * truth * truth * self.turn[cell] * OF_TURN;
        }
        let levels = patches.count().ilog2();
        let places: Vec<Misfit> =
            (2..=levels).filter(|l| (levels - l).is_multiple_of(2)).map(|l| self.places(l, &visible)).collect();
        let directions: Vec<Misfit> = (2..=REGION_LEVELS).step_by(2).map(|level| self.directions(level)).collect();
        let (place, direction) = (Misfit::finest(&places), Misfit::finest(&directions));
        let (within, angle) = (self.within(levels, &visible), angle.max(direction.energy));
        let left = place.energy + within + angle;
        let inferred = if angle > direction.energy { within + angle } else { within };
        ChannelErrors {
            before: turned + smooth.max(0.0) + left,
            after: noise + left,
            uncertainty: place.scatter.hypot(direction.scatter).hypot(0.5 * inferred),
            unresolved: unresolved(patches, self.counted),
        }
    }

    /// The cells that the model sees light leave.
    fn lit(&self) -> impl Iterator<Item = usize> {
        (0..self.both.len()).filter(|cell| self.counted.model[*cell] > 0.0)
    }

    /// What the factor changes within the nodes of this level, as the fits of both halves agree on it.
    fn within(&self, level: u32, visible: &[f64]) -> f64 {
        let weight = |cell: usize| {
            let square = self.truth(cell).powi(2);
            if self.counted.model[cell] > 0.0 { visible[cell] * square / (square + DARK) } else { 0.0 }
        };
        let of_node = |cells: Range<usize>| {
            let sum = |f: &dyn Fn(usize) -> f64| cells.clone().map(|cell| weight(cell) * f(cell)).sum::<f64>();
            let [one, two] = &self.halves;
            let all = sum(&|_| 1.0);
            if all > 0.0 { sum(&|c| one[c] * two[c]) - sum(&|c| one[c]) * sum(&|c| two[c]) / all } else { 0.0 }
        };
        self.nodes(level).map(of_node).sum::<f64>().max(0.0)
    }

    /// The model's radiance of a cell, and the true one by the fit, in units of white.
    fn model(&self, cell: usize) -> f64 {
        self.light.radiance[self.channel][cell]
    }

    fn truth(&self, cell: usize) -> f64 {
        self.model(cell) * self.both[cell].exp()
    }

    /// The share of all images that each cell is; of the surface, if nothing of it is to be seen.
    fn visible(&self) -> Vec<f64> {
        let of = |(share, seen): (&f64, &PerView)| share * seen.iter().sum::<f64>();
        let visible: Vec<f64> = self.light.share.iter().zip(&self.views.visible).map(of).collect();
        let total: f64 = visible.iter().sum();
        if total > 0.0 { visible.iter().map(|own| own / total).collect() } else { self.light.share.clone() }
    }

    /// What the fit of a half of the walks expects to leave a cell.
    fn expected(&self, half: usize, cell: usize) -> f64 {
        self.counted.model[cell] * self.halves[half][cell].exp()
    }

    /// The cells of each node at this level of splits.
    fn nodes(&self, level: u32) -> impl Iterator<Item = Range<usize>> + use<> {
        let cells = self.both.len();
        let size = cells >> level.min(cells.ilog2());
        (0..cells / size).map(move |node| node * size..(node + 1) * size)
    }

    /// The misfit at the nodes of this level.
    fn places(&self, level: u32, visible: &[f64]) -> Misfit {
        let sum = |cells: &Range<usize>, f: &dyn Fn(usize) -> f64| cells.clone().map(f).sum::<f64>();
        let part = |cells: Range<usize>| {
            let weight = sum(&cells, &|cell| visible[cell]);
            let shown = sum(&cells, &|cell| visible[cell] * self.truth(cell));
            Part {
                weight,
                radiance: if weight > 0.0 { shown / weight } else { 0.0 },
                counts: [0, 1].map(|half| sum(&cells, &|cell| self.counted.halves[half][cell])),
                expected: [0, 1].map(|half| sum(&cells, &|cell| self.expected(half, cell))),
            }
        };
        Misfit::of(self.nodes(level).map(part))
    }

    /// The misfit of the light towards each view at the nodes of this level, of which each has the light that left it.
    fn directions(&self, level: u32) -> Misfit {
        let nodes: Vec<Range<usize>> = self.nodes(level).collect();
        let regions = (1 << REGION_LEVELS) / nodes.len();
        let total: f64 = self.light.share.iter().zip(&self.views.visible).map(|(s, v)| s * v.iter().sum::<f64>()).sum();
        let mut parts = Vec::new();
        for (node, cells) in nodes.iter().enumerate() {
            let sum = |f: &dyn Fn(usize) -> f64| cells.clone().map(f).sum::<f64>();
            let own = |half: usize, view: usize| {
                let regions = node * regions..(node + 1) * regions;
                regions.map(|region| self.counted.views[half][region][view]).sum::<f64>()
            };
            let left = [0, 1].map(|half| (0..VIEWS).map(|view| own(half, view)).sum::<f64>());
            let leaves = sum(&|cell| self.expected(0, cell) + self.expected(1, cell));
            for view in 0..VIEWS {
                let towards = sum(&|cell| (self.expected(0, cell) + self.expected(1, cell)) * self.shares[cell][view]);
                let projected = sum(&|cell| self.light.share[cell] * self.views.projected[cell][view]);
                let shown = sum(&|cell| self.light.share[cell] * self.truth(cell) * self.shares[cell][view]);
                if 0.5 * towards >= FEW && projected > 0.0 {
                    parts.push(Part {
                        weight: sum(&|cell| self.light.share[cell] * self.views.visible[cell][view]) / total,
                        radiance: PI * shown / projected,
                        counts: [0, 1].map(|half| own(half, view)),
                        expected: left.map(|left| left * towards / leaves),
                    });
                }
            }
        }
        Misfit::of(parts.into_iter())
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

#[cfg(test)]
mod tests;

//! The hierarchical sum: a cut through the tree over the samples.
//!
//! An open leaf contributes all of its samples. A closed node of `n` samples contributes one of them, picked uniformly,
//! `n` times. The sum is unbiased for every cut that is chosen without regard to the samples that are picked. Siblings
//! pick samples of opposite places in the order: both are split alike, so that the one lies about as far to one side of
//! its node as the other to the other side, and the errors of their positions cancel to first order. A node is
//! opened while the standard deviation that it would add, as [`FalloffTables`] predict it, exceeds a threshold. The
//! threshold is the same for all nodes, which takes the fewest nodes for a given sum of variances. It follows from the
//! target error and from an estimate of the sum, which is the contribution of the open leaves and the predicted one of
//! the closed nodes, and is lowered until the predicted error of the cut is small enough.

use super::{
    cut_correction::CutCorrection,
    falloff_tables::FalloffTables,
    random_bits::random_bits,
    sum::{Accumulator, Sum},
};
use crate::samples::{Exit, LitSamples};
use bssrdf::{
    lanes::{LANES, Lane, LaneModel},
    simd::Kernel,
};
use formats::cloud::{Node, TILE, first_leaf};

/// A closed node.
#[derive(Clone, Copy, Debug)]
struct Closed {
    id: u32,
    /// The predicted standard deviation of its contribution, summed over channels, in W/(m² sr) times
    /// `scale` of [`LitSamples`].
    error: f32,
    /// Its predicted contribution, in the same unit.
    value: f32,
    /// The predicted contribution if most of it comes from the near end of the node.
    max_value: f32,
}

/// Lists that a thread keeps from one sum to the next, so that no sum allocates memory.
#[derive(Clone, Debug, Default)]
pub struct Scratch {
    frontier: Vec<u32>,
    closed: Vec<Closed>,
    /// The tiles of the open leaves.
    open: Vec<u32>,
    /// The picked sample of each closed node, and how many samples it represents.
    picks: Vec<(u32, f32)>,
}

/// Evaluates a cut.
pub struct Cut<'a, M> {
    pub model: &'a M,
    pub samples: &'a LitSamples<'a>,
    pub tables: &'a FalloffTables,
    pub exit: &'a Exit,
    /// Target of the relative standard error of the sum.
    pub accuracy: f32,
    /// Factor on that target.
    pub correction: &'a CutCorrection,
    pub scratch: &'a mut Scratch,
}

/// The criterion by which nodes are opened.
#[derive(Clone, Copy)]
enum Criterion {
    /// Opens nodes that the exitant point sees under a wide angle.
    Wide,
    /// Opens nodes whose error exceeds this.
    Above(f32),
}

/// Root mean square deviation of the directions of diffuse light, `√(5/9)`, for which the tables hold the scatter.
const DIFFUSE_DEVIATION: f32 = 0.745_356;

/// A node is seen under a wide angle if this times its squared radius exceeds the squared distance of its center.
const WIDE: f32 = 0.5;

/// The first threshold is this, times the target error to the power 3/2, times a rough estimate of the sum.
const START: f32 = 0.7;

/// The predicted error may exceed the target by this factor.
const GOOD_ENOUGH: f32 = 1.2;

/// A node whose error exceeds the threshold by this factor is opened by two levels at once, and by its square by three.
/// From 2.8 to 6 the sums cost the same.
const LEVEL: f32 = 4.0;

/// The cut of a large tree begins with so many nodes in place of the root: they are predicted in the time of one.
const FIRST_NODES: u32 = LANES as u32;

/// Each of the first nodes has so many leaves at least.
const LEAVES_OF_FIRST: u32 = 64;

/// The largest number of times that the threshold is lowered.
const ROUNDS: usize = 6;

impl<M: LaneModel> Kernel for Cut<'_, M> {
    type Output = Sum;

    #[inline(always)]
    fn run(mut self) -> Sum {
        let mut sum = Accumulator::new();
        let (nodes, predicted) = self.choose(&mut sum);
        self.pick();
        let open = (self.scratch.open.len() * TILE) as u64;
        let evaluations = open + self.add_closed(&mut sum);
        Sum { radiance: sum.total(), evaluations, nodes, predicted }
    }
}

impl<M: LaneModel> Cut<'_, M> {
    /// Finds the cut and adds the samples of its open leaves; returns the number of visited nodes and the predicted
    /// sum.
    #[inline(always)]
    fn choose(&mut self, sum: &mut Accumulator) -> (u64, f64) {
        self.scratch.closed.clear();
        self.scratch.open.clear();
        let first = (Leaves::of(self.samples).first / LEAVES_OF_FIRST).clamp(1, FIRST_NODES);
        self.scratch.frontier.extend(first..2 * first);
        let mut visited = self.sweep(Criterion::Wide);
        let mut added = self.add_open(0, sum);
        let scale = self.samples.scale;
        let unit = 1.0 / f64::from(scale);
        let besides = self.exit.besides * scale;
        let rough = self.scratch.closed.iter().fold(of_open(sum, scale), |sum, c| sum + c.max_value);
        let target = self.accuracy * self.correction.factor(f64::from(rough) * unit);
        // A threshold below 0 would open empty nodes. The sum is below 0 only if the file is changed while it is read.
        let rough = besides + if rough < 0.0 { 0.0 } else { rough };
        let mut threshold = START * target * target.sqrt() * rough;
        let mut predicted = 0.0;
        for _ in 0..ROUNDS {
            self.reopen(threshold);
            visited += self.sweep(Criterion::Above(threshold));
            added = self.add_open(added, sum);
            let start = (of_open(sum, scale), 0.0);
            let (total, variance) =
                self.scratch.closed.iter().fold(start, |(t, v), c| (t + c.value, v + c.error * c.error));
            predicted = f64::from(total) * unit;
            let excess = variance.sqrt() / (self.accuracy * self.correction.factor(predicted) * (total + besides));
            // The excess is not a number if nothing contributes.
            if excess <= GOOD_ENOUGH || excess.is_nan() {
                break;
            }
            // The error falls as the threshold to the power 2/3.
            let bounded = excess.min(10.0);
            threshold /= bounded * bounded.sqrt();
        }
        (visited, predicted)
    }

    /// Replaces closed nodes above the threshold by their children, which go to the frontier.
    #[inline(always)]
    fn reopen(&mut self, threshold: f32) {
        let leaves = Leaves::of(self.samples);
        let Scratch { frontier, closed, open, .. } = &mut *self.scratch;
        closed.retain(|node| {
            if node.error > threshold {
                leaves.expand(node.id, levels(node.error, threshold), frontier, open);
                return false;
            }
            true
        });
    }

    /// Opens nodes of the frontier until each is closed or is an open leaf; returns the number of visited nodes.
    #[inline(always)]
    fn sweep(&mut self, criterion: Criterion) -> u64 {
        let (leaves, scale) = (Leaves::of(self.samples), self.samples.scale);
        let nodes = self.samples.nodes;
        let Scratch { frontier, closed, open, .. } = &mut *self.scratch;
        let mut visited = 0;
        while !frontier.is_empty() {
            let count = frontier.len().min(LANES);
            let mut ids = [0; LANES];
            ids[..count].copy_from_slice(&frontier[frontier.len() - count..]);
            frontier.truncate(frontier.len() - count);
            visited += count as u64;
            let predicted = predict(self.tables, self.exit, nodes, scale, &ids);
            for i in 0..count {
                let (error, value, max_value) = (predicted.error[i], predicted.value[i], predicted.max_value[i]);
                let node = Closed { id: ids[i], error, value, max_value };
                let opens = match criterion {
                    Criterion::Wide => u32::from(predicted.wide[i]),
                    Criterion::Above(threshold) => levels(error, threshold),
                };
                if opens > 0 {
                    leaves.expand(node.id, opens, frontier, open);
                } else if nodes.get(ids[i] as usize).is_some_and(|n| n.flux > 0.0) {
                    closed.push(node);
                }
            }
        }
        visited
    }

    /// Picks one sample of each closed node.
    #[inline(always)]
    fn pick(&mut self) {
        let first_leaf = first_leaf(self.samples.tiles.len() as u64);
        let Scratch { closed, picks, .. } = &mut *self.scratch;
        picks.clear();
        for node in closed.iter() {
            let depth = first_leaf.ilog2() - node.id.ilog2();
            let first = ((u64::from(node.id) << depth) - first_leaf) * TILE as u64;
            let end = (((u64::from(node.id) + 1) << depth) - first_leaf) * TILE as u64;
            // A node beyond the last sample has no flux and is dropped; only in a forged file can it have flux and be
            // closed.
            let Some(count) = end.min(self.samples.len() as u64).checked_sub(first).filter(|count| *count > 0) else {
                continue;
            };
            let index = (first + ((u64::from(place(node.id, self.exit.key)) * count) >> 32)) as u32;
            self.samples.prefetch(index);
            picks.push((index, count as f32));
        }
    }

    /// Adds the picked samples, each weighted by the number of samples of its node; returns how many there are.
    #[inline(always)]
    fn add_closed(&self, sum: &mut Accumulator) -> u64 {
        let mut indices = [0; LANES];
        for part in self.scratch.picks.chunks(LANES) {
            // Unused lanes repeat some sample with weight 0.
            let mut weights = [0.0; LANES];
            for (i, (index, weight)) in part.iter().enumerate() {
                indices[i] = *index;
                weights[i] = *weight;
            }
            let (block, flux) = self.samples.pick(&indices, self.exit);
            sum.add(&self.model.bare(&block, self.exit.normal), &flux, &weights);
        }
        self.scratch.picks.len() as u64
    }

    /// Adds the samples of all open leaves but the first `added`; returns the number of open leaves.
    #[inline(always)]
    fn add_open(&self, added: usize, sum: &mut Accumulator) -> usize {
        for tile in &self.scratch.open[added..] {
            let (block, flux) = self.samples.block(*tile as usize, self.exit);
            sum.add(&self.model.bare(&block, self.exit.normal), &flux, &[1.0; LANES]);
        }
        self.scratch.open.len()
    }
}

/// The contribution of the open leaves, summed over channels, times the scale. It does not depend on picked samples.
#[inline(always)]
fn of_open(sum: &Accumulator, scale: f32) -> f32 {
    (sum.total().element_sum() * f64::from(scale)) as f32
}

/// The place, in the order of a node's samples, of the one that is picked: a fraction in units of 2⁻³². Siblings pick
/// opposite places.
#[inline(always)]
fn place(id: u32, key: u64) -> u32 {
    let of_pair = random_bits(id >> 1, key);
    if id.is_multiple_of(2) { of_pair } else { !of_pair }
}

/// The number of levels by which a node is opened, 0 if it stays closed. A child has half of the flux of its parent, over
/// less of its extent, and so about a third of its error: below a node far above the threshold all are opened.
#[inline(always)]
fn levels(error: f32, threshold: f32) -> u32 {
    u32::from(error > threshold) + u32::from(error > LEVEL * threshold) + u32::from(error > LEVEL * LEVEL * threshold)
}

/// The leaves of the tree.
#[derive(Clone, Copy)]
struct Leaves {
    /// The node that is the first leaf.
    first: u32,
    /// The number of leaves that have a tile.
    tiles: u32,
}

impl Leaves {
    #[inline(always)]
    fn of(samples: &LitSamples) -> Leaves {
        let tiles = samples.tiles.len();
        Leaves { first: first_leaf(tiles as u64) as u32, tiles: tiles as u32 }
    }

    /// Adds the nodes that lie `levels` below a node, or the leaves below it, to the frontier, or a leaf to the open
    /// ones.
    #[inline(always)]
    fn expand(self, id: u32, levels: u32, frontier: &mut Vec<u32>, open: &mut Vec<u32>) {
        if id < self.first {
            let levels = levels.min(self.first.ilog2() - id.ilog2());
            let first = id << levels;
            frontier.extend(first..first + (1 << levels));
        } else if id - self.first < self.tiles {
            open.push(id - self.first);
        }
    }
}

/// The predictions for sixteen nodes if they are closed; see [`Closed`].
#[derive(Default)]
struct Predicted {
    error: Lane,
    value: Lane,
    max_value: Lane,
    /// Whether the exitant point sees them under a wide angle.
    wide: [bool; LANES],
}

/// Visits sixteen nodes.
#[inline(always)]
fn predict(tables: &FalloffTables, exit: &Exit, nodes: &[Node], scale: f32, ids: &[u32; LANES]) -> Predicted {
    let mut offset = [[0.0; LANES]; 3];
    let mut rest = [[0.0; LANES]; 5];
    for i in 0..LANES {
        // Nodes beyond the end of the tree are empty.
        let node = nodes.get(ids[i] as usize).copied().unwrap_or_default();
        let o = exit.offset(node.center);
        for c in 0..3 {
            offset[c][i] = o[c];
        }
        rest[0][i] = node.spread;
        rest[1][i] = node.radius;
        rest[2][i] = node.flux * scale;
        rest[3][i] = node.flux_deviation;
        rest[4][i] = node.direction_deviation;
    }
    let [spread, radius, flux, flux_deviation, direction_deviation] = rest;
    let mut predicted = Predicted::default();
    for i in 0..LANES {
        let far2 = offset[0][i] * offset[0][i] + offset[1][i] * offset[1][i] + offset[2][i] * offset[2][i];
        let near = (far2.sqrt() - radius[i]).max(0.0);
        let near2 = near * near;
        let by_position = tables.slope.at(near2) * spread[i];
        let by_direction = tables.scatter.at(near2) * direction_deviation[i] * (1.0 / DIFFUSE_DEVIATION);
        // The squared radius of a disc is twice the mean squared distance from its center.
        let disc2 = 2.0 * spread[i] * spread[i];
        let value = if far2 > disc2 { tables.value.at(far2) } else { tables.disc.at(disc2) };
        // The mean of an exponential over a node is close to the geometric mean of its values at the center and at the
        // near end.
        let near_value = (value * tables.peak.at(near2)).sqrt();
        let by_flux = value * flux_deviation[i];
        predicted.error[i] =
            flux[i] * (by_position * by_position + by_direction * by_direction + by_flux * by_flux).sqrt();
        predicted.value[i] = flux[i] * value;
        predicted.max_value[i] = flux[i] * if far2 > disc2 { near_value } else { value };
        predicted.wide[i] = WIDE * radius[i] * radius[i] > far2;
    }
    predicted
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Every node's place is uniform, that of its sibling is opposite, and that of other nodes is independent. The
    /// products of 40,000 pairs of places from −1/2 to 1/2, of variance 1/144 each, have a mean within 5 standard
    /// deviations, and so has the place over the root of 12.
    ///
    /// Seen to catch: places of siblings that are equal, and that are independent; one place for four nodes.
    #[test]
    fn siblings_pick_opposite_places() {
        let centered = |id: u32, key: u64| f64::from(place(id, key)) / 2f64.powi(32) - 0.5;
        for id in [2, 6, 1 << 20] {
            let moments = (0..40_000u64).fold([0.0; 4], |sum, key| {
                let key = key.wrapping_mul(0x9E37_79B9_7F4A_7C15);
                assert_eq!(place(id, key), !place(id + 1, key));
                let [own, next, child] = [id, id + 2, 2 * id].map(|id| centered(id, key));
                [sum[0] + own, sum[1] + own * own, sum[2] + own * next, sum[3] + own * child]
            });
            let [mean, square, next, child] = moments.map(|m| m / 4e4);
            let known = [mean / 12f64.sqrt(), square - 1.0 / 12.0, next, child];
            assert!(known.iter().all(|m| m.abs() < 5.0 / 12.0 / 200.0), "{id}: {known:?}");
        }
    }

    /// A node is opened by the levels that it exceeds the threshold for, but not beyond the leaves.
    ///
    /// Seen to catch: levels that are not limited, which take nodes of another tree's depth for leaves.
    #[test]
    fn nodes_far_above_the_threshold_are_opened_by_several_levels() {
        assert_eq!([0.5, 1.0, 1.5, 4.5, 17.0].map(|error| levels(error, 1.0)), [0, 0, 1, 2, 3]);
        let leaves = Leaves { first: 8, tiles: 6 };
        let opened = |id, levels| {
            let (mut frontier, mut open) = (Vec::new(), Vec::new());
            leaves.expand(id, levels, &mut frontier, &mut open);
            (frontier, open)
        };
        assert_eq!(opened(1, 2), (vec![4, 5, 6, 7], vec![]));
        assert_eq!(opened(3, 3), (vec![12, 13, 14, 15], vec![]));
        assert_eq!(opened(9, 3), (vec![], vec![1]));
        assert_eq!(opened(15, 1), (vec![], vec![]));
    }
}

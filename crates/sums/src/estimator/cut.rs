//! The hierarchical sum: a cut through the tree over the samples.
//!
//! A closed node contributes one of its `n` samples, picked uniformly, `n` times; an open leaf all of its samples. That
//! is unbiased for every choice of the cut that does not look at what is picked. A node is opened while the standard
//! deviation that it would add, by the tables of [`FalloffTables`], exceeds a threshold that is the same for all nodes: for a
//! given sum of variances this takes the fewest nodes. The threshold follows from the wanted error and from an estimate of
//! the sum itself, what open leaves contribute and what the tables say of closed nodes, and is lowered until the cut is
//! good enough.

use super::{Accumulator, Calibration, FalloffTables, Sum, random_bits};
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
    /// Standard deviation that it adds, and what it contributes: sums over channels, W/(m² sr) times
    /// [`LitSamples::scale`].
    error: f32,
    value: f32,
    /// What it contributes if its near end counts most.
    most: f32,
}

/// Lists that are kept from gather to gather for their memory.
#[derive(Clone, Debug, Default)]
pub struct Scratch {
    frontier: Vec<u32>,
    closed: Vec<Closed>,
    /// Open leaves: places of their tiles.
    open: Vec<u32>,
    /// The samples of the closed nodes, and how many each stands for.
    picks: Vec<(u32, f32)>,
}

/// Evaluates a cut.
pub struct Cut<'a, M> {
    pub model: &'a M,
    pub samples: &'a LitSamples<'a>,
    pub tables: &'a FalloffTables,
    pub exit: &'a Exit,
    /// Wanted standard error of the sum, relative.
    pub accuracy: f32,
    /// What that is multiplied by.
    pub calibration: &'a Calibration,
    pub scratch: &'a mut Scratch,
}

/// When a node is opened.
#[derive(Clone, Copy)]
enum Criterion {
    /// It is seen under a wide angle.
    Wide,
    /// Its error exceeds this.
    Above(f32),
}

/// Root mean square deviation of the directions of diffuse light, for which the tables' scatter was computed: `√(5/9)`.
const DIFFUSE_TURN: f32 = 0.745_356;

/// A node is seen under a wide angle if its squared radius is over this share of the squared distance.
const WIDE: f32 = 0.5;

/// The threshold is at first this, times the wanted error to the power 3/2, times a rough estimate of the sum.
const START: f32 = 0.7;

/// The predicted error may exceed the wanted one by this.
const GOOD_ENOUGH: f32 = 1.2;

/// Rounds of lowering the threshold.
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
    /// Finds the cut, and adds the samples of its open leaves; returns how many nodes were looked at, and the sum that it
    /// predicts.
    #[inline(always)]
    fn choose(&mut self, sum: &mut Accumulator) -> (u64, f64) {
        self.scratch.closed.clear();
        self.scratch.open.clear();
        self.scratch.frontier.push(1);
        let mut visited = self.sweep(Criterion::Wide);
        let mut added = self.add_open(0, sum);
        let scale = self.samples.scale();
        let unit = 1.0 / f64::from(scale);
        let rough = self.scratch.closed.iter().fold(of_open(sum, scale), |sum, c| sum + c.most);
        let guess = self.accuracy * self.calibration.factor(f64::from(rough) * unit);
        // Below 0 it would open what is empty. It cannot be, unless the samples were changed while they are read.
        let rough = if rough < 0.0 { 0.0 } else { rough };
        let mut threshold = START * guess * guess.sqrt() * rough;
        let mut predicted = 0.0;
        for _ in 0..ROUNDS {
            self.reopen(threshold);
            visited += self.sweep(Criterion::Above(threshold));
            added = self.add_open(added, sum);
            let start = (of_open(sum, scale), 0.0);
            let (total, variance) =
                self.scratch.closed.iter().fold(start, |(t, v), c| (t + c.value, v + c.error * c.error));
            predicted = f64::from(total) * unit;
            let excess = variance.sqrt() / (self.accuracy * self.calibration.factor(predicted) * total);
            // Not a number if nothing contributes.
            if excess <= GOOD_ENOUGH || excess.is_nan() {
                break;
            }
            // The error falls with the threshold to the power 2/3.
            let bounded = excess.min(10.0);
            threshold /= bounded * bounded.sqrt();
        }
        (visited, predicted)
    }

    /// Moves closed nodes above the threshold back to the frontier, as their children.
    #[inline(always)]
    fn reopen(&mut self, threshold: f32) {
        let leaves = Leaves::of(self.samples);
        let Scratch { frontier, closed, open, .. } = &mut *self.scratch;
        closed.retain(|node| {
            if node.error > threshold {
                leaves.expand(node.id, frontier, open);
                return false;
            }
            true
        });
    }

    /// Takes the frontier down until every node is closed or an open leaf.
    #[inline(always)]
    fn sweep(&mut self, criterion: Criterion) -> u64 {
        let (leaves, scale) = (Leaves::of(self.samples), self.samples.scale());
        let nodes = self.samples.nodes();
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
                let (error, value, most) = (predicted.error[i], predicted.value[i], predicted.most[i]);
                let node = Closed { id: ids[i], error, value, most };
                let opens = match criterion {
                    Criterion::Wide => predicted.wide[i],
                    Criterion::Above(threshold) => node.error > threshold,
                };
                if opens {
                    leaves.expand(node.id, frontier, open);
                } else if nodes.get(ids[i] as usize).is_some_and(|n| n.flux > 0.0) {
                    closed.push(node);
                }
            }
        }
        visited
    }

    /// Picks a sample for each closed node.
    #[inline(always)]
    fn pick(&mut self) {
        let first_leaf = first_leaf(self.samples.tiles().len() as u64);
        let Scratch { closed, picks, .. } = &mut *self.scratch;
        picks.clear();
        for node in closed.iter() {
            let depth = first_leaf.ilog2() - node.id.ilog2();
            let first = ((u64::from(node.id) << depth) - first_leaf) * TILE as u64;
            let end = (((u64::from(node.id) + 1) << depth) - first_leaf) * TILE as u64;
            // A node beyond the last sample has no flux, unless the file was forged.
            let Some(count) = end.min(self.samples.len() as u64).checked_sub(first).filter(|count| *count > 0) else {
                continue;
            };
            let xi = u64::from(random_bits(node.id, self.exit.key));
            let index = (first + ((xi * count) >> 32)) as u32;
            self.samples.prefetch(index);
            picks.push((index, count as f32));
        }
    }

    /// One sample for each closed node.
    #[inline(always)]
    fn add_closed(&self, sum: &mut Accumulator) -> u64 {
        let mut indices = [0; LANES];
        for part in self.scratch.picks.chunks(LANES) {
            // Lanes left free repeat some sample with weight 0.
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

    /// All samples of open leaves but the first, that were added before; returns how many there are.
    #[inline(always)]
    fn add_open(&self, added: usize, sum: &mut Accumulator) -> usize {
        for tile in &self.scratch.open[added..] {
            let (block, flux) = self.samples.block(*tile as usize, self.exit);
            sum.add(&self.model.bare(&block, self.exit.normal), &flux, &[1.0; LANES]);
        }
        self.scratch.open.len()
    }
}

/// What open leaves contribute, the sum over channels, times the scale. It depends on nothing that was picked.
#[inline(always)]
fn of_open(sum: &Accumulator, scale: f32) -> f32 {
    (sum.total().element_sum() * f64::from(scale)) as f32
}

/// Where the leaves are in the tree.
#[derive(Clone, Copy)]
struct Leaves {
    first: u32,
    /// Those that have a tile.
    tiles: u32,
}

impl Leaves {
    #[inline(always)]
    fn of(samples: &LitSamples) -> Leaves {
        let tiles = samples.tiles().len();
        Leaves { first: first_leaf(tiles as u64) as u32, tiles: tiles as u32 }
    }

    /// Replaces a node by its children, or a leaf by its samples.
    #[inline(always)]
    fn expand(self, id: u32, frontier: &mut Vec<u32>, open: &mut Vec<u32>) {
        if id < self.first {
            frontier.extend([2 * id, 2 * id + 1]);
        } else if id - self.first < self.tiles {
            open.push(id - self.first);
        }
    }
}

/// What sixteen nodes do if they are closed, see [`Closed`].
#[derive(Default)]
struct Predicted {
    error: Lane,
    value: Lane,
    most: Lane,
    /// Whether they are seen under a wide angle.
    wide: [bool; LANES],
}

/// Looks at sixteen nodes.
#[inline(always)]
fn predict(tables: &FalloffTables, exit: &Exit, nodes: &[Node], scale: f32, ids: &[u32; LANES]) -> Predicted {
    let mut offset = [[0.0; LANES]; 3];
    let mut rest = [[0.0; LANES]; 5];
    for i in 0..LANES {
        // Beyond the last leaf there is nothing.
        let node = nodes.get(ids[i] as usize).copied().unwrap_or_default();
        let o = exit.offset(node.centre);
        for c in 0..3 {
            offset[c][i] = o[c];
        }
        rest[0][i] = node.spread;
        rest[1][i] = node.radius;
        rest[2][i] = node.flux * scale;
        rest[3][i] = node.flux_deviation;
        rest[4][i] = node.turn;
    }
    let [spread, radius, flux, deviation, turn] = rest;
    let mut predicted = Predicted::default();
    for i in 0..LANES {
        let far2 = offset[0][i] * offset[0][i] + offset[1][i] * offset[1][i] + offset[2][i] * offset[2][i];
        let near = (far2.sqrt() - radius[i]).max(0.0);
        let near2 = near * near;
        let by_place = tables.slope(near2) * spread[i];
        let by_light = tables.scatter(near2) * turn[i] * (1.0 / DIFFUSE_TURN);
        // Of a disc the squared radius is twice the mean squared distance from its middle.
        let disc2 = 2.0 * spread[i] * spread[i];
        // The mean of a decay over a node lies near the geometric mean of those to its middle and its near end.
        let here = if far2 > disc2 { tables.value(far2) } else { tables.disc(disc2) };
        let beside = (here * tables.value(near2)).sqrt();
        let by_flux = here * deviation[i];
        predicted.error[i] = flux[i] * (by_place * by_place + by_light * by_light + by_flux * by_flux).sqrt();
        predicted.value[i] = flux[i] * here;
        predicted.most[i] = flux[i] * if far2 > disc2 { beside } else { here };
        predicted.wide[i] = WIDE * radius[i] * radius[i] > far2;
    }
    predicted
}

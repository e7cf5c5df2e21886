//! The choice of one light, in a time that does not depend on the number of lights with bounds. Distant lights are
//! weighed one by one.
//!
//! Nearby points share one list: lights with their importance at the center of the points, and nodes of the tree
//! instead of lights of little importance. A few candidates are drawn from the list, and one of them is chosen by its
//! importance at the point itself. Near and distant lights are weighed anew at every point. Every light that can reach
//! a point has a chance there.

use super::{
    bounds::ReceiverBounds,
    contract::Light,
    hierarchical_sampler::split,
    tree::{Kind, LightTree},
};
use crate::{mesh::SurfacePoint, random::BELOW_ONE};
use std::collections::BinaryHeap;

/// The number of lights, at most, that are weighed at every point because they are near.
const MAX_NEAR: usize = 16;

/// The number of candidates that are drawn from the list.
const CANDIDATES: usize = 4;

/// Lights to choose from at the points of a receiver.
pub struct LightChoice<'t, 'a> {
    tree: &'t LightTree<'a>,
    /// Indices of the lights that are weighed at each point.
    single: Vec<u32>,
    /// Nodes of the tree, each with the sum of the importance of it and all before it.
    shared: Vec<(u32, f64)>,
    /// How many nodes and lights were weighed for the list.
    pub weighed: u64,
}

/// A light that was chosen.
#[derive(Clone, Copy)]
pub struct Pick<'a> {
    /// Its index in the list that the tree was made of.
    pub index: usize,
    pub light: &'a dyn Light,
    /// Divisor of its irradiance with which it represents all lights: the probability of its choice or, where
    /// candidates were compared, an estimate of that probability that keeps the mean.
    pub share: f64,
}

impl<'t, 'a> LightChoice<'t, 'a> {
    /// Lights for the points of a receiver, in a list of `max_nodes` nodes or fewer.
    pub fn new(tree: &'t LightTree<'a>, receiver: &ReceiverBounds, max_nodes: usize) -> Self {
        let mut choice = LightChoice { tree, single: tree.single.clone(), shared: Vec::new(), weighed: 0 };
        if tree.is_flat() {
            return choice;
        }
        let nodes = if tree.leaves.len() <= max_nodes {
            tree.leaves.iter().map(|node| (*node, choice.weigh(*node, receiver))).collect()
        } else {
            choice.open(receiver, max_nodes)
        };
        let mut total = 0.0;
        for (node, importance) in nodes {
            match tree.kind(node) {
                Kind::Leaf(light) if choice.single.len() < MAX_NEAR && tree.is_near(node, receiver) => {
                    choice.single.push(light);
                }
                _ if importance > 0.0 => {
                    total += importance;
                    choice.shared.push((node, total));
                }
                _ => {}
            }
        }
        choice
    }

    fn weigh(&mut self, node: u32, receiver: &ReceiverBounds) -> f64 {
        self.weighed += 1;
        self.tree.importance(node, receiver)
    }

    /// Nodes that hold all lights: the most important one is opened until there are `max_nodes`.
    fn open(&mut self, receiver: &ReceiverBounds, max_nodes: usize) -> Vec<(u32, f64)> {
        let (mut closed, mut open) = (Vec::new(), BinaryHeap::new());
        // The bits of floating-point numbers that are not negative are in the order of the numbers.
        open.push((self.weigh(0, receiver).to_bits(), 0));
        while closed.len() + open.len() < max_nodes
            && let Some((bits, node)) = open.pop()
        {
            match self.tree.kind(node) {
                Kind::Leaf(_) => closed.push((node, f64::from_bits(bits))),
                Kind::Inner(children) => {
                    open.extend(children.map(|child| (self.weigh(child, receiver).to_bits(), child)));
                }
            }
        }
        closed.extend(open.into_iter().map(|(bits, node)| (node, f64::from_bits(bits))));
        closed.sort_unstable_by_key(|(node, _)| *node);
        closed
    }

    /// Picks a light, nearly in proportion to its share of the irradiance at the point; none if no light that the
    /// uniform number `xi` leads to reaches the point.
    pub fn pick(&self, at: &SurfacePoint, mut xi: f64) -> Option<Pick<'a>> {
        let importance = |k: &u32| self.tree.lights[*k as usize].importance(at);
        let single: f64 = self.single.iter().map(importance).sum();
        let shared = self.shared.last().map_or(0.0, |(_, total)| *total);
        let total = single + shared;
        if total.is_nan() || total <= 0.0 {
            return None;
        }
        let mut probability = 1.0;
        if shared > 0.0 && split(&mut xi, single, shared, &mut probability) {
            return self.resample(at, xi, probability);
        }
        let weights = self.single.iter().map(|index| (*index, importance(index)));
        let (index, own) = choose(weights, xi * single)?;
        Some(self.picked(index, probability * (own / single)))
    }

    fn picked(&self, light: u32, share: f64) -> Pick<'a> {
        let index = light as usize;
        Pick { index, light: self.tree.lights[index], share }
    }

    /// Picks one light of the shared list: candidates are drawn by their importance at the center of the receiver, and
    /// one of them is chosen by its importance at the point (resampled importance sampling, Talbot et al. 2005).
    fn resample(&self, at: &SurfacePoint, xi: f64, probability: f64) -> Option<Pick<'a>> {
        let count = CANDIDATES as f64;
        let (mut low, mut high) = (0.0f64, 1.0f64);
        let candidates: [(u32, f64, f64); CANDIDATES] = std::array::from_fn(|k| {
            let drawn = self.draw(at, (k as f64 + xi) / count);
            // All numbers between `low` and `high` draw the same candidates.
            low = low.max(xi - drawn.xi * drawn.probability * count);
            high = high.min(xi + (1.0 - drawn.xi) * drawn.probability * count);
            let importance = if drawn.dark { 0.0 } else { self.tree.lights[drawn.light as usize].importance(at) };
            (drawn.light, importance, importance / drawn.probability)
        });
        let total: f64 = candidates.iter().map(|(_, _, ratio)| ratio).sum();
        if total.is_nan() || total <= 0.0 {
            return None;
        }
        // Given the candidates, the number is uniform between `low` and `high`: it is used again to choose among them.
        let target = ((xi - low) / (high - low)).clamp(0.0, 1.0) * total;
        let weights = candidates.into_iter().map(|(light, importance, ratio)| ((light, importance), ratio));
        let ((light, importance), _) = choose(weights, target)?;
        Some(self.picked(light, probability * importance * count / total))
    }

    /// Draws a node of the shared list, and one light below it.
    fn draw(&self, at: &SurfacePoint, xi: f64) -> Draw {
        let total = self.shared.last().map_or(0.0, |(_, total)| *total);
        let target = xi * total;
        let index = self.shared.partition_point(|(_, so_far)| *so_far <= target).min(self.shared.len() - 1);
        let before = if index == 0 { 0.0 } else { self.shared[index - 1].1 };
        let (mut node, so_far) = self.shared[index];
        let own = so_far - before;
        let (mut xi, mut probability) = (((target - before) / own).clamp(0.0, BELOW_ONE), own / total);
        loop {
            match self.tree.kind(node) {
                Kind::Leaf(light) => return Draw { light, dark: false, probability, xi },
                Kind::Inner(children) => {
                    let here = ReceiverBounds::point(at);
                    let [a, b] = children.map(|child| self.tree.importance(child, &here));
                    if a + b <= 0.0 {
                        return Draw { light: 0, dark: true, probability, xi };
                    }
                    node = children[usize::from(split(&mut xi, a, b, &mut probability))];
                }
            }
        }
    }
}

/// The item in whose part of the sum of all weights `left` lies, with its weight. Rounding may leave the last one of
/// positive weight.
fn choose<T>(weighted: impl Iterator<Item = (T, f64)>, mut left: f64) -> Option<(T, f64)> {
    let mut chosen = None;
    for (item, weight) in weighted.filter(|(_, weight)| *weight > 0.0) {
        chosen = Some((item, weight));
        if left < weight {
            break;
        }
        left -= weight;
    }
    chosen
}

/// A light that was drawn from the list.
struct Draw {
    light: u32,
    /// No light below the node reaches the point.
    dark: bool,
    probability: f64,
    /// The uniform number again, within the share of what was drawn, in [0, 1).
    xi: f64,
}

//! The choice of one light, in time that does not depend on the number of those that are somewhere; directional lights are
//! weighed one by one.
//!
//! Points that lie together share one list of lights with what each sends to their middle, and of nodes of the tree for
//! those that send little. A few are drawn from it, and one of them is chosen by what it sends to the point itself. Lights
//! that are near or infinitely far are weighed anew at every point. Every light that can reach a point has a chance there.

use super::{
    Light,
    hierarchical_sampler::split,
    receiver::ReceiverBounds,
    tree::{Kind, LightTree},
};
use crate::{mesh::SurfacePoint, random::BELOW_ONE};
use std::collections::BinaryHeap;

/// Lights that are weighed at every point because they are near, at most.
const MAX_NEAR: usize = 16;

/// Lights that are drawn from the list to choose one of.
const CANDIDATES: usize = 4;

/// Lights to choose from at the points of a region.
pub struct LightChoice<'t, 'a> {
    tree: &'t LightTree<'a>,
    /// Lights that are weighed at each point.
    single: Vec<u32>,
    /// Nodes of the tree, each with the importance of it and of all before it.
    shared: Vec<(u32, f64)>,
    /// Nodes and lights that were weighed for the list.
    pub weighed: u64,
}

/// A light that was chosen.
#[derive(Clone, Copy)]
pub struct Pick<'a> {
    /// Its number in the list that the tree was made of.
    pub index: usize,
    pub light: &'a dyn Light,
    /// What its light is divided by to stand for all: the probability of its choice, or where candidates were compared,
    /// an estimate of it that leaves the mean as it is.
    pub share: f64,
}

impl<'t, 'a> LightChoice<'t, 'a> {
    /// Lights for the points of a region; the list has `most` entries at most.
    pub fn new(tree: &'t LightTree<'a>, region: &ReceiverBounds, most: usize) -> Self {
        let mut choice = LightChoice { tree, single: tree.single.clone(), shared: Vec::new(), weighed: 0 };
        if tree.is_flat() {
            return choice;
        }
        let nodes = if tree.leaves().len() <= most {
            tree.leaves().iter().map(|node| (*node, choice.weigh(*node, region))).collect()
        } else {
            choice.open(region, most)
        };
        let mut total = 0.0;
        for (node, importance) in nodes {
            match tree.kind(node) {
                Kind::Leaf(light) if choice.single.len() < MAX_NEAR && tree.is_near(node, region) => {
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

    fn weigh(&mut self, node: u32, region: &ReceiverBounds) -> f64 {
        self.weighed += 1;
        self.tree.importance(node, region)
    }

    /// Nodes that hold all lights: the most important is opened until there are `most`.
    fn open(&mut self, region: &ReceiverBounds, most: usize) -> Vec<(u32, f64)> {
        let (mut closed, mut open) = (Vec::new(), BinaryHeap::new());
        // Numbers that are not negative are in the order of their bits.
        open.push((self.weigh(0, region).to_bits(), 0));
        while closed.len() + open.len() < most
            && let Some((bits, node)) = open.pop()
        {
            match self.tree.kind(node) {
                Kind::Leaf(_) => closed.push((node, f64::from_bits(bits))),
                Kind::Inner(children) => {
                    open.extend(children.map(|child| (self.weigh(child, region).to_bits(), child)));
                }
            }
        }
        closed.extend(open.into_iter().map(|(bits, node)| (node, f64::from_bits(bits))));
        closed.sort_unstable_by_key(|(node, _)| *node);
        closed
    }

    /// A light, chosen nearly by its share of the light that arrives; none if no light that the uniform number `xi` leads to
    /// reaches the point.
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
        let mut left = xi * single;
        let mut last = None;
        for index in &self.single {
            let own = importance(index);
            if own > 0.0 {
                last = Some(self.picked(*index, probability * (own / single)));
                if left < own {
                    break;
                }
                left -= own;
            }
        }
        last
    }

    fn picked(&self, light: u32, share: f64) -> Pick<'a> {
        let index = light as usize;
        Pick { index, light: &*self.tree.lights[index], share }
    }

    /// One light of the shared list: of a few that are drawn by what they send to the middle, one by what it sends to the
    /// point (resampled importance sampling, Talbot et al. 2005).
    fn resample(&self, at: &SurfacePoint, xi: f64, probability: f64) -> Option<Pick<'a>> {
        let count = CANDIDATES as f64;
        let (mut low, mut high) = (0.0f64, 1.0f64);
        let candidates: [(u32, f64, f64); CANDIDATES] = std::array::from_fn(|k| {
            let drawn = self.draw(at, (k as f64 + xi) / count);
            // All numbers between these draw this light.
            low = low.max(xi - drawn.xi * drawn.probability * count);
            high = high.min(xi + (1.0 - drawn.xi) * drawn.probability * count);
            let importance = if drawn.dark { 0.0 } else { self.tree.lights[drawn.light as usize].importance(at) };
            (drawn.light, importance, importance / drawn.probability)
        });
        let total: f64 = candidates.iter().map(|(_, _, ratio)| ratio).sum();
        if total.is_nan() || total <= 0.0 {
            return None;
        }
        // What the candidates left of the number is uniform between those that draw the same ones.
        let mut left = ((xi - low) / (high - low)).clamp(0.0, 1.0) * total;
        let mut last = None;
        for (light, importance, ratio) in candidates {
            if ratio > 0.0 {
                last = Some(self.picked(light, probability * importance * count / total));
                if left < ratio {
                    break;
                }
                left -= ratio;
            }
        }
        last
    }

    /// A node of the shared list, and one light below it.
    fn draw(&self, at: &SurfacePoint, number: f64) -> Draw {
        let total = self.shared.last().map_or(0.0, |(_, total)| *total);
        let target = number * total;
        let place = self.shared.partition_point(|(_, so_far)| *so_far <= target).min(self.shared.len() - 1);
        let before = if place == 0 { 0.0 } else { self.shared[place - 1].1 };
        let (mut node, so_far) = self.shared[place];
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

/// A light that is drawn from the list.
struct Draw {
    light: u32,
    /// No light below the node that was drawn reaches the point.
    dark: bool,
    probability: f64,
    /// Where in the share of what was drawn the number lay, in [0, 1).
    xi: f64,
}

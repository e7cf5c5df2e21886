//! The tree of boxes, eight to a node, and the walk through it.

use super::{node::Node, ray::BoxRay, vectors::Vectors};
use std::ops::ControlFlow;

pub(super) struct Tree {
    /// The root first; empty for a mesh without triangles.
    pub nodes: Vec<Node>,
}

/// The action of a walk at the leaves.
pub(super) trait Visitor {
    /// Whether nearer children are visited first. Where any hit will do, the order costs more than it saves.
    const ORDERED: bool;

    /// Looks at a leaf that the ray may meet and returns the limit from now on, or ends the walk.
    fn visit(&mut self, leaf: u32) -> ControlFlow<(), f32>;
}

impl Tree {
    /// Shows the visitor every leaf whose box the ray meets within the limit, which the visitor may lower.
    #[inline(always)]
    pub fn walk<V: Visitor>(
        &self,
        vectors: impl Vectors,
        ray: &BoxRay,
        mut limit: f32,
        visitor: &mut V,
    ) -> ControlFlow<()> {
        let mut pending = Pending::new();
        // The count is no part of `pending`: it stays in a register.
        let mut count = 0;
        let mut next = 0;
        while !self.nodes.is_empty() {
            if let Some(leaf) = Node::leaf_of(next) {
                limit = visitor.visit(leaf)?;
            } else {
                let node = &self.nodes[next as usize];
                let (near, met) = vectors.boxes(node, ray, limit);
                if met != 0 {
                    let entry = |k| entry(if V::ORDERED { near[k] } else { 0.0 }, node.children[k]);
                    next = pending.all_but_one(&mut count, met, entry);
                    continue;
                }
            }
            let Some(nearer) = pending.nearer(&mut count, limit) else { break };
            next = nearer;
        }
        ControlFlow::Continue(())
    }
}

/// A child with the distance at which the ray enters its box in the upper bits: entries are ordered by distance, which
/// is positive.
#[inline(always)]
fn entry(near: f32, child: u32) -> u64 {
    u64::from(near.to_bits()) << 32 | u64::from(child)
}

/// A stack of children that are still to be visited; the first ones need no allocation.
struct Pending {
    first: [u64; Pending::FIRST],
    others: Vec<u64>,
}

impl Pending {
    const FIRST: usize = 64;

    #[inline(always)]
    fn new() -> Pending {
        Pending { first: [0; Pending::FIRST], others: Vec::new() }
    }

    #[inline(always)]
    fn push(&mut self, count: &mut usize, entry: u64) {
        match self.first.get_mut(*count) {
            Some(slot) => *slot = entry,
            None => self.push_other(entry),
        }
        *count += 1;
    }

    #[cold]
    #[inline(never)]
    fn push_other(&mut self, entry: u64) {
        self.others.push(entry);
    }

    #[inline(always)]
    fn pop(&mut self, count: &mut usize) -> Option<u64> {
        *count = count.checked_sub(1)?;
        self.first.get(*count).copied().or_else(|| self.others.pop())
    }

    /// Pops children until the ray enters one within the limit.
    #[inline(always)]
    fn nearer(&mut self, count: &mut usize, limit: f32) -> Option<u32> {
        loop {
            let entry = self.pop(count)?;
            if f32::from_bits((entry >> 32) as u32) <= limit {
                return Some(entry as u32);
            }
        }
    }

    /// Returns the nearest of the children whose bits are set, and pushes the others.
    #[inline(always)]
    fn all_but_one(&mut self, count: &mut usize, mut bits: u32, entry: impl Fn(usize) -> u64) -> u32 {
        let mut take = || {
            let slot = bits.trailing_zeros() as usize & 7;
            bits &= bits.wrapping_sub(1);
            (entry(slot), bits != 0)
        };
        let (mut min, mut more) = take();
        while more {
            let other;
            (other, more) = take();
            self.push(count, min.max(other));
            min = min.min(other);
        }
        min as u32
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// No mesh tried so far makes a walk this deep.
    #[test]
    fn pending_children_come_back_last_first_however_many_there_are() {
        let (mut pending, mut count) = (Pending::new(), 0);
        for number in [1, Pending::FIRST, Pending::FIRST + 1, 10 * Pending::FIRST] {
            (0..number).for_each(|k| pending.push(&mut count, k as u64));
            (0..number).rev().for_each(|k| assert_eq!(pending.pop(&mut count), Some(k as u64)));
            assert_eq!(pending.pop(&mut count), None);
        }
    }

    #[test]
    fn the_nearest_child_is_next_and_those_beyond_the_limit_are_left_out() {
        let (mut pending, mut count) = (Pending::new(), 0);
        let near = [5.0, 2.0, 0.0, 7.0, 1.0, 3.0, 9.0, 4.0];
        let next = pending.all_but_one(&mut count, 0b1010_1010, |k| entry(near[k], k as u32));
        assert_eq!((next, count), (1, 3));
        let mut left: Vec<u32> = std::iter::from_fn(|| pending.nearer(&mut count, 4.0)).collect();
        left.sort();
        assert_eq!(left, [5, 7]);
    }
}

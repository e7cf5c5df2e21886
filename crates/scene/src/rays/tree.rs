//! The tree of boxes, eight to a node, and the walk through it.

use super::{node::Node, ray::BoxRay, triangle::Leaf, vectors::Vectors};
use std::ops::ControlFlow;

pub(super) struct Tree {
    /// The root first; empty for a mesh without triangles.
    pub nodes: Vec<Node>,
    pub leaves: Vec<Leaf>,
}

/// The action of a walk at the leaves.
pub(super) trait Visitor {
    /// Whether of the children of a node the nearest is visited first, or the farthest. Where any hit will do, that is
    /// better: a ray that starts on a surface is more likely to meet the far side than what is beside it.
    const NEAREST_FIRST: bool;

    /// Looks at a leaf that the ray may meet and returns the limit from now on, or ends the walk.
    fn visit(&mut self, leaf: &Leaf) -> ControlFlow<(), f32>;
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
                limit = visitor.visit(&self.leaves[leaf as usize])?;
            } else {
                let node = &self.nodes[next as usize];
                let (near, met) = vectors.boxes(node, ray, limit);
                if met.is_power_of_two() {
                    next = node.children[slot(met)];
                    continue;
                }
                if met != 0 {
                    next = pending.all_but_one::<V>(&mut count, met, |slot| {
                        self.prefetch(vectors, node.children[slot]);
                        entry(near[slot], node.children[slot])
                    });
                    continue;
                }
            }
            let Some(nearer) = pending.nearer(&mut count, limit) else { break };
            next = nearer;
        }
        ControlFlow::Continue(())
    }

    #[inline(always)]
    fn prefetch(&self, vectors: impl Vectors, child: u32) {
        match Node::leaf_of(child) {
            Some(leaf) => vectors.prefetch(&self.leaves[leaf as usize]),
            None => vectors.prefetch(&self.nodes[child as usize]),
        }
    }
}

/// The first of eight slots whose bit is set.
#[inline(always)]
fn slot(bits: u32) -> usize {
    bits.trailing_zeros() as usize & 7
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
    const FIRST: usize = 32;

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

    /// Returns the first to visit of the children whose bits are set, and pushes the others.
    #[inline(always)]
    fn all_but_one<V: Visitor>(&mut self, count: &mut usize, mut bits: u32, entry: impl Fn(usize) -> u64) -> u32 {
        let mut first = entry(slot(bits));
        loop {
            bits &= bits.wrapping_sub(1);
            if bits == 0 {
                return first as u32;
            }
            let other = entry(slot(bits));
            let (near, far) = (first.min(other), first.max(other));
            let later;
            (first, later) = if V::NEAREST_FIRST { (near, far) } else { (far, near) };
            self.push(count, later);
        }
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

    struct Visits<const NEAREST: bool>;

    impl<const NEAREST: bool> Visitor for Visits<NEAREST> {
        const NEAREST_FIRST: bool = NEAREST;

        fn visit(&mut self, _: &Leaf) -> ControlFlow<(), f32> {
            ControlFlow::Continue(f32::INFINITY)
        }
    }

    /// Seen to catch: the nearest child where the farthest is asked for.
    #[test]
    fn one_child_is_next_and_those_beyond_the_limit_are_left_out() {
        fn visited<const NEAREST: bool>() -> (u32, Vec<u32>) {
            let (mut pending, mut count) = (Pending::new(), 0);
            let near = [5.0, 2.0, 0.0, 7.0, 1.0, 3.0, 9.0, 4.0];
            let entry = |k: usize| entry(near[k], k as u32);
            let next = pending.all_but_one::<Visits<NEAREST>>(&mut count, 0b1010_1010, entry);
            assert_eq!(count, 3);
            let mut left: Vec<u32> = std::iter::from_fn(|| pending.nearer(&mut count, 4.0)).collect();
            left.sort();
            (next, left)
        }
        assert_eq!(visited::<true>(), (1, vec![5, 7]));
        assert_eq!(visited::<false>(), (3, vec![1, 5, 7]));
    }
}

//! The tree of boxes: built by obvhs, walked here.
//!
//! obvhs' own walk keeps its place on a stack of fixed size and silently forgets nodes beyond it; meshes whose details
//! shrink geometrically (horns, shells) make deep trees.

use glam::{UVec2, Vec3, Vec3A};
use obvhs::{
    BvhBuildParams,
    aabb::Aabb,
    bvh2::reinsertion::ReinsertionOptimizer,
    cwbvh::{CwBvh, bvh2_to_cwbvh::bvh2_to_cwbvh},
    ploc::PlocBuilder,
    ray::Ray,
};
use std::ops::ControlFlow;

/// Boxes grow by at least this share of the mesh's diagonal: sixteen float32 rounding steps, where rounded origin,
/// direction, reciprocals, box corners and slab test together can be wrong by seven.
const LEAST_PADDING: f32 = 16.0 * f32::EPSILON;

/// Boxes grow by at most this share. How much differs from box to box, at random: the builder joins each box with the
/// best of its neighbours, and among equal boxes (a mesh on top of itself) all prefer the same one, which makes the
/// build quadratic and the tree a list.
pub(super) const PADDING: f32 = 2.0 * LEAST_PADDING;

/// The tree passes over boxes that end nearer than this, in the units of the scaled mesh. Every box ends farther
/// beyond its triangle than that.
const NEAREST: f32 = 1e-4;

/// Bits of a group that stand for inner nodes.
const INNER: u32 = 0xff00_0000;

pub(super) struct Tree {
    boxes: CwBvh,
}

/// The limit that a ray has in the tree to meet everything nearer than `distance`.
pub(super) fn limit(distance: f64) -> f32 {
    (distance as f32).next_up().max(2.0 * NEAREST)
}

impl Tree {
    /// A tree over triangles of which the box has this diagonal, or less.
    pub fn new(triangles: &[[Vec3; 3]], diagonal: f32) -> Tree {
        let boxes: Vec<Aabb> = triangles.iter().enumerate().map(|(k, t)| padded_box(k, t, diagonal)).collect();
        let build = BvhBuildParams::medium_build();
        let indices = (0..boxes.len() as u32).collect();
        let mut builder = PlocBuilder::with_capacity(boxes.len());
        let (distance, threshold) = (build.ploc_search_distance, build.search_depth_threshold);
        let mut tree = builder.build(distance, &boxes, indices, build.sort_precision, threshold);
        ReinsertionOptimizer::default().run(&mut tree, build.reinsertion_batch_ratio, None);
        const TRIANGLES_PER_LEAF: u32 = 3; // the most that its nodes can hold
        Tree { boxes: bvh2_to_cwbvh(&tree, TRIANGLES_PER_LEAF, true, false) }
    }

    /// The triangles in the order of the leaves.
    pub fn order(&self) -> &[u32] {
        &self.boxes.primitive_indices
    }

    /// Calls `visit` with the place in [`Tree::order`] of every triangle whose box the ray meets; it may shorten the
    /// ray, or stop the walk.
    #[inline(always)]
    pub fn walk(&self, mut ray: Ray, mut visit: impl FnMut(usize, &mut Ray) -> ControlFlow<()>) -> ControlFlow<()> {
        let octant = octant(ray.direction);
        let mut pending = Pending::default();
        let mut next = (!self.boxes.nodes.is_empty()).then_some(UVec2::new(0, 1 << 31));
        while let Some(mut group) = next {
            // The children are in the order in which a ray of this octant meets them, first the highest bit.
            let bit = 31 - group.y.leading_zeros();
            group.y &= !(1 << bit);
            let slot = (bit - 24) ^ (octant & 7);
            let child = group.x + (group.y & !(u32::MAX << slot)).count_ones();
            if group.y & INNER != 0 {
                pending.push(group);
            }
            let node = &self.boxes.nodes[child as usize];
            let hits = node.intersect_ray(&ray, octant);
            let mut leaves = hits & !INNER;
            while leaves != 0 {
                let bit = 31 - leaves.leading_zeros();
                leaves &= !(1 << bit);
                visit((node.primitive_base_idx + bit) as usize, &mut ray)?;
            }
            let inner = hits & INNER;
            next = if inner != 0 {
                Some(UVec2::new(node.child_base_idx, inner | u32::from(node.imask)))
            } else {
                pending.pop()
            };
        }
        ControlFlow::Continue(())
    }
}

/// The order in which a ray meets the children of a node, as obvhs codes it.
fn octant(direction: Vec3A) -> u32 {
    let forward = direction.cmpge(Vec3A::ZERO).bitmask();
    let bits = (forward & 1) << 2 | (forward & 2) | (forward & 4) >> 2;
    bits * 0x0101_0101
}

/// Nodes that are still to be visited: the first ones without asking for memory.
struct Pending {
    near: [UVec2; Pending::NEAR],
    count: usize,
    far: Vec<UVec2>,
}

impl Default for Pending {
    fn default() -> Self {
        Pending { near: [UVec2::ZERO; Pending::NEAR], count: 0, far: Vec::new() }
    }
}

impl Pending {
    const NEAR: usize = 32;

    #[inline(always)]
    fn push(&mut self, group: UVec2) {
        if self.count < Self::NEAR {
            self.near[self.count] = group;
            self.count += 1;
        } else {
            self.far.push(group);
        }
    }

    #[inline(always)]
    fn pop(&mut self) -> Option<UVec2> {
        if self.count == Self::NEAR
            && let Some(group) = self.far.pop()
        {
            return Some(group);
        }
        self.count = self.count.checked_sub(1)?;
        self.near.get(self.count).copied()
    }
}

/// The box of triangle `k`, larger by [`LEAST_PADDING`] to [`PADDING`].
fn padded_box(k: usize, corners: &[Vec3; 3], diagonal: f32) -> Aabb {
    let bits = crate::random::mix(k as u64 + 1);
    let share = |i: u32| (bits >> (10 * i) & 1023) as f32 / 1024.0;
    let pad = |i| {
        let share = Vec3A::new(share(i), share(i + 1), share(i + 2));
        (share * (PADDING - LEAST_PADDING) + LEAST_PADDING) * diagonal
    };
    let [a, b, c] = corners.map(Vec3A::from);
    Aabb::new(a.min(b).min(c) - pad(0), a.max(b).max(c) + pad(3))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// No mesh tried so far makes a walk this deep.
    #[test]
    fn pending_nodes_come_back_last_first_however_many_there_are() {
        let mut pending = Pending::default();
        let group = |k: usize| UVec2::new(k as u32, 1 << 31);
        for count in [1, Pending::NEAR, Pending::NEAR + 1, 10 * Pending::NEAR] {
            (0..count).for_each(|k| pending.push(group(k)));
            (0..count).rev().for_each(|k| assert_eq!(pending.pop(), Some(group(k))));
            assert_eq!(pending.pop(), None);
        }
    }
}

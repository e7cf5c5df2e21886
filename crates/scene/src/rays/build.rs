//! Builds the tree: a binary one by obvhs, which is then made wide.

use super::{
    tree::{Node, Tree},
    triangle::Leaf,
    wide::Wide,
};
use glam::{Vec3, Vec3A};
use obvhs::{
    BvhBuildParams,
    aabb::Aabb,
    bvh2::{Bvh2, reinsertion::ReinsertionOptimizer},
    ploc::PlocBuilder,
};

/// Boxes grow by at least this share of the mesh's diagonal: sixteen float32 rounding steps, where rounded origin,
/// reciprocals, limit, box corners and slab test together can be wrong by seven.
const LEAST_PADDING: f32 = 16.0 * f32::EPSILON;

/// Boxes grow by at most this share. How much differs from box to box, at random: the builder joins each box with the
/// best of its neighbours, and among equal boxes (a mesh on top of itself) all prefer the same one, which makes the
/// build quadratic and the tree a list.
pub(super) const PADDING: f32 = 2.0 * LEAST_PADDING;

/// A tree over triangles of which the box has this diagonal, or less.
pub(super) fn build(triangles: &[[Vec3; 3]], diagonal: f32) -> (Tree, Vec<Leaf>) {
    let (mut nodes, mut leaves) = (vec![], vec![]);
    if triangles.is_empty() {
        return (Tree { nodes }, leaves);
    }
    let wide = Wide::new(binary(triangles, diagonal));
    let mut open = vec![(0, wide.root())];
    nodes.push(Node::EMPTY);
    while let Some((index, children)) = open.pop() {
        for (slot, child) in children.into_iter().enumerate() {
            let code = if let Some(members) = wide.leaf(child) {
                leaves.push(Leaf::new(&members, |k| triangles[k as usize]));
                Node::leaf(leaves.len() - 1)
            } else {
                open.push((nodes.len(), wide.children(child)));
                nodes.push(Node::EMPTY);
                nodes.len() as u32 - 1
            };
            let bounds = wide.bounds(child);
            nodes[index].set(slot, bounds.min.into(), bounds.max.into(), code);
        }
    }
    (Tree { nodes }, leaves)
}

fn binary(triangles: &[[Vec3; 3]], diagonal: f32) -> Bvh2 {
    let boxes: Vec<Aabb> = triangles.iter().enumerate().map(|(k, t)| padded_box(k, t, diagonal)).collect();
    let build = BvhBuildParams::medium_build();
    let indices = (0..boxes.len() as u32).collect();
    let mut builder = PlocBuilder::with_capacity(boxes.len());
    let (distance, threshold) = (build.ploc_search_distance, build.search_depth_threshold);
    let mut tree = builder.build(distance, &boxes, indices, build.sort_precision, threshold);
    ReinsertionOptimizer::default().run(&mut tree, build.reinsertion_batch_ratio, None);
    tree
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

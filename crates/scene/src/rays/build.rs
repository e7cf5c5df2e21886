//! Builds the tree: obvhs makes a binary one, of which eight-wide nodes are made.

use super::{node::Node, tree::Tree, triangle::Leaf, wide::Wide};
use glam::{Vec3, Vec3A};
use obvhs::{
    BvhBuildParams,
    aabb::Aabb,
    bvh2::{Bvh2, reinsertion::ReinsertionOptimizer},
    ploc::PlocBuilder,
};

/// Boxes grow by at least this share of the mesh's diagonal: sixteen float32 rounding steps, where rounded origin,
/// reciprocals, limit, box corners and slab test together can be wrong by seven.
const MIN_PADDING: f32 = 16.0 * f32::EPSILON;

/// Boxes grow by at most this share, each by a random amount: the builder joins each box with the best of its
/// neighbors, and among equal boxes (a mesh on top of itself) all would prefer the same one, which would make the build
/// quadratic and the tree a list.
pub(super) const PADDING: f32 = 2.0 * MIN_PADDING;

/// The tree of a mesh with more [`crowding`] is not optimized: that would take time in proportion to the square of the
/// number of triangles. Ordinary surfaces have 10 at most.
const MAX_CROWDING: f64 = 64.0;

/// A tree over triangles whose bounding box has this diagonal, or less.
pub(super) fn build(triangles: &[[Vec3; 3]], diagonal: f32) -> Tree {
    let (mut nodes, mut leaves) = (vec![], vec![]);
    if triangles.is_empty() {
        return Tree { nodes, leaves };
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
    Tree { nodes, leaves }
}

fn binary(triangles: &[[Vec3; 3]], diagonal: f32) -> Bvh2 {
    let boxes: Vec<Aabb> = triangles.iter().enumerate().map(|(k, t)| padded_box(k, t, diagonal)).collect();
    let build = BvhBuildParams::medium_build();
    let indices = (0..boxes.len() as u32).collect();
    let mut builder = PlocBuilder::with_capacity(boxes.len());
    let (distance, threshold) = (build.ploc_search_distance, build.search_depth_threshold);
    let mut tree = builder.build(distance, &boxes, indices, build.sort_precision, threshold);
    // The optimizer looks for a better parent for each box among those that overlap it.
    if crowding(&tree) < MAX_CROWDING {
        ReinsertionOptimizer::default().run(&mut tree, build.reinsertion_batch_ratio, None);
    }
    tree
}

/// How many boxes of triangles overlap where a triangle is, in the mean over the triangles: over the nodes above it,
/// the maximum of the area of all boxes of triangles below the node, divided by the area of the node's box.
fn crowding(tree: &Bvh2) -> f64 {
    let nodes = &tree.nodes;
    if !tree.children_are_ordered_after_parents {
        return f64::INFINITY;
    }
    let children = |k: usize| [0, 1].map(|side| nodes[k].first_index as usize + side);
    let mut filled: Vec<f32> = nodes.iter().map(|node| node.aabb().half_area()).collect();
    for k in (0..nodes.len()).rev().filter(|k| !nodes[*k].is_leaf()) {
        filled[k] = children(k).iter().map(|child| filled[*child]).sum();
    }
    let mut max = vec![0.0f32; nodes.len()];
    let (mut sum, mut leaves) = (0.0, 0.0);
    for k in 0..nodes.len() {
        let here = max[k].max(filled[k] / nodes[k].aabb().half_area().max(f32::MIN_POSITIVE));
        if nodes[k].is_leaf() {
            sum += f64::from(here);
            leaves += 1.0;
        } else {
            children(k).iter().for_each(|child| max[*child] = here);
        }
    }
    sum / leaves
}

/// The box of triangle `k`, larger by [`MIN_PADDING`] to [`PADDING`].
fn padded_box(k: usize, corners: &[Vec3; 3], diagonal: f32) -> Aabb {
    let bits = crate::random::mix(k as u64 + 1);
    let share = |i: u32| (bits >> (10 * i) & 1023) as f32 / 1024.0;
    let pad = |i| {
        let share = Vec3A::new(share(i), share(i + 1), share(i + 2));
        (share * (PADDING - MIN_PADDING) + MIN_PADDING) * diagonal
    };
    let [a, b, c] = corners.map(Vec3A::from);
    Aabb::new(a.min(b).min(c) - pad(0), a.max(b).max(c) + pad(3))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::{Purpose, Stream};

    /// Triangles of this size at random positions in a cube.
    fn tangle(count: u64, size: f32) -> Vec<[Vec3; 3]> {
        let stream = Stream::new(7, Purpose::Surface);
        let triangle = |k: u64| {
            let item = stream.item(k);
            let vector = |d: u64| Vec3::from_array([0, 1, 2].map(|i| item.uniform(3 * d + i) as f32));
            let position = vector(0);
            [1, 2, 3].map(|corner| position + size * vector(corner))
        };
        (0..count).map(triangle).collect()
    }

    /// Overlapping boxes are distinguished from separate ones, whether all overlap or those of one corner. Seen to
    /// catch: the root alone, which does not see the corner.
    #[test]
    fn crowding_counts_the_boxes_over_each_other() {
        let of = |triangles: &[[Vec3; 3]]| {
            let boxes: Vec<Aabb> = triangles.iter().enumerate().map(|(k, t)| padded_box(k, t, 2.0)).collect();
            let mut builder = PlocBuilder::with_capacity(boxes.len());
            let build = BvhBuildParams::medium_build();
            let (distance, threshold) = (build.ploc_search_distance, build.search_depth_threshold);
            let indices = (0..boxes.len() as u32).collect();
            crowding(&builder.build(distance, &boxes, indices, build.sort_precision, threshold))
        };
        let apart = tangle(4000, 0.03);
        assert!(of(&apart) < 8.0, "{}", of(&apart));
        let same = vec![apart[0]; 4000];
        assert!((3000.0..5000.0).contains(&of(&same)), "{}", of(&same));
        let corner = [&apart[..], &same].concat();
        assert!((1500.0..3000.0).contains(&of(&corner)), "{}", of(&corner));
    }
}

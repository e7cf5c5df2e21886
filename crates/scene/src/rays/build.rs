//! Builds the tree: a binary one, which obvhs optimizes, and of which eight-wide nodes are made.

use super::{binary, node::Node, tree::Tree, triangle::Leaf, wide::Wide};
use glam::{Vec3, Vec3A};
use obvhs::{
    aabb::Aabb,
    bvh2::{Bvh2, reinsertion::ReinsertionOptimizer},
};

/// Boxes grow by this share of the mesh's diagonal: sixteen float32 rounding steps, where rounded origin, reciprocals,
/// limit, box corners and slab test together can be wrong by seven.
pub(super) const PADDING: f32 = 16.0 * f32::EPSILON;

/// The tree of a mesh with more [`crowding`] is not optimized: that would take time in proportion to the square of the
/// number of triangles if they lie inside each other. Ordinary surfaces have 10 at most.
const MAX_CROWDING: f64 = 64.0;

/// The share of the nodes for which a better parent is looked for at a time. A larger one gains nothing.
const REINSERTED: f32 = 0.05;

/// A tree over triangles whose bounding box has this diagonal, or less.
pub(super) fn build(triangles: &[[Vec3; 3]], diagonal: f32) -> Tree {
    let (mut nodes, mut leaves) = (vec![], vec![]);
    if triangles.is_empty() {
        return Tree { nodes, leaves };
    }
    let wide = Wide::new(optimized(triangles, diagonal));
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

fn optimized(triangles: &[[Vec3; 3]], diagonal: f32) -> Bvh2 {
    let boxes: Vec<Aabb> = triangles.iter().map(|corners| padded_box(corners, diagonal)).collect();
    let mut tree = binary::tree(&boxes);
    // The optimizer looks for a better parent for each box among those that overlap it.
    if crowding(&tree) < MAX_CROWDING {
        ReinsertionOptimizer::default().run(&mut tree, REINSERTED, None);
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

/// The box of a triangle, larger by [`PADDING`].
fn padded_box(corners: &[Vec3; 3], diagonal: f32) -> Aabb {
    let [a, b, c] = corners.map(Vec3A::from);
    let padding = Vec3A::splat(PADDING * diagonal);
    Aabb::new(a.min(b).min(c) - padding, a.max(b).max(c) + padding)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        random::{Purpose, Stream},
        rays::vectors::{Plain, Vectors},
        rays::{ray::Ray, triangle::TriangleTest},
    };
    use glam::DVec3;
    use std::time::Instant;

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

    /// Triangles inside each other, which the optimizer would take forty times as long for as for others: measured by
    /// the quicker of two builds, so that a busy machine does not matter.
    #[test]
    fn nested_triangles_do_not_take_long() {
        const COUNT: u64 = 200_000;
        let corners = [Vec3::X, Vec3::NEG_Y, Vec3::Z - Vec3::X];
        let nested: Vec<[Vec3; 3]> =
            (0..COUNT).map(|k| corners.map(|v| v * (1.0 - 0.9 * k as f32 / COUNT as f32))).collect();
        let apart = tangle(COUNT, 0.003);
        let seconds = |triangles: &[[Vec3; 3]]| {
            let start = Instant::now();
            build(triangles, 2.0);
            start.elapsed().as_secs_f64()
        };
        let quicker = |triangles: &[[Vec3; 3]]| (0..2).map(|_| seconds(triangles)).fold(f64::INFINITY, f64::min);
        let ratio = quicker(&nested) / quicker(&apart);
        assert!(ratio < 8.0, "{ratio}");
    }

    /// Across the whole scene, rays meet a triangle where its box has a corner, at the limit of the walk. Seen to catch: a
    /// padding of half a rounding step.
    #[test]
    fn a_ray_that_meets_a_triangle_meets_its_box() {
        let diagonal = 1024.0;
        let half_side = 0.5 * diagonal / 3.0f64.sqrt();
        let mut met = 0;
        for k in 0..100_000 {
            let item = Stream::new(8, Purpose::Surface).item(k);
            let signs = DVec3::from_array([0, 1, 2].map(|d| if item.uniform(d) < 0.5 { -1.0 } else { 1.0 }));
            let near = |d: u64| DVec3::from_array([0, 1, 2].map(|i| 1.0 - 0.2 * item.uniform(d + i))) * half_side;
            let (origin, place) = (signs * near(3), (-signs * near(6)).as_vec3());
            let edge = |d: u64| Vec3::from_array([0, 1, 2].map(|i| item.uniform(d + i) as f32));
            let corners = [place, place + edge(9), place + edge(12)];
            let target = corners[0].as_dvec3() + 1e-6 * (edge(9) + edge(12)).as_dvec3();
            let direction = (target - origin).normalize();
            let test = TriangleTest::new(origin, direction);
            let (crossings, crossed) = test.crossings(&Leaf::new(&[0], |_| corners), diagonal);
            if crossed == 0 {
                continue;
            }
            let mut node = Node::EMPTY;
            let bounds = padded_box(&corners, diagonal as f32);
            node.set(0, bounds.min.into(), bounds.max.into(), 0);
            let ray = Ray { origin, direction, inverse: 1.0 / direction, skipped: 0.0, from: None };
            let (_, boxes) = Plain.boxes(&node, &ray.for_boxes(), crossings.distances[0] as f32);
            assert_eq!(boxes, 1, "{origin} {direction}");
            met += 1;
        }
        assert!(met > 90_000, "{met}");
    }

    /// Overlapping boxes are distinguished from separate ones, whether all overlap or those of one corner. Seen to
    /// catch: the root alone, which does not see the corner.
    #[test]
    fn crowding_counts_the_boxes_over_each_other() {
        let of = |triangles: &[[Vec3; 3]]| {
            let boxes: Vec<Aabb> = triangles.iter().map(|corners| padded_box(corners, 2.0)).collect();
            crowding(&binary::tree(&boxes))
        };
        let apart = tangle(4000, 0.03);
        assert!(of(&apart) < 8.0, "{}", of(&apart));
        let same = vec![apart[0]; 4000];
        assert!((3000.0..5000.0).contains(&of(&same)), "{}", of(&same));
        let corner = [&apart[..], &same].concat();
        assert!((1500.0..3000.0).contains(&of(&corner)), "{}", of(&corner));
    }
}

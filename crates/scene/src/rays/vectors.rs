//! Tests of eight boxes and of four triangles at a time.
//!
//! Every implementation does the same operations in the same order, without fused multiply-adds, so that all results
//! are the same to the last bit.

use super::{
    node::Node,
    ray::BoxRay,
    triangle::{Crossings, Leaf, TriangleTest},
};
use std::array::from_fn;

/// The instructions that a walk is compiled for.
pub(super) trait Vectors: Copy {
    /// The distances at which the ray enters the boxes of a node, and the bits of those that it meets within `limit`.
    fn boxes(self, node: &Node, ray: &BoxRay, limit: f32) -> ([f32; 8], u32);

    /// [`TriangleTest::crossings`].
    fn triangles(self, leaf: &Leaf, test: &TriangleTest, limit: f64) -> (Crossings, u32);

    /// Asks for what will be read later. The default is to do without.
    #[inline(always)]
    fn prefetch<T>(self, _: &T) {}
}

/// A walk through the tree. `run` must be `#[inline(always)]`, and so must all it calls: it is compiled anew for each
/// implementation of [`Vectors`].
pub(super) trait Query {
    type Found;
    fn run(self, vectors: impl Vectors) -> Self::Found;
}

/// Runs on every processor.
#[derive(Clone, Copy)]
pub(super) struct Plain;

impl Vectors for Plain {
    #[inline(always)]
    fn boxes(self, node: &Node, ray: &BoxRay, limit: f32) -> ([f32; 8], u32) {
        let (mut near, mut far) = ([0.0; 8], [limit; 8]);
        for axis in 0..3 {
            let [first, last] = node.planes(axis, ray);
            let at = |plane: f32| (plane - ray.origin[axis]) * ray.inverse[axis];
            near = from_fn(|k| if at(first[k]) > near[k] { at(first[k]) } else { near[k] });
            far = from_fn(|k| if at(last[k]) < far[k] { at(last[k]) } else { far[k] });
        }
        (near, (0..8).map(|k| u32::from(near[k] <= far[k]) << k).sum())
    }

    #[inline(always)]
    fn triangles(self, leaf: &Leaf, test: &TriangleTest, limit: f64) -> (Crossings, u32) {
        test.crossings(leaf, limit)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rays::ray::Ray;
    use glam::{DVec3, Vec3};

    #[test]
    fn a_ray_along_a_side_of_a_box_meets_it() {
        let mut node = Node::EMPTY;
        node.set(0, Vec3::ZERO, Vec3::ONE, 0);
        for (k, zero) in [(0, 0.0), (1, 0.0), (0, -0.0), (1, -0.0)] {
            for axis in 0..3 {
                let (mut origin, mut direction) = (DVec3::splat(f64::from(k)), DVec3::splat(zero));
                (origin[axis], direction[axis]) = (-1.0, 1.0);
                let ray = Ray { origin, direction, inverse: 1.0 / direction, skipped: 0.0, from: None }.for_boxes();
                assert_eq!(Plain.boxes(&node, &ray, f32::INFINITY).1, 1, "{origin} {direction}");
                assert_eq!(Plain.boxes(&node, &ray, 0.9).1, 0, "{origin} {direction}");
            }
        }
    }
}

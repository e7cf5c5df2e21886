//! Tests of eight boxes and of four triangles at a time.
//!
//! Every implementation does the same operations in the same order, without fused multiply-adds, so that all results
//! are the same to the last bit.

use super::{
    node::Node,
    ray::BoxRay,
    triangle::{Leaf, TriangleTest},
};
use std::array::from_fn;

/// The instructions that a walk is compiled for.
pub(super) trait Vectors: Copy {
    /// The distances at which the ray enters the boxes of a node, and the bits of those that it meets within `limit`.
    fn boxes(self, node: &Node, ray: &BoxRay, limit: f32) -> ([f32; 8], u32);

    /// The bits of the triangles of a leaf that the line of the ray meets.
    fn triangles(self, leaf: &Leaf, test: &TriangleTest) -> u32;
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
    fn triangles(self, leaf: &Leaf, test: &TriangleTest) -> u32 {
        (0..4).map(|lane| u32::from(test.meets(leaf, lane)) << lane).sum()
    }
}

#[cfg(all(test, target_arch = "x86_64"))]
mod tests {
    use super::*;
    use crate::{
        random::{Item, Purpose, Stream},
        rays::{avx2::Avx2, ray::Ray},
    };
    use glam::{DVec3, Vec3};

    /// One of few numbers, so that rays run through edges, corners and planes of boxes.
    fn coarse(item: Item, dimension: u64) -> f64 {
        (item.uniform(dimension) * 9.0).floor() - 4.0
    }

    fn ray(item: Item) -> Ray {
        let [origin, direction] = [0, 3].map(|d| DVec3::from_array(from_fn(|k| coarse(item, d + k as u64))));
        let direction = if direction == DVec3::ZERO { DVec3::NEG_Y } else { direction.normalize() };
        Ray { origin, direction, inverse: 1.0 / direction, skipped: 0.0, from: None }
    }

    #[test]
    fn boxes_are_met_alike_with_and_without_avx2() {
        let Some(avx2) = Avx2::detect() else { return };
        let mut met = 0;
        for k in 0..20_000 {
            let item = Stream::new(1, Purpose::Surface).item(k);
            let mut node = Node::EMPTY;
            for slot in 0..7 {
                let d = 10 + 6 * slot as u64;
                let corner = |e: u64| from_fn(|axis| coarse(item, d + e + axis as u64) as f32);
                let [a, b]: [[f32; 3]; 2] = [corner(0), corner(3)];
                node.set(slot, a.into(), from_fn(|i| a[i].max(b[i])).into(), 0);
            }
            let ray = ray(item).for_boxes();
            let limit = [f32::INFINITY, 3.0][(k % 2) as usize];
            let [one, two] = [Plain.boxes(&node, &ray, limit), avx2.boxes(&node, &ray, limit)];
            assert_eq!(one.0.map(f32::to_bits), two.0.map(f32::to_bits), "item {k}");
            assert_eq!(one.1, two.1, "item {k}");
            assert!(one.1 < 128, "the eighth has no box");
            assert!(one.0.iter().all(|x| x.is_sign_positive() && !x.is_nan()), "item {k}: {:?}", one.0);
            met += one.1.count_ones();
        }
        assert!((3_000..100_000).contains(&met), "{met} boxes");
    }

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

    #[test]
    fn triangles_are_met_alike_with_and_without_avx2() {
        let Some(avx2) = Avx2::detect() else { return };
        let mut met = 0;
        for k in 0..20_000 {
            let item = Stream::new(2, Purpose::Surface).item(k);
            let corner =
                |t: u32, c: usize| from_fn(|i| coarse(item, u64::from(9 * t) + (3 * c + i) as u64 + 10) as f32);
            let leaf = Leaf::new(&[0, 1, 2], |t| from_fn(|c| Vec3::from_array(corner(t, c))));
            let ray = ray(item);
            let test = TriangleTest::new(ray.origin, ray.direction);
            let [one, two] = [Plain.triangles(&leaf, &test), avx2.triangles(&leaf, &test)];
            assert_eq!(one, two, "item {k}");
            assert!(one < 8, "the fourth is a point");
            met += one.count_ones();
        }
        assert!((2_000..30_000).contains(&met), "{met} triangles");
    }
}

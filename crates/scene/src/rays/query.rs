//! The two queries as walks through the tree.

use super::{
    ray::{Hit, Ray},
    scaled_mesh::ScaledMesh,
    tree::Visitor,
    triangle::{Crossing, TriangleTest},
    vectors::{Query, Vectors},
};
use crate::cutouts::Cutouts;
use std::ops::ControlFlow;

/// Tells whether a point of a triangle is solid or a hole.
pub(super) trait Solid: Copy {
    fn is_solid(self, triangle: u32, crossing: &Crossing) -> bool;
}

/// Triangles without holes.
#[derive(Clone, Copy)]
pub(super) struct Whole;

impl Solid for Whole {
    #[inline(always)]
    fn is_solid(self, _: u32, _: &Crossing) -> bool {
        true
    }
}

impl Solid for &Cutouts<'_> {
    #[inline(always)]
    fn is_solid(self, triangle: u32, crossing: &Crossing) -> bool {
        !self.is_hole(triangle, || crossing.weights())
    }
}

/// Finds the nearest hit within `limit`, of equally near ones that of the first triangle. Its distance is measured from
/// the ray's start, in scaled units.
pub(super) struct Closest<'a, S> {
    pub mesh: &'a ScaledMesh,
    pub solid: S,
    pub ray: &'a Ray,
    pub limit: f64,
}

/// Finds whether anything is hit before `limit`.
pub(super) struct Occluded<'a, S> {
    pub mesh: &'a ScaledMesh,
    pub solid: S,
    pub ray: &'a Ray,
    pub limit: f64,
}

impl<S: Solid> Query for Closest<'_, S> {
    type Found = Option<Hit>;

    #[inline(always)]
    fn run(self, vectors: impl Vectors) -> Option<Hit> {
        let Closest { mesh, solid, ray, limit } = self;
        let test = TriangleTest::new(ray.origin, ray.direction);
        let mut search = SearchClosest { vectors, mesh, solid, ray, test, limit, best: None };
        let walk = mesh.tree.walk(vectors, &ray.for_boxes(), limit as f32, &mut search);
        debug_assert!(walk.is_continue());
        search.best
    }
}

struct SearchClosest<'a, V, S> {
    vectors: V,
    mesh: &'a ScaledMesh,
    solid: S,
    ray: &'a Ray,
    test: TriangleTest,
    limit: f64,
    best: Option<Hit>,
}

impl<V: Vectors, S: Solid> Visitor for SearchClosest<'_, V, S> {
    const ORDERED: bool = true;

    #[inline(always)]
    fn visit(&mut self, leaf: u32) -> ControlFlow<(), f32> {
        let leaf = &self.mesh.leaves[leaf as usize];
        for lane in lanes(self.vectors.triangles(leaf, &self.test)) {
            let (crossing, triangle) = (self.test.crossing(leaf, lane), leaf.triangles[lane]);
            let distance = crossing.distance;
            // The result must not depend on the order in which leaves are visited.
            let first =
                distance < self.limit || distance == self.limit && self.best.is_none_or(|b| triangle < b.triangle);
            if first && self.mesh.counts(distance, leaf, lane, self.ray) && self.solid.is_solid(triangle, &crossing) {
                self.limit = distance;
                self.best = Some(Hit { distance, triangle, weights: crossing.weights() });
            }
        }
        ControlFlow::Continue(self.limit as f32)
    }
}

impl<S: Solid> Query for Occluded<'_, S> {
    type Found = bool;

    #[inline(always)]
    fn run(self, vectors: impl Vectors) -> bool {
        let Occluded { mesh, solid, ray, limit } = self;
        let test = TriangleTest::new(ray.origin, ray.direction);
        let mut search = SearchAny { vectors, mesh, solid, ray, test, limit };
        mesh.tree.walk(vectors, &ray.for_boxes(), limit as f32, &mut search).is_break()
    }
}

struct SearchAny<'a, V, S> {
    vectors: V,
    mesh: &'a ScaledMesh,
    solid: S,
    ray: &'a Ray,
    test: TriangleTest,
    limit: f64,
}

impl<V: Vectors, S: Solid> Visitor for SearchAny<'_, V, S> {
    const ORDERED: bool = false;

    #[inline(always)]
    fn visit(&mut self, leaf: u32) -> ControlFlow<(), f32> {
        let leaf = &self.mesh.leaves[leaf as usize];
        for lane in lanes(self.vectors.triangles(leaf, &self.test)) {
            let crossing = self.test.crossing(leaf, lane);
            let distance = crossing.distance;
            if distance < self.limit
                && self.mesh.counts(distance, leaf, lane, self.ray)
                && self.solid.is_solid(leaf.triangles[lane], &crossing)
            {
                return ControlFlow::Break(());
            }
        }
        ControlFlow::Continue(self.limit as f32)
    }
}

/// The indices of the set bits of four.
#[inline(always)]
fn lanes(mut bits: u32) -> impl Iterator<Item = usize> {
    std::iter::from_fn(move || {
        let lane = bits.trailing_zeros() as usize;
        bits &= bits.wrapping_sub(1);
        (lane < 4).then_some(lane)
    })
}

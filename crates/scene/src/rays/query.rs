//! The queries as walks through the tree.

use super::{
    ray::{Hit, Ray},
    scaled_mesh::ScaledMesh,
    tree::Visitor,
    triangle::{Crossing, Leaf, TriangleTest},
    vectors::{Query, Vectors},
};
use crate::cutouts::Cutouts;
use std::ops::ControlFlow;

/// Tells whether a point of a triangle is solid or a hole.
pub(super) trait Solid: Copy {
    fn is_solid(self, ray: &Ray, triangle: u32, crossing: &Crossing) -> bool;
}

/// Triangles without holes.
#[derive(Clone, Copy)]
pub(super) struct Whole;

impl Solid for Whole {
    #[inline(always)]
    fn is_solid(self, _: &Ray, _: u32, _: &Crossing) -> bool {
        true
    }
}

impl Solid for &Cutouts<'_> {
    #[inline(always)]
    fn is_solid(self, ray: &Ray, triangle: u32, crossing: &Crossing) -> bool {
        !self.is_hole(triangle, (ray.origin, ray.direction), || crossing.weights())
    }
}

/// The part of a ray up to `limit`, in scaled units from its start, on a mesh.
#[derive(Clone, Copy)]
pub(super) struct Segment<'a, S> {
    pub mesh: &'a ScaledMesh,
    pub solid: S,
    pub ray: &'a Ray,
    pub limit: f64,
}

impl<S: Solid> Segment<'_, S> {
    /// Whether a crossing with a triangle is a hit, apart from the limit.
    #[inline(always)]
    fn is_hit(&self, leaf: &Leaf, lane: usize, crossing: &Crossing) -> bool {
        self.mesh.counts(crossing.distance, leaf, lane, self.ray)
            && self.solid.is_solid(self.ray, leaf.triangles[lane], crossing)
    }
}

/// Finds the nearest hit within the limit, of equally near ones that of the first triangle. Its distance is measured
/// from the ray's start, in scaled units.
pub(super) struct Closest<'a, S>(pub Segment<'a, S>);

/// Finds all hits within the limit, in no particular order.
pub(super) struct All<'a, 'f, S>(pub Segment<'a, S>, pub &'f mut Vec<Hit>);

/// Finds whether anything is hit before the limit.
pub(super) struct Occluded<'a, S>(pub Segment<'a, S>);

impl<S: Solid> Query for Closest<'_, S> {
    type Found = Option<Hit>;

    #[inline(always)]
    fn run(self, vectors: impl Vectors) -> Option<Hit> {
        let Segment { mesh, ray, limit, .. } = self.0;
        let test = TriangleTest::new(ray.origin, ray.direction);
        let mut search = SearchClosest { vectors, segment: self.0, test, best: None };
        let walk = mesh.tree.walk(vectors, &ray.for_boxes(), limit as f32, &mut search);
        debug_assert!(walk.is_continue());
        search.best
    }
}

struct SearchClosest<'a, V, S> {
    vectors: V,
    segment: Segment<'a, S>,
    test: TriangleTest,
    best: Option<Hit>,
}

impl<V: Vectors, S: Solid> Visitor for SearchClosest<'_, V, S> {
    const ORDERED: bool = true;

    #[inline(always)]
    fn visit(&mut self, leaf: u32) -> ControlFlow<(), f32> {
        let leaf = &self.segment.mesh.leaves[leaf as usize];
        for lane in lanes(self.vectors.triangles(leaf, &self.test)) {
            let (crossing, triangle) = (self.test.crossing(leaf, lane), leaf.triangles[lane]);
            let distance = crossing.distance;
            // The result must not depend on the order in which leaves are visited.
            let limit = self.segment.limit;
            let first = distance < limit || distance == limit && self.best.is_none_or(|b| triangle < b.triangle);
            if first && self.segment.is_hit(leaf, lane, &crossing) {
                self.segment.limit = distance;
                self.best = Some(Hit { distance, triangle, weights: crossing.weights() });
            }
        }
        ControlFlow::Continue(self.segment.limit as f32)
    }
}

impl<S: Solid> Query for All<'_, '_, S> {
    type Found = ();

    #[inline(always)]
    fn run(self, vectors: impl Vectors) {
        let Segment { mesh, ray, limit, .. } = self.0;
        let test = TriangleTest::new(ray.origin, ray.direction);
        let mut search = SearchAll { vectors, segment: self.0, test, found: self.1 };
        let walk = mesh.tree.walk(vectors, &ray.for_boxes(), limit as f32, &mut search);
        debug_assert!(walk.is_continue());
    }
}

struct SearchAll<'a, 'f, V, S> {
    vectors: V,
    segment: Segment<'a, S>,
    test: TriangleTest,
    found: &'f mut Vec<Hit>,
}

impl<V: Vectors, S: Solid> Visitor for SearchAll<'_, '_, V, S> {
    const ORDERED: bool = false;

    #[inline(always)]
    fn visit(&mut self, leaf: u32) -> ControlFlow<(), f32> {
        let leaf = &self.segment.mesh.leaves[leaf as usize];
        for lane in lanes(self.vectors.triangles(leaf, &self.test)) {
            let crossing = self.test.crossing(leaf, lane);
            if crossing.distance <= self.segment.limit && self.segment.is_hit(leaf, lane, &crossing) {
                let (distance, triangle) = (crossing.distance, leaf.triangles[lane]);
                self.found.push(Hit { distance, triangle, weights: crossing.weights() });
            }
        }
        ControlFlow::Continue(self.segment.limit as f32)
    }
}

impl<S: Solid> Query for Occluded<'_, S> {
    type Found = bool;

    #[inline(always)]
    fn run(self, vectors: impl Vectors) -> bool {
        let Segment { mesh, ray, limit, .. } = self.0;
        let test = TriangleTest::new(ray.origin, ray.direction);
        let mut search = SearchAny { vectors, segment: self.0, test };
        mesh.tree.walk(vectors, &ray.for_boxes(), limit as f32, &mut search).is_break()
    }
}

struct SearchAny<'a, V, S> {
    vectors: V,
    segment: Segment<'a, S>,
    test: TriangleTest,
}

impl<V: Vectors, S: Solid> Visitor for SearchAny<'_, V, S> {
    const ORDERED: bool = false;

    #[inline(always)]
    fn visit(&mut self, leaf: u32) -> ControlFlow<(), f32> {
        let leaf = &self.segment.mesh.leaves[leaf as usize];
        for lane in lanes(self.vectors.triangles(leaf, &self.test)) {
            let crossing = self.test.crossing(leaf, lane);
            if crossing.distance < self.segment.limit && self.segment.is_hit(leaf, lane, &crossing) {
                return ControlFlow::Break(());
            }
        }
        ControlFlow::Continue(self.segment.limit as f32)
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

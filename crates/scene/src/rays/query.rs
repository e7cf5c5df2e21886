//! The queries as walks through the tree.

use super::{
    ray::{Hit, Ray},
    scaled_mesh::ScaledMesh,
    tree::Visitor,
    triangle::{Crossings, Leaf, TriangleTest},
    vectors::{Query, Vectors},
};
use crate::cutouts::Cutouts;
use std::ops::ControlFlow;

/// Tells whether a point of a triangle is solid or a hole.
pub(super) trait Solid: Copy {
    fn is_solid(self, ray: &Ray, triangle: u32, weights: impl FnOnce() -> [f64; 3]) -> bool;
}

/// Triangles without holes.
#[derive(Clone, Copy)]
pub(super) struct Whole;

impl Solid for Whole {
    #[inline(always)]
    fn is_solid(self, _: &Ray, _: u32, _: impl FnOnce() -> [f64; 3]) -> bool {
        true
    }
}

impl Solid for &Cutouts<'_> {
    #[inline(always)]
    fn is_solid(self, ray: &Ray, triangle: u32, weights: impl FnOnce() -> [f64; 3]) -> bool {
        !self.is_hole(triangle, (ray.origin, ray.direction), weights)
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
    fn is_hit(&self, leaf: &Leaf, lane: usize, crossings: &Crossings) -> bool {
        self.mesh.counts(crossings.distances[lane], leaf, lane, self.ray)
            && self.solid.is_solid(self.ray, leaf.triangles[lane], || crossings.weights(lane))
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
    const NEAREST_FIRST: bool = true;

    #[inline(always)]
    fn visit(&mut self, leaf: &Leaf) -> ControlFlow<(), f32> {
        let (crossings, met) = self.vectors.triangles(leaf, &self.test, self.segment.limit);
        for lane in lanes(met) {
            let (distance, triangle) = (crossings.distances[lane], leaf.triangles[lane]);
            // The result must not depend on the order in which leaves are visited.
            let limit = self.segment.limit;
            let first = distance < limit || distance == limit && self.best.is_none_or(|b| triangle < b.triangle);
            if first && self.segment.is_hit(leaf, lane, &crossings) {
                self.segment.limit = distance;
                self.best = Some(Hit { distance, triangle, weights: crossings.weights(lane) });
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
    const NEAREST_FIRST: bool = false;

    #[inline(always)]
    fn visit(&mut self, leaf: &Leaf) -> ControlFlow<(), f32> {
        let (crossings, met) = self.vectors.triangles(leaf, &self.test, self.segment.limit);
        for lane in lanes(met) {
            if self.segment.is_hit(leaf, lane, &crossings) {
                let (distance, triangle) = (crossings.distances[lane], leaf.triangles[lane]);
                self.found.push(Hit { distance, triangle, weights: crossings.weights(lane) });
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
    const NEAREST_FIRST: bool = false;

    #[inline(always)]
    fn visit(&mut self, leaf: &Leaf) -> ControlFlow<(), f32> {
        let (crossings, met) = self.vectors.triangles(leaf, &self.test, self.segment.limit);
        for lane in lanes(met) {
            if crossings.distances[lane] < self.segment.limit && self.segment.is_hit(leaf, lane, &crossings) {
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

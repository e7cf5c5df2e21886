//! Closest hit and visibility, over obvhs.
//!
//! The tree is walked in float32 through boxes that are padded by more than its rounding can amount to, and the
//! triangles are tested in float64 with the watertight test of Woop, Benthin and Wald 2013: neighbours agree on the
//! sign of their common edge, so no ray slips between them. The mesh is first scaled, exactly, to one size: nothing
//! here depends on that of the scene. No ray needs an offset: one that starts on a triangle names it.

mod tree;
mod triangle;

use crate::mesh::Mesh;
use glam::{DVec3, Vec3};
use obvhs::ray::Ray;
use std::ops::ControlFlow;
use tree::Tree;
use triangle::{Crossing, TriangleTest};

/// The diagonal of the scaled mesh is at most this and more than half of it, which makes [`tree::NEAREST`] a small
/// share of it.
const DIAGONAL: f64 = 1024.0;

/// A hit nearer than this share of the diagonal may be the surface that the ray left: rounding puts the crossing of a
/// triangle in the same plane anywhere up to 1e-16 over the cosine, and 1e-10 is a flat ray indeed.
const SKIN: f64 = 1e-6 * DIAGONAL;

/// The way to a light ends this share of the diagonal before the light's own surface.
const CLEARANCE: f64 = 1e-9 * DIAGONAL;

/// Where a ray meets a triangle.
#[derive(Clone, Copy, Debug)]
pub struct Hit {
    /// m along the unit direction.
    pub distance: f64,
    pub triangle: u32,
    /// Barycentric weights.
    pub weights: [f64; 3],
}

/// Ray queries on a mesh.
pub struct Rays {
    tree: Tree,
    /// Scaled corners in the order of the tree's leaves.
    corners: Vec<[Vec3; 3]>,
    /// Triangle of the mesh for each of `corners`.
    triangles: Vec<u32>,
    /// Place in `corners` of each triangle of the mesh.
    places: Vec<u32>,
    /// The padded box around the scaled mesh.
    low: DVec3,
    high: DVec3,
    /// Scaled units per metre, a power of two.
    scale: f64,
}

/// A scaled ray that starts in the scene's box.
struct Start {
    origin: DVec3,
    direction: DVec3,
    /// Way outside the box that was left out.
    skipped: f64,
    from: Option<u32>,
}

impl Rays {
    /// Builds the tree. The same mesh gives the same tree for any number of threads.
    pub fn new(mesh: &Mesh) -> Rays {
        let (low, high) = mesh.bounds();
        let scale = if mesh.triangles.is_empty() { 1.0 } else { scale_of((high - low).length()) };
        let scaled = |i: u32| (mesh.positions[i as usize].as_dvec3() * scale).as_vec3();
        let corners: Vec<[Vec3; 3]> = mesh.triangles.iter().map(|t| t.vertices.map(scaled)).collect();
        let tree = Tree::new(&corners, DIAGONAL as f32);
        let triangles = tree.order().to_vec();
        let corners = triangles.iter().map(|k| corners[*k as usize]).collect();
        let mut places = vec![0; triangles.len()];
        triangles.iter().enumerate().for_each(|(place, k)| places[*k as usize] = place as u32);
        let padding = f64::from(tree::PADDING) * DIAGONAL;
        let (low, high) = (low * scale - padding, high * scale + padding);
        Rays { tree, corners, triangles, places, low, high, scale }
    }

    /// The nearest triangle along the ray, other than the one it starts `from`. `direction` is a unit vector.
    pub fn closest(&self, origin: DVec3, direction: DVec3, from: Option<u32>) -> Option<Hit> {
        let start = self.start(origin, direction, from)?;
        match direction.abs().max_position() {
            0 => self.closest_along::<0>(&start),
            1 => self.closest_along::<1>(&start),
            _ => self.closest_along::<2>(&start),
        }
    }

    /// True if nothing lies along the ray within `distance` (m, may be infinite), other than the triangle it starts
    /// `from`.
    pub fn visible(&self, origin: DVec3, direction: DVec3, distance: f64, from: Option<u32>) -> bool {
        let Some(start) = self.start(origin, direction, from) else {
            return true;
        };
        let limit = distance * self.scale - start.skipped - CLEARANCE;
        match direction.abs().max_position() {
            0 => self.visible_along::<0>(&start, limit),
            1 => self.visible_along::<1>(&start, limit),
            _ => self.visible_along::<2>(&start, limit),
        }
    }

    fn closest_along<const AXIS: usize>(&self, start: &Start) -> Option<Hit> {
        let test = TriangleTest::<AXIS>::new(start.origin, start.direction);
        let mut best: Option<Hit> = None;
        let mut limit = f64::INFINITY;
        let walk = self.tree.walk(start.ray(limit), |place, ray| {
            if let Some(met) = test.intersect(&self.corners[place])
                && met.distance < limit
                && self.counts(&met, place, start)
            {
                limit = met.distance;
                ray.tmax = tree::limit(limit);
                best = Some(Hit { distance: limit, triangle: self.triangles[place], weights: met.weights() });
            }
            ControlFlow::Continue(())
        });
        debug_assert!(walk.is_continue());
        best.map(|hit| Hit { distance: (hit.distance.max(0.0) + start.skipped) / self.scale, ..hit })
    }

    fn visible_along<const AXIS: usize>(&self, start: &Start, limit: f64) -> bool {
        if limit.is_nan() || limit <= 0.0 {
            return true;
        }
        let test = TriangleTest::<AXIS>::new(start.origin, start.direction);
        let walked = self.tree.walk(start.ray(limit), |place, _| match test.intersect(&self.corners[place]) {
            Some(met) if met.distance < limit && self.counts(&met, place, start) => ControlFlow::Break(()),
            _ => ControlFlow::Continue(()),
        });
        walked.is_continue()
    }

    /// Scales the ray and moves one that starts outside the scene's box to where it enters; none if it misses the box.
    fn start(&self, origin: DVec3, direction: DVec3, from: Option<u32>) -> Option<Start> {
        let origin = origin * self.scale;
        let (mut enter, mut leave) = (0.0f64, f64::INFINITY);
        for axis in 0..3 {
            if direction[axis].abs() < f64::MIN_POSITIVE {
                if origin[axis] < self.low[axis] || origin[axis] > self.high[axis] {
                    return None;
                }
                continue;
            }
            let inverse = 1.0 / direction[axis];
            let one = (self.low[axis] - origin[axis]) * inverse;
            let two = (self.high[axis] - origin[axis]) * inverse;
            enter = enter.max(one.min(two));
            leave = leave.min(one.max(two));
        }
        let origin = origin + direction * enter;
        // A ray that is no ray (direction 0, not a number) never leaves.
        let valid = enter <= leave && leave < f64::INFINITY && (origin + direction).is_finite();
        valid.then_some(Start { origin, direction, skipped: enter, from })
    }

    /// False for what lies behind the origin, for the triangle that the ray left, and for neighbours that rounding
    /// puts in its way.
    #[inline(always)]
    fn counts(&self, met: &Crossing, place: usize, start: &Start) -> bool {
        let Some(from) = start.from else {
            return met.distance >= 0.0;
        };
        let in_front = met.distance >= 0.0 && self.triangles[place] != from;
        in_front && (met.distance > SKIN || self.is_ahead(place, from, start.direction))
    }

    /// Whether a triangle reaches into the half-space that a ray goes to from the one that it left: if it lies in the
    /// same plane or bends away, it cannot be in the way, wherever rounding says that it is met.
    #[cold]
    fn is_ahead(&self, place: usize, from: u32, direction: DVec3) -> bool {
        const ROUNDING: f64 = 1e-14;
        let [a, b, c] = self.corners[self.places[from as usize] as usize].map(|v| v.as_dvec3());
        let normal = (b - a).cross(c - a);
        let normal = if normal.dot(direction) < 0.0 { -normal } else { normal };
        let threshold = ROUNDING * normal.length();
        let offsets = self.corners[place].map(|v| v.as_dvec3() - a);
        offsets.iter().any(|offset| normal.dot(*offset) > threshold * offset.length())
    }
}

impl Start {
    fn ray(&self, limit: f64) -> Ray {
        // The tree takes -0 for a direction of its own: adding 0 removes it.
        let direction = self.direction.as_vec3a() + glam::Vec3A::ZERO;
        Ray::new(self.origin.as_vec3a(), direction, 0.0, tree::limit(limit))
    }
}

/// The power of two that scales `diagonal` to [`DIAGONAL`] or less, down to half of it.
fn scale_of(diagonal: f64) -> f64 {
    let scale = (DIAGONAL / diagonal).log2().floor().exp2();
    if diagonal * scale > DIAGONAL { scale / 2.0 } else { scale }
}

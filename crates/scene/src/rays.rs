//! Closest hit and visibility, over obvhs.
//!
//! The tree is walked in float32 through boxes that are padded by more than its rounding can amount to, and the
//! triangles are tested in float64 with the watertight test of Woop, Benthin and Wald 2013: neighbours agree on the
//! sign of their common edge, so no ray slips between them. Nothing here depends on the scale of the scene, and no ray
//! needs an offset: one that starts on a triangle names it.

use crate::mesh::Mesh;
use glam::{DVec3, Vec3, Vec3A};
use obvhs::{
    BvhBuildParams,
    aabb::Aabb,
    bvh2::{Bvh2, builder::build_bvh2},
    ray::{Ray, RayHit},
};
use std::time::Duration;

/// Boxes grow by this share of the scene's diagonal: about eight float32 rounding steps, where the slab test, the
/// rounded origin and the rounded direction together can be wrong by six.
const BOX_PADDING: f64 = 8.0 * f32::EPSILON as f64;

/// A hit nearer than this share of the diagonal is the surface that the ray left: in float64 a neighbour of the
/// triangle it starts on may be met a rounding step away.
const MIN_DISTANCE: f64 = 1e-9;

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
    tree: Bvh2,
    /// Corners in the order of the tree's leaves.
    corners: Vec<[Vec3; 3]>,
    /// Triangle of the mesh for each of `corners`.
    triangles: Vec<u32>,
    low: DVec3,
    high: DVec3,
    min_distance: f64,
}

impl Rays {
    /// Builds the tree. The same mesh gives the same tree for any number of threads.
    pub fn new(mesh: &Mesh) -> Rays {
        let (low, high) = mesh.bounds();
        let diagonal = (high - low).length();
        let padding = diagonal * BOX_PADDING;
        let pad = Vec3A::splat(padding as f32);
        let corners_of = |k: usize| mesh.triangles[k].vertices.map(|i| mesh.positions[i as usize]);
        let boxes: Vec<Aabb> = (0..mesh.triangles.len())
            .map(|k| {
                let [a, b, c] = corners_of(k).map(Vec3A::from);
                Aabb::new(a.min(b).min(c) - pad, a.max(b).max(c) + pad)
            })
            .collect();
        let tree = build_bvh2(&boxes, BvhBuildParams::medium_build(), &mut Duration::default());
        let triangles = tree.primitive_indices.clone();
        let corners = triangles.iter().map(|k| corners_of(*k as usize)).collect();
        let (low, high) = (low - padding, high + padding);
        Rays { tree, corners, triangles, low, high, min_distance: diagonal * MIN_DISTANCE }
    }

    /// The nearest triangle along the ray, other than the one it starts `from`. `direction` is a unit vector.
    pub fn closest(&self, origin: DVec3, direction: DVec3, from: Option<u32>) -> Option<Hit> {
        let (test, skipped) = self.clip(origin, direction)?;
        let mut best: Option<Hit> = None;
        let mut limit = f64::INFINITY;
        self.tree.ray_traverse(test.ray(f32::INFINITY), &mut RayHit::none(), |_, k| {
            let Some(hit) = self.meet(&test, k, from).filter(|h| h.distance < limit) else {
                return f32::INFINITY;
            };
            limit = hit.distance;
            best = Some(hit);
            (hit.distance as f32).next_up()
        });
        best.map(|hit| Hit { distance: hit.distance + skipped, ..hit })
    }

    /// True if nothing lies along the ray within `distance` (m, may be infinite), other than the triangle it starts
    /// `from`.
    pub fn visible(&self, origin: DVec3, direction: DVec3, distance: f64, from: Option<u32>) -> bool {
        let Some((test, skipped)) = self.clip(origin, direction) else {
            return true;
        };
        let limit = distance - skipped - self.min_distance;
        let box_limit = (limit as f32).next_up();
        if !(box_limit > 0.0) {
            return true;
        }
        self.tree.ray_traverse_miss(test.ray(box_limit), |_, k| match self.meet(&test, k, from) {
            Some(hit) if hit.distance < limit => 0.0,
            _ => f32::INFINITY,
        })
    }

    /// Moves a ray that starts outside the scene's box to where it enters; none if it misses the box.
    fn clip(&self, origin: DVec3, direction: DVec3) -> Option<(TriangleTest, f64)> {
        let (mut enter, mut leave) = (0.0f64, f64::INFINITY);
        for axis in 0..3 {
            if direction[axis] == 0.0 {
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
        (enter <= leave).then(|| (TriangleTest::new(origin + direction * enter, direction), enter))
    }

    fn meet(&self, test: &TriangleTest, k: usize, from: Option<u32>) -> Option<Hit> {
        let triangle = self.triangles[k];
        let (distance, weights) = test.intersect(&self.corners[k])?;
        let valid = Some(triangle) != from && (distance > self.min_distance || from.is_none() && distance >= 0.0);
        valid.then_some(Hit { distance, triangle, weights })
    }
}

/// A ray sheared so that it runs along one axis: the triangle test is then two-dimensional.
struct TriangleTest {
    origin: DVec3,
    direction: DVec3,
    axes: [usize; 3],
    shear: DVec3,
}

impl TriangleTest {
    fn new(origin: DVec3, direction: DVec3) -> Self {
        let z = direction.abs().max_position();
        let (mut x, mut y) = ((z + 1) % 3, (z + 2) % 3);
        if direction[z] < 0.0 {
            std::mem::swap(&mut x, &mut y);
        }
        let shear = DVec3::new(direction[x] / direction[z], direction[y] / direction[z], 1.0 / direction[z]);
        TriangleTest { origin, direction, axes: [x, y, z], shear }
    }

    fn ray(&self, limit: f32) -> Ray {
        Ray::new(self.origin.as_vec3a(), self.direction.as_vec3a(), 0.0, limit)
    }

    /// Distance (any sign) and weights of the crossing, edges and corners included.
    #[inline(always)]
    fn intersect(&self, corners: &[Vec3; 3]) -> Option<(f64, [f64; 3])> {
        let [x, y, z] = self.axes;
        let [a, b, c] = corners.map(|v| {
            let v = v.as_dvec3() - self.origin;
            DVec3::new(v[x] - self.shear.x * v[z], v[y] - self.shear.y * v[z], self.shear.z * v[z])
        });
        let u = c.x * b.y - c.y * b.x;
        let v = a.x * c.y - a.y * c.x;
        let w = b.x * a.y - b.y * a.x;
        if (u < 0.0 || v < 0.0 || w < 0.0) && (u > 0.0 || v > 0.0 || w > 0.0) {
            return None;
        }
        let sum = u + v + w;
        if sum == 0.0 {
            return None; // seen edge-on
        }
        let weights = [u / sum, v / sum, w / sum];
        Some((weights[0] * a.z + weights[1] * b.z + weights[2] * c.z, weights))
    }
}

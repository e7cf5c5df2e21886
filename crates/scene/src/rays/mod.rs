//! Closest hit and visibility.
//!
//! The walk through the tree is in float32, through boxes that are padded by more than its rounding can amount to. The
//! triangles are tested in float64 with the watertight test of Woop, Benthin and Wald 2013: neighbors agree on the sign
//! of their common edge, so no ray slips between them. The mesh is first scaled, exactly, to one size: nothing here
//! depends on that of the scene. No ray needs an offset: one that starts on a triangle names it.
//!
//! obvhs optimizes the tree; the first tree and the walk are our own. The walks of obvhs lose hits near the origin and
//! along axes, and have about half the speed.

#[cfg(target_arch = "x86_64")]
mod avx2;
mod binary;
mod build;
mod dispatch;
mod node;
mod query;
mod ray;
mod scaled_mesh;
mod tree;
mod triangle;
mod vectors;
mod wide;

pub use ray::Hit;

use crate::{cutouts::Cutouts, mesh::Mesh, scene::Scene};
use dispatch::run;
use glam::{DVec3, Vec3};
use query::{All, Closest, Occluded, Segment, Whole};
use ray::Ray;
use scaled_mesh::{DIAGONAL, ROUNDING, ScaledMesh};

/// A ray to a light ends this share of the diagonal before the light's own surface.
const CLEARANCE: f64 = 1e-9 * DIAGONAL;

/// Ray queries on a mesh.
pub struct Rays<'a> {
    mesh: ScaledMesh,
    /// The padded box around the scaled mesh.
    bounds: [DVec3; 2],
    /// Scaled units per metre, a power of two.
    scale: f64,
    /// m per scaled unit.
    metres: f64,
    /// Holes through which rays pass.
    cutouts: Option<Cutouts<'a>>,
}

impl<'a> Rays<'a> {
    /// Builds the tree. The same mesh gives the same tree for any number of threads.
    pub fn new(mesh: &Mesh) -> Self {
        let (low, high) = mesh.bounds();
        let scale = if mesh.triangles.is_empty() { 1.0 } else { scale_of((high - low).length()) };
        let scaled = |i: u32| (mesh.positions[i as usize].as_dvec3() * scale).as_vec3();
        let corners: Vec<[Vec3; 3]> = mesh.triangles.iter().map(|t| t.vertices.map(scaled)).collect();
        let padding = f64::from(build::PADDING) * DIAGONAL;
        let bounds = [low * scale - padding, high * scale + padding];
        Rays { mesh: ScaledMesh::new(&corners), bounds, scale, metres: 1.0 / scale, cutouts: None }
    }

    /// Builds the tree over the mesh of a scene, where rays pass through the holes of opaque surfaces.
    pub fn of_scene(scene: &'a Scene, translucent: impl Fn(u16) -> bool) -> Self {
        Rays { cutouts: Cutouts::new(scene, translucent), ..Rays::new(&scene.mesh) }
    }

    /// The nearest triangle along the ray, other than the one it starts `from`; of equally near ones the first of the
    /// mesh. `direction` is a unit vector.
    pub fn closest(&self, origin: DVec3, direction: DVec3, from: Option<u32>) -> Option<Hit> {
        self.closest_within(origin, direction, f64::INFINITY, from)
    }

    /// What [`Rays::closest`] finds, if that lies within `limit` (m, may be infinite): a short limit makes the query
    /// much cheaper.
    pub fn closest_within(&self, origin: DVec3, direction: DVec3, limit: f64, from: Option<u32>) -> Option<Hit> {
        let ray = &Ray::new(origin * self.scale, direction, from, self.bounds)?;
        // Rounding must not lose a hit at the limit itself: the walk goes a little farther.
        let scaled_limit = limit * self.scale * (1.0 + ROUNDING) - ray.skipped * (1.0 - ROUNDING);
        if scaled_limit.is_nan() || scaled_limit < 0.0 {
            return None;
        }
        let hit = match &self.cutouts {
            None => run(Closest(Segment { mesh: &self.mesh, solid: Whole, ray, limit: scaled_limit })),
            Some(cutouts) => run(Closest(Segment { mesh: &self.mesh, solid: cutouts, ray, limit: scaled_limit })),
        }?;
        let distance = (hit.distance.max(0.0) + ray.skipped) * self.metres;
        (distance <= limit).then_some(Hit { distance, ..hit })
    }

    /// Finds every triangle along the ray within `limit` (m), in the order of the mesh.
    pub fn all_within(&self, origin: DVec3, direction: DVec3, limit: f64, found: &mut Vec<Hit>) {
        found.clear();
        let Some(ray) = &Ray::new(origin * self.scale, direction, None, self.bounds) else {
            return;
        };
        let limit = limit * self.scale - ray.skipped;
        if limit.is_nan() || limit < 0.0 {
            return;
        }
        match &self.cutouts {
            None => run(All(Segment { mesh: &self.mesh, solid: Whole, ray, limit }, found)),
            Some(cutouts) => run(All(Segment { mesh: &self.mesh, solid: cutouts, ray, limit }, found)),
        }
        found.iter_mut().for_each(|hit| hit.distance = (hit.distance.max(0.0) + ray.skipped) * self.metres);
        found.sort_unstable_by_key(|hit| hit.triangle);
    }

    /// True if nothing lies along the ray within `distance` (m, may be infinite), other than the triangle it starts
    /// `from`.
    pub fn visible(&self, origin: DVec3, direction: DVec3, distance: f64, from: Option<u32>) -> bool {
        let Some(ray) = &Ray::new(origin * self.scale, direction, from, self.bounds) else {
            return true;
        };
        let limit = distance * self.scale - ray.skipped - CLEARANCE;
        let ends_before_the_box = limit.is_nan() || limit <= 0.0;
        ends_before_the_box
            || match &self.cutouts {
                None => !run(Occluded(Segment { mesh: &self.mesh, solid: Whole, ray, limit })),
                Some(cutouts) => !run(Occluded(Segment { mesh: &self.mesh, solid: cutouts, ray, limit })),
            }
    }
}

/// The power of two that scales `diagonal` to [`DIAGONAL`] or less, down to half of it.
fn scale_of(diagonal: f64) -> f64 {
    let scale = (DIAGONAL / diagonal).log2().floor().exp2();
    if diagonal * scale > DIAGONAL { scale / 2.0 } else { scale }
}

//! Closest hit and visibility.
//!
//! The tree is walked in float32 through boxes that are padded by more than its rounding can amount to, and the
//! triangles are tested in float64 with the watertight test of Woop, Benthin and Wald 2013: neighbours agree on the
//! sign of their common edge, so no ray slips between them. The mesh is first scaled, exactly, to one size: nothing
//! here depends on that of the scene. No ray needs an offset: one that starts on a triangle names it.
//!
//! obvhs builds a binary tree; the walk is our own. The ones of obvhs lose hits near the origin and along axes, and
//! have little more than half the speed.

#[cfg(target_arch = "x86_64")]
mod avx2;
mod build;
mod query;
mod ray;
mod tree;
mod triangle;
mod vectors;
mod wide;

use crate::{Scene, cutouts::Cutouts, mesh::Mesh};
use glam::{DVec3, Vec3};
use query::{Closest, Occluded, Whole};
use ray::Ray;
use tree::Tree;
use triangle::Leaf;

/// The diagonal of the scaled mesh is at most this and more than half of it.
const DIAGONAL: f64 = 1024.0;

/// A hit nearer than this share of the diagonal may be the surface that the ray left: rounding puts the crossing of a
/// triangle in the same plane anywhere up to 1e-16 over the cosine, and 1e-10 is a flat ray indeed.
const SELF_HIT_EPSILON: f64 = 1e-6 * DIAGONAL;

/// The way to a light ends this share of the diagonal before the light's own surface.
const CLEARANCE: f64 = 1e-9 * DIAGONAL;

/// More than the rounding of a few operations in float64, as a share.
const ROUNDING: f64 = 1e-14;

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
pub struct Rays<'a> {
    tree: Tree,
    /// Scaled triangles.
    leaves: Vec<Leaf>,
    /// For each triangle of the mesh, four times its leaf plus its place there.
    places: Vec<u32>,
    /// The padded box around the scaled mesh.
    bounds: [DVec3; 2],
    /// Scaled units per metre, a power of two.
    scale: f64,
    /// m per scaled unit.
    metres: f64,
    /// Where rays pass through triangles.
    cutouts: Option<Cutouts<'a>>,
}

impl<'a> Rays<'a> {
    /// Builds the tree. The same mesh gives the same tree for any number of threads.
    pub fn new(mesh: &Mesh) -> Self {
        let (low, high) = mesh.bounds();
        let scale = if mesh.triangles.is_empty() { 1.0 } else { scale_of((high - low).length()) };
        let scaled = |i: u32| (mesh.positions[i as usize].as_dvec3() * scale).as_vec3();
        let corners: Vec<[Vec3; 3]> = mesh.triangles.iter().map(|t| t.vertices.map(scaled)).collect();
        let (tree, leaves) = build::build(&corners, DIAGONAL as f32);
        let mut places = vec![0; corners.len()];
        for (k, leaf) in leaves.iter().enumerate() {
            // What fills a leaf up repeats its first triangle: that is written last.
            (0..4).rev().for_each(|lane| places[leaf.triangles[lane] as usize] = (4 * k + lane) as u32);
        }
        let padding = f64::from(build::PADDING) * DIAGONAL;
        let bounds = [low * scale - padding, high * scale + padding];
        Rays { tree, leaves, places, bounds, scale, metres: 1.0 / scale, cutouts: None }
    }

    /// The same on the mesh of a scene, where rays pass through the holes of opaque surfaces.
    pub fn of_scene(scene: &'a Scene, translucent: impl Fn(u16) -> bool) -> Self {
        Rays { cutouts: Cutouts::new(scene, translucent), ..Rays::new(&scene.mesh) }
    }

    /// The nearest triangle along the ray, other than the one it starts `from`; of those equally near the first of the
    /// mesh. `direction` is a unit vector.
    pub fn closest(&self, origin: DVec3, direction: DVec3, from: Option<u32>) -> Option<Hit> {
        self.closest_within(origin, direction, f64::INFINITY, from)
    }

    /// What [`Rays::closest`] finds if that is nearer than `limit` or at it (m, may be infinite): a short limit makes
    /// this much cheaper.
    pub fn closest_within(&self, origin: DVec3, direction: DVec3, limit: f64, from: Option<u32>) -> Option<Hit> {
        let ray = &Ray::new(origin * self.scale, direction, from, self.bounds)?;
        // The walk may go a little farther, never less far: rounding must not lose a hit at the limit itself.
        let reach = limit * self.scale * (1.0 + ROUNDING) - ray.skipped * (1.0 - ROUNDING);
        if reach.is_nan() || reach < 0.0 {
            return None;
        }
        let hit = match &self.cutouts {
            None => vectors::run(Closest { rays: self, solid: Whole, ray, limit: reach }),
            Some(cutouts) => vectors::run(Closest { rays: self, solid: cutouts, ray, limit: reach }),
        }?;
        let distance = (hit.distance.max(0.0) + ray.skipped) * self.metres;
        (distance <= limit).then_some(Hit { distance, ..hit })
    }

    /// True if nothing lies along the ray within `distance` (m, may be infinite), other than the triangle it starts
    /// `from`.
    pub fn visible(&self, origin: DVec3, direction: DVec3, distance: f64, from: Option<u32>) -> bool {
        let Some(ray) = &Ray::new(origin * self.scale, direction, from, self.bounds) else {
            return true;
        };
        let limit = distance * self.scale - ray.skipped - CLEARANCE;
        let nowhere = limit.is_nan() || limit <= 0.0;
        nowhere
            || match &self.cutouts {
                None => !vectors::run(Occluded { rays: self, solid: Whole, ray, limit }),
                Some(cutouts) => !vectors::run(Occluded { rays: self, solid: cutouts, ray, limit }),
            }
    }

    /// False for what lies behind the origin, for the triangle that the ray left, and for neighbours that rounding
    /// puts in its way.
    #[inline(always)]
    fn counts(&self, distance: f64, leaf: &Leaf, lane: usize, ray: &Ray) -> bool {
        let Some(from) = ray.from else {
            return distance >= 0.0;
        };
        let in_front = distance >= 0.0 && leaf.triangles[lane] != from;
        in_front && (distance > SELF_HIT_EPSILON || self.is_ahead(leaf, lane, from, ray.direction))
    }

    /// Whether a triangle reaches into the half-space that a ray goes to from the one that it left: if it lies in the
    /// same plane or bends away, it cannot be in the way, wherever rounding says that it is met.
    #[cold]
    #[inline(never)]
    fn is_ahead(&self, leaf: &Leaf, lane: usize, from: u32, direction: DVec3) -> bool {
        let place = self.places[from as usize] as usize;
        let [a, b, c] = self.leaves[place / 4].triangle(place % 4);
        let normal = (b - a).cross(c - a);
        let normal = if normal.dot(direction) < 0.0 { -normal } else { normal };
        let threshold = ROUNDING * normal.length();
        let offsets = leaf.triangle(lane).map(|v| v - a);
        offsets.iter().any(|offset| normal.dot(*offset) > threshold * offset.length())
    }
}

/// The power of two that scales `diagonal` to [`DIAGONAL`] or less, down to half of it.
fn scale_of(diagonal: f64) -> f64 {
    let scale = (DIAGONAL / diagonal).log2().floor().exp2();
    if diagonal * scale > DIAGONAL { scale / 2.0 } else { scale }
}

//! The triangles of the scaled mesh in their tree, and which of their crossings count as hits.

use super::{build::build, ray::Ray, tree::Tree, triangle::Leaf};
use glam::{DVec3, Vec3};

/// The diagonal of the scaled mesh is at most this, and more than half of it.
pub(super) const DIAGONAL: f64 = 1024.0;

/// A hit nearer than this share of the diagonal may be the surface that the ray left: rounding puts the crossing of a
/// triangle in the same plane anywhere up to 1e-16 over the cosine, and few rays have a cosine below 1e-10.
const SELF_HIT_EPSILON: f64 = 1e-6 * DIAGONAL;

/// More than the rounding of a few operations in float64, as a share.
pub(super) const ROUNDING: f64 = 1e-14;

/// A mesh that is scaled to [`DIAGONAL`], in its tree.
pub(super) struct ScaledMesh {
    pub tree: Tree,
    /// For each triangle of the mesh, four times the index of its leaf plus its lane there.
    slots: Vec<u32>,
}

impl ScaledMesh {
    /// Builds the tree over triangles that are scaled already.
    pub fn new(corners: &[[Vec3; 3]]) -> ScaledMesh {
        let tree = build(corners, DIAGONAL as f32);
        let mut slots = vec![0; corners.len()];
        for (k, leaf) in tree.leaves.iter().enumerate() {
            // Lanes that fill a leaf up repeat its first triangle: the lane of that is written last.
            (0..4).rev().for_each(|lane| slots[leaf.triangles[lane] as usize] = (4 * k + lane) as u32);
        }
        ScaledMesh { tree, slots }
    }

    /// False for crossings behind the origin, for the triangle that the ray left, and for its neighbors where only
    /// rounding puts them in the way.
    #[inline(always)]
    pub fn counts(&self, distance: f64, leaf: &Leaf, lane: usize, ray: &Ray) -> bool {
        let Some(from) = ray.from else {
            return distance >= 0.0;
        };
        let in_front = distance >= 0.0 && leaf.triangles[lane] != from;
        in_front && (distance > SELF_HIT_EPSILON || self.is_ahead(leaf, lane, from, ray.direction))
    }

    /// Whether a triangle reaches into the half-space that the ray enters as it leaves triangle `from`. If it lies in
    /// the same plane or bends away, it cannot be in the way, wherever rounding puts the crossing.
    #[cold]
    #[inline(never)]
    fn is_ahead(&self, leaf: &Leaf, lane: usize, from: u32, direction: DVec3) -> bool {
        let slot = self.slots[from as usize] as usize;
        let [a, b, c] = self.tree.leaves[slot / 4].triangle(slot % 4);
        let normal = (b - a).cross(c - a);
        let normal = if normal.dot(direction) < 0.0 { -normal } else { normal };
        let threshold = ROUNDING * normal.length();
        let offsets = leaf.triangle(lane).map(|v| v - a);
        offsets.iter().any(|offset| normal.dot(*offset) > threshold * offset.length())
    }
}

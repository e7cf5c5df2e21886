//! Holes in opaque surfaces, where their alpha is below a threshold.

use crate::scene::Scene;

/// The surfaces of a scene that have holes.
#[derive(Clone)]
pub(crate) struct Cutouts<'a> {
    scene: &'a Scene,
    /// For each material, the alpha below which its surfaces have holes.
    cutoffs: Vec<Option<f32>>,
}

impl<'a> Cutouts<'a> {
    /// None if no opaque surface has holes. Emitting surfaces have none: light is sampled on all of them.
    pub fn new(scene: &'a Scene, translucent: impl Fn(u16) -> bool) -> Option<Self> {
        let with_holes = |k: usize| !translucent(k as u16) && !scene.materials[k].emits();
        let cutoff = |k: usize| scene.materials[k].cutoff.filter(|_| with_holes(k));
        let cutoffs: Vec<Option<f32>> = (0..scene.materials.len()).map(cutoff).collect();
        cutoffs.iter().any(Option::is_some).then_some(Cutouts { scene, cutoffs })
    }

    /// Whether a triangle has a hole at the point with these barycentric weights.
    pub fn is_hole(&self, triangle: u32, weights: impl FnOnce() -> [f64; 3]) -> bool {
        let material = self.scene.mesh.triangles[triangle as usize].material;
        // Both are float32 in the file: an alpha that equals the cutoff in decimals must not be a hole.
        let alpha = || self.scene.color(triangle, weights()).w as f32;
        self.cutoffs[material as usize].is_some_and(|cutoff| alpha() < cutoff)
    }
}

//! Holes in opaque surfaces, where their alpha is below a threshold.

use crate::Scene;

/// The surfaces of a scene that have holes.
#[derive(Clone)]
pub(crate) struct Cutouts<'a> {
    scene: &'a Scene,
    /// For each material, below which alpha its surfaces have holes.
    cutoffs: Vec<Option<f32>>,
}

impl<'a> Cutouts<'a> {
    /// None if no opaque surface has holes. What emits has none: light is sampled on all of it.
    pub fn new(scene: &'a Scene, translucent: impl Fn(u16) -> bool) -> Option<Self> {
        let with_holes = |k: usize| !translucent(k as u16) && !scene.materials[k].emits();
        let cutoff = |k: usize| scene.materials[k].cutoff.filter(|_| with_holes(k));
        let cutoffs: Vec<Option<f32>> = (0..scene.materials.len()).map(cutoff).collect();
        cutoffs.iter().any(Option::is_some).then_some(Cutouts { scene, cutoffs })
    }

    /// Whether a triangle has a hole at the point with these barycentric weights.
    pub fn is_hole(&self, triangle: u32, weights: impl FnOnce() -> [f64; 3]) -> bool {
        let material = self.scene.mesh.triangles[triangle as usize].material;
        // In float32, as the file has both: an alpha that equals the cutoff in decimals is no hole.
        let alpha = || self.scene.color(triangle, weights()).w as f32;
        self.cutoffs[material as usize].is_some_and(|cutoff| alpha() < cutoff)
    }
}

impl Scene {
    /// Tells `put` all that holes depend on; nothing if there are none.
    pub(crate) fn note_cutouts(&self, put: &mut impl FnMut(&[u8])) {
        let with_holes = |k: u16| self.materials[k as usize].cutoff.is_some();
        for (k, material) in self.materials.iter().enumerate() {
            let Some(cutoff) = material.cutoff else { continue };
            put(b"holes");
            [k as f64, f64::from(cutoff), material.base_color.w].iter().for_each(|x| put(&x.to_le_bytes()));
            let Some(texture) = &material.base_texture else { continue };
            let how = texture.wrap.map(|w| w as u8);
            put(&[1, how[0], how[1], u8::from(texture.nearest)]);
            put(&(texture.picture.width as u64).to_le_bytes());
            put(&(texture.picture.texels.len() as u64).to_le_bytes());
            texture.picture.texels.chunks(1 << 12).for_each(|c| put(&c.iter().map(|t| t[3]).collect::<Vec<u8>>()));
        }
        for t in self.mesh.triangles.iter().filter(|t| with_holes(t.material)) {
            for i in t.vertices {
                let [u, v] = self.mesh.coordinates.get(i as usize).copied().unwrap_or_default();
                [u, v, self.mesh.vertex_color(i)[3]].iter().for_each(|x| put(&x.to_le_bytes()));
            }
        }
    }
}

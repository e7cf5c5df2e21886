//! What is lit and seen: a triangle mesh, its lights and cameras, and ray queries.
//!
//! Knows neither a medium nor how an image is made. Lengths are metres once imported. Positions are float32 relative
//! to [`Scene::origin`], the centre of the mesh in float64: an object far from the origin loses no digits.

mod cutouts;
mod error;
pub mod import;
pub mod light;
mod material;
mod mesh;
mod mesh_defects;
pub mod random;
mod rays;
pub mod sequence;
pub mod texture;
mod unhonoured;
mod view;
mod volume;
pub mod warp;

pub use error::{LostVolumes, SceneError};
pub use glam::{DVec3, DVec4, Vec3};
pub use import::{ImportOptions, LightUnit};
pub use material::Material;
pub use mesh::{Mesh, NormalKind, SurfacePoint, Triangle};
pub use mesh_defects::MeshDefects;
pub use rays::{Hit, Rays};
pub use view::{Camera, Projection, View, ViewFile};
pub use volume::{Scatter, ScatterExtension, Volume};

use std::{
    collections::{BTreeMap, BTreeSet},
    path::PathBuf,
};

/// An imported scene, checked: indices in range, every number finite, no triangle without area.
pub struct Scene {
    /// Every file that was read to make it, each once: its own, then buffers and pictures in the order of reading.
    pub files: Vec<PathBuf>,
    pub mesh: Mesh,
    pub materials: Vec<Material>,
    pub lights: Vec<Box<dyn light::Light>>,
    pub cameras: Vec<Camera>,
    /// World position of the mesh's centre, m.
    pub origin: DVec3,
    /// What was left out or looks wrong, one line each.
    pub warnings: Vec<String>,
    /// Triangles without area, left out: how many of which material.
    pub degenerate_triangles: BTreeMap<u16, u64>,
    /// Those of them that have area until positions are rounded to float32.
    pub rounded_triangles: BTreeMap<u16, u64>,
    /// Triangles at the place of another of their material, left out: how many of which material.
    pub duplicate_triangles: BTreeMap<u16, u64>,
    /// Materials that a primitive in the scene names, though it may have no triangle left.
    claimed: BTreeSet<u16>,
    /// What the file asks for and the picture does not show.
    unhonoured: Vec<unhonoured::Unhonoured>,
    /// Identity of the lights as the file gives them.
    pub light_digest: [u8; 32],
}

impl Scene {
    /// Materials whose surfaces bound media if nobody says which: those the file marks as volumes, or else all that do
    /// not emit; those only that cover a triangle, by index. True with them if the file marks none. A file whose marked
    /// surfaces are lost marks some nonetheless: that is a fault.
    pub fn translucent(&self) -> Result<(Vec<u16>, bool), LostVolumes> {
        let mut used = vec![false; self.materials.len()];
        self.mesh.triangles.iter().for_each(|t| used[t.material as usize] = true);
        let select = |accept: fn(&Material) -> bool| -> Vec<u16> {
            (0..used.len()).filter(|k| used[*k] && accept(&self.materials[*k])).map(|k| k as u16).collect()
        };
        let marked = select(|m| m.volume);
        if !marked.is_empty() {
            return Ok((marked, false));
        }
        let lost = self.lost_volumes();
        if lost.is_empty() { Ok((select(|m| !m.emits()), true)) } else { Err(LostVolumes::new(self, &lost)) }
    }

    /// Materials that the file marks as volumes and places, and that cover no triangle, by index.
    pub fn lost_volumes(&self) -> Vec<u16> {
        let mut lost = self.claimed.clone();
        lost.retain(|k| self.materials.get(usize::from(*k)).is_some_and(|m| m.volume));
        self.mesh.triangles.iter().for_each(|t| _ = lost.remove(&t.material));
        lost.into_iter().collect()
    }

    /// Area of the triangles of each material, m².
    pub fn area_of_materials(&self) -> Vec<f64> {
        let mut areas = vec![0.0; self.materials.len()];
        let triangles = self.mesh.triangles.iter().enumerate();
        triangles.for_each(|(k, t)| areas[usize::from(t.material)] += self.mesh.area(k));
        areas
    }

    /// Adds light from all around; a mere color is a constant radiance, W/(m² sr).
    pub fn add_environment(&mut self, environment: impl Into<light::Environment>) {
        let environment = environment.into();
        if !environment.is_black() {
            self.lights.push(Box::new(environment));
        }
    }

    /// Identity of the geometry, of which material covers which triangle, and of its colors and holes, as a BLAKE3 digest.
    pub fn geometry_digest(&self) -> [u8; 32] {
        let mut hasher = blake3::Hasher::new();
        let mut put = |bytes: &[u8]| {
            hasher.update(bytes);
        };
        self.origin.to_array().iter().for_each(|x| put(&x.to_le_bytes()));
        for v in self.mesh.positions.iter().chain(&self.mesh.normals) {
            v.to_array().iter().for_each(|x| put(&x.to_le_bytes()));
        }
        for t in &self.mesh.triangles {
            t.vertices.iter().for_each(|i| put(&i.to_le_bytes()));
            put(&t.material.to_le_bytes());
        }
        for m in &self.materials {
            put(&(m.name.len() as u64).to_le_bytes());
            put(m.name.as_bytes());
        }
        self.note_colors(&mut put);
        *hasher.finalize().as_bytes()
    }
}

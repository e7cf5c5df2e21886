//! What a surface looks like to light.

use crate::{Scene, texture::Texture, volume::Volume};
use glam::{DVec3, DVec4};
use std::{collections::BTreeMap, sync::Arc};

/// What a surface looks like to light, apart from any medium below it.
#[derive(Clone, Debug, PartialEq)]
pub struct Material {
    pub name: String,
    /// Diffuse albedo of an opaque surface, and alpha: times that of texture and vertices.
    pub base_color: DVec4,
    pub base_texture: Option<Texture>,
    /// Where alpha is less, an opaque surface has a hole.
    pub cutoff: Option<f32>,
    /// Radiance it emits, W/(m² sr).
    pub emission: DVec3,
    /// The file marks the surface as the boundary of a volume.
    pub volume: bool,
    /// What the file says of that volume, if it does.
    pub medium: Option<Volume>,
    /// Emits to both sides.
    pub double_sided: bool,
}

impl Material {
    /// True if any channel emits.
    pub fn emits(&self) -> bool {
        self.emission != DVec3::ZERO
    }
}

impl Scene {
    /// Diffuse albedo of an opaque surface, and alpha, at a point with these barycentric weights.
    pub fn color(&self, triangle: u32, weights: [f64; 3]) -> DVec4 {
        let material = &self.materials[self.mesh.triangles[triangle as usize].material as usize];
        let texture = material.base_texture.as_ref();
        let seen = texture.map_or(DVec4::ONE, |t| t.at(self.mesh.coordinates(triangle, weights)));
        material.base_color * seen * self.mesh.color(triangle, weights)
    }

    /// Tells `put` all that colors and holes depend on: they light and shadow what is sampled.
    pub(crate) fn note_colors(&self, put: &mut impl FnMut(&[u8])) {
        // A picture of many materials is noted once, and then by its number.
        let mut numbers = BTreeMap::new();
        for material in &self.materials {
            let cutoff = material.cutoff.map_or(f64::INFINITY, f64::from);
            material.base_color.to_array().iter().chain([&cutoff]).for_each(|x| put(&x.to_le_bytes()));
            let Some(texture) = &material.base_texture else { continue };
            let [along, down] = texture.wrap.map(|w| w as u8);
            let next = numbers.len() as u64;
            let number = *numbers.entry(Arc::as_ptr(&texture.picture)).or_insert(next);
            let known = number < next;
            put(&[1 + u8::from(known), along, down, u8::from(texture.nearest)]);
            if known {
                put(&number.to_le_bytes());
                continue;
            }
            put(&(texture.picture.width as u64).to_le_bytes());
            put(&(texture.picture.texels.len() as u64).to_le_bytes());
            put(texture.picture.texels.as_flattened());
        }
        self.mesh.coordinates.as_flattened().iter().for_each(|x| put(&x.to_le_bytes()));
        self.mesh.colors.as_flattened().iter().for_each(|x| put(&x.to_le_bytes()));
    }

    /// Adds a warning for each translucent material whose texture, alpha or vertex colors are not used.
    pub fn warn_of_colors(&mut self, translucent: impl Fn(u16) -> bool) {
        let mut colored = vec![false; self.materials.len()];
        for t in &self.mesh.triangles {
            colored[t.material as usize] |= t.vertices.iter().any(|i| self.mesh.vertex_color(*i) != [1.0; 4]);
        }
        for (k, material) in self.materials.iter().enumerate() {
            let unused = [
                (material.base_texture.is_some(), "base color texture"),
                (material.cutoff.is_some(), "alphaMode MASK"),
                (colored[k], "vertex colors"),
            ];
            let unused: Vec<&str> = unused.iter().filter(|u| u.0).map(|u| u.1).collect();
            if translucent(k as u16) && !unused.is_empty() {
                let Material { name, .. } = material;
                let what = unused.join(", ");
                self.warnings.push(format!("material `{name}`: not used on a translucent surface: {what}"));
            }
        }
    }
}

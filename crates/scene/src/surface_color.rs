//! Colors of surfaces: material, texture and vertices together.

use crate::scene::Scene;
use glam::DVec4;

impl Scene {
    /// Diffuse albedo of an opaque surface, and alpha, at the point of a triangle with these barycentric weights.
    pub fn color(&self, triangle: u32, weights: [f64; 3]) -> DVec4 {
        let material = &self.materials[self.mesh.triangles[triangle as usize].material as usize];
        let texture = material.base_texture.as_ref();
        let texel = texture.map_or(DVec4::ONE, |t| t.at(self.mesh.coordinates(triangle, weights)));
        material.base_color * texel * self.mesh.color(triangle, weights)
    }
}

//! The colors of textures over a surface, with alpha.

use crate::{scene::Scene, warp};
use glam::{DVec3, DVec4};

/// Points on the surface of a material; each triangle has one at least.
const POINTS: f64 = 65_536.0;

/// Steps of the sequence R2 (Roberts 2018): the inverse of the plastic number, and its square.
const STEPS: [f64; 2] = [0.754_877_666_246_692_8, 0.569_840_290_998_053_3];

/// What textures say at a point of a translucent surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TextureColor {
    /// The base color without its factor, and alpha, which blends media.
    pub base: DVec4,
    /// The color after multiple scattering, as a factor of that of the file; 1 without its texture.
    pub scatter: DVec3,
}

impl TextureColor {
    /// Both in one, with alpha.
    fn whole(&self) -> DVec4 {
        self.base * self.scatter.extend(1.0)
    }
}

impl Scene {
    /// The colors at the point of a triangle with these barycentric weights, without their factors, that tint translucent
    /// surfaces.
    pub fn texture_color(&self, triangle: u32, weights: [f64; 3]) -> TextureColor {
        let material = &self.materials[self.mesh.triangles[triangle as usize].material as usize];
        let texture = material.base_texture.as_ref();
        let texel = texture.map_or(DVec4::ONE, |t| t.at(self.mesh.coordinates(triangle, weights)));
        let scatter = material.scatter_texture.as_ref();
        let scatter = scatter.map_or(DVec4::ONE, |t| t.at(self.mesh.scatter_coordinates(1, triangle, weights)));
        TextureColor { base: texel * self.mesh.color(triangle, weights), scatter: scatter.truncate() }
    }

    /// Gives media whose color a texture states that of its mean over the surface.
    pub(crate) fn take_mean_colors(&mut self) {
        for k in 0..self.materials.len() {
            let material = &self.materials[k];
            let is_textured = material.scatter_texture.is_some() && !self.is_wall(k as u16);
            if !is_textured || material.medium.as_ref().is_none_or(|medium| medium.scatter.is_none()) {
                continue;
            }
            let mean = SurfaceColors::new(self, k as u16).scatter_mean();
            let medium = self.materials[k].medium.as_mut();
            medium.and_then(|medium| medium.scatter.as_mut()).into_iter().for_each(|scatter| scatter.color *= mean);
        }
    }
}

/// Colors at points of a surface, with the area that each stands for.
pub struct SurfaceColors {
    colors: Vec<(TextureColor, f64)>,
    /// The mean of both colors in one.
    pub mean: DVec4,
}

impl SurfaceColors {
    /// Those of a material's surface, without the factors of its colors.
    pub fn new(scene: &Scene, material: u16) -> SurfaceColors {
        let mesh = &scene.mesh;
        let own: Vec<u32> =
            (0..mesh.triangles.len() as u32).filter(|k| mesh.triangles[*k as usize].material == material).collect();
        let total: f64 = own.iter().map(|k| mesh.area(*k as usize)).sum();
        let of_triangle = |k: &u32| {
            let k = *k;
            let area = mesh.area(k as usize);
            let count = (POINTS * area / total).ceil().clamp(1.0, POINTS) as u32;
            let start = f64::from(k);
            let color = move |n: u32| {
                let at = |d: usize| ((start + 0.5) * STEPS[1 - d] + f64::from(n) * STEPS[d]).fract();
                (scene.texture_color(k, warp::triangle([at(0), at(1)])), area / f64::from(count))
            };
            (0..count).map(color)
        };
        let colors: Vec<(TextureColor, f64)> = own.iter().flat_map(of_triangle).collect();
        let sum = colors.iter().map(|(color, area)| color.whole() * *area).sum::<DVec4>();
        SurfaceColors { mean: if total > 0.0 { sum / total } else { DVec4::ONE }, colors }
    }

    /// The mean of the color after multiple scattering.
    pub fn scatter_mean(&self) -> DVec3 {
        DVec3::from_array([0, 1, 2].map(|c| self.mean_of(|color| color.scatter[c])))
    }

    /// The mean of a function of the colors; 0 without any.
    pub fn mean_of(&self, value: impl Fn(&TextureColor) -> f64) -> f64 {
        let add = |(sum, all): (f64, f64), (color, area): &(TextureColor, f64)| (sum + value(color) * area, all + area);
        let (sum, all) = self.colors.iter().fold((0.0, 0.0), add);
        if all > 0.0 { sum / all } else { 0.0 }
    }
}

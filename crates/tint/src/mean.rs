//! The colors of a texture over a surface.

use glam::DVec3;
use rayon::prelude::*;
use scene::{Scene, warp};

/// Points on the surface of a material; each triangle has one at least.
const POINTS: f64 = 65_536.0;

/// Steps of the sequence R2 (Roberts 2018): the inverse of the plastic number, and its square.
const STEPS: [f64; 2] = [0.754_877_666_246_692_8, 0.569_840_290_998_053_3];

/// Colors at points of a surface, with the area that each stands for.
pub struct Mean {
    colors: Vec<(DVec3, f64)>,
    pub color: DVec3,
}

impl Mean {
    pub fn new(scene: &Scene, material: u16) -> Mean {
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
        let colors: Vec<(DVec3, f64)> = own.par_iter().flat_map_iter(of_triangle).collect();
        let sum = colors.iter().map(|(color, area)| *color * *area).sum::<DVec3>();
        Mean { color: if total > 0.0 { sum / total } else { DVec3::ONE }, colors }
    }

    /// The share of the surface whose colors are such.
    pub fn share(&self, is_such: impl Fn(DVec3) -> bool) -> f64 {
        let (such, all) = self.colors.iter().fold((0.0, 0.0), |(such, all), (color, area)| {
            (if is_such(*color) { such + area } else { such }, all + area)
        });
        if all > 0.0 { such / all } else { 0.0 }
    }
}

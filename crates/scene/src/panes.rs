//! Sheets, which have no inside. Panes are of clear glass: a ray goes straight on, or is mirrored, by Fresnel's
//! equations. Thin walls scatter light to both sides.

use crate::{material::Material, mesh::Mesh};
use bsdf::fresnel;
use glam::DVec3;

/// A surface of area `A` that encloses less than this share of `A^(3/2)` is a sheet. A ball encloses 0.094, a cube
/// 0.068, a square plate whose thickness is a thirtieth of its edge 0.01.
const LARGEST_SHARE: f64 = 0.01;

/// A surface without an inside.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Sheet {
    /// Clear glass of this relative index.
    Pane(f64),
    /// As the material's `wall` says.
    Wall,
}

/// For each material, whether its surface is a sheet. Solids of clear glass are none; what scatters is a wall if the file
/// says so, whatever its shape. No surface is a sheet if no other translucent one is in the scene: someone wants them to be
/// seen as solids.
pub(crate) fn find(mesh: &Mesh, materials: &[Material]) -> Vec<Option<Sheet>> {
    let mut sheets: Vec<Option<Sheet>> = vec![None; materials.len()];
    if !materials.iter().any(|m| m.thin || m.wall.is_some()) {
        return sheets;
    }
    let mut shapes = vec![Shape::default(); materials.len()];
    for (k, t) in mesh.triangles.iter().enumerate() {
        shapes[usize::from(t.material)].add(mesh.corners(k));
    }
    for (sheet, (material, shape)) in sheets.iter_mut().zip(materials.iter().zip(&shapes)) {
        let ior = material.medium.as_ref().map(|medium| medium.ior);
        let pane = ior.filter(|_| material.thin && shape.is_sheet()).map(Sheet::Pane);
        *sheet = material.wall.as_ref().map(|_| Sheet::Wall).or(pane);
    }
    let is_solid = |(k, m): (usize, &Material)| m.volume && sheets[k].is_none() && shapes[k].area > 0.0;
    if materials.iter().enumerate().any(is_solid) { sheets } else { vec![None; materials.len()] }
}

/// Sums over the triangles of a surface.
#[derive(Clone, Default)]
struct Shape {
    area: f64,
    /// Sum of the vectors whose lengths are the areas, and their products with positions.
    vector: DVec3,
    volume: f64,
    middle: DVec3,
}

impl Shape {
    fn add(&mut self, [a, b, c]: [DVec3; 3]) {
        let vector = 0.5 * (b - a).cross(c - a);
        let (area, middle) = (vector.length(), (a + b + c) / 3.0);
        self.area += area;
        self.vector += vector;
        self.volume += vector.dot(middle) / 3.0;
        self.middle += middle * area;
    }

    /// The volume is that of the cone from the middle of the surface to all of it.
    fn is_sheet(&self) -> bool {
        let volume = self.volume - self.vector.dot(self.middle) / self.area / 3.0;
        self.area > 0.0 && volume.abs() < LARGEST_SHARE * self.area.powf(1.5)
    }
}

/// The share of light that a pane mirrors, all reflections between its two sides included: `2R/(1+R)`.
pub(crate) fn reflectance(cosine: f64, ior: f64) -> f64 {
    let once = 1.0 - fresnel::transmittance(cosine.abs(), ior);
    2.0 * once / (1.0 + once)
}

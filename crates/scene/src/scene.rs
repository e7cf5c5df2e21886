//! The scene as it is imported.

use crate::{
    error::{LostVolumes, SceneError},
    import::units::FileUnits,
    light::{contract::Light, environment::Environment},
    material::{GlossStated, Material, Wall, WallShares},
    mesh::{Mesh, bounds},
    panes::Sheet,
    unhonoured::Unhonoured,
    view::Camera,
};
use bsdf::ThinWall;
use glam::{DVec3, DVec4};
use std::{
    collections::{BTreeMap, BTreeSet},
    path::PathBuf,
};

/// An imported scene, checked: indices are in range, every number is finite, and every triangle has an area.
pub struct Scene {
    /// Every file that was read to make the scene, each once: its own, then buffers and pictures in the order of
    /// reading.
    pub files: Vec<PathBuf>,
    pub mesh: Mesh,
    pub materials: Vec<Material>,
    /// Lights and emitting materials of the file; [`Scene::lights`] gives the environment as well.
    pub file_lights: Vec<Box<dyn Light>>,
    /// Light from all around, black unless it was set: glTF has none.
    pub environment: Environment,
    pub cameras: Vec<Camera>,
    /// World position of the mesh's center, m.
    pub origin: DVec3,
    /// The time and animation that pose the scene; empty at rest.
    pub pose: String,
    /// The units of the file's lights and emitting materials.
    pub units: FileUnits,
    /// Warnings about parts that were left out or look wrong, one line each.
    pub warnings: Vec<String>,
    /// For each material, how many triangles were left out because they have no area.
    pub degenerate_triangles: BTreeMap<u16, u64>,
    /// How many of those have an area until positions are rounded to float32.
    pub rounded_triangles: BTreeMap<u16, u64>,
    /// For each material, how many triangles were left out because another of the same material has the same corners.
    pub duplicate_triangles: BTreeMap<u16, u64>,
    /// For each material, whether its surface is a sheet without an inside.
    pub(crate) sheets: Vec<Option<Sheet>>,
    /// Why the base color texture of a material cannot be read: a fault only where an opaque surface needs it.
    pub(crate) texture_faults: BTreeMap<u16, String>,
    /// Materials that a primitive of the scene names, though it may have no triangle left.
    pub(crate) claimed: BTreeSet<u16>,
    /// Properties of the file that the image does not show.
    pub(crate) unhonoured: Vec<Unhonoured>,
}

impl Scene {
    /// All lights: those of the file, then the environment unless it is black.
    pub fn lights(&self) -> impl Iterator<Item = &dyn Light> {
        let environment = Some(&self.environment as &dyn Light).filter(|_| !self.environment.is_black());
        self.file_lights.iter().map(|light| &**light).chain(environment)
    }

    /// Indices of the materials whose surfaces bound media by default: those that the file marks as translucent or, if it
    /// marks none, all that are no lamps, with `true` for the latter. Only materials that cover a triangle count. It is
    /// an error if the file marks materials and none of them covers a triangle.
    pub fn translucent(&self) -> Result<(Vec<u16>, bool), LostVolumes> {
        let mut used = vec![false; self.materials.len()];
        self.mesh.triangles.iter().for_each(|t| used[t.material as usize] = true);
        let select = |accept: fn(&Material) -> bool| -> Vec<u16> {
            (0..used.len()).filter(|k| used[*k] && accept(&self.materials[*k])).map(|k| k as u16).collect()
        };
        let marked: Vec<u16> = select(|m| m.volume).into_iter().filter(|k| !self.is_sheet(*k)).collect();
        if !marked.is_empty() {
            return Ok((marked, false));
        }
        let lost = self.lost_volumes();
        if lost.is_empty() { Ok((select(|m| !m.is_lamp()), true)) } else { Err(self.lost(&lost)) }
    }

    /// Indices of the materials that the file marks as volumes and uses, and that cover no triangle.
    pub fn lost_volumes(&self) -> Vec<u16> {
        let mut lost = self.claimed.clone();
        lost.retain(|k| self.materials.get(usize::from(*k)).is_some_and(|m| m.volume));
        self.mesh.triangles.iter().for_each(|t| _ = lost.remove(&t.material));
        lost.into_iter().collect()
    }

    /// Whether the file has a light that is meant to light the scene. A surface with a few glowing spots is none.
    pub fn has_lamp(&self) -> bool {
        let is_lamp = |material: &Material| !self.file_lights.is_empty() && material.is_lamp();
        self.file_lights.iter().any(|light| light.delta().is_some()) || self.materials.iter().any(is_lamp)
    }

    /// The box around the triangles of these materials, m from the origin; empty if there are none.
    pub fn bounds_of(&self, is_of: impl Fn(u16) -> bool) -> (DVec3, DVec3) {
        bounds(self.corners_of(is_of))
    }

    /// The corners of the triangles of these materials, m from the origin.
    pub(crate) fn corners_of(&self, is_of: impl Fn(u16) -> bool) -> impl Iterator<Item = DVec3> {
        let own = self.mesh.triangles.iter().enumerate().filter(move |(_, t)| is_of(t.material));
        own.flat_map(|(k, _)| self.mesh.corners(k))
    }

    /// Area of the triangles of each material, m².
    pub fn area_of_materials(&self) -> Vec<f64> {
        let mut areas = vec![0.0; self.materials.len()];
        let triangles = self.mesh.triangles.iter().enumerate();
        triangles.for_each(|(k, t)| areas[usize::from(t.material)] += self.mesh.area(k));
        areas
    }

    /// Diffuse albedo of an opaque surface, and alpha, at the point of a triangle with these barycentric weights.
    pub fn color(&self, triangle: u32, weights: [f64; 3]) -> DVec4 {
        let material = &self.materials[self.mesh.triangles[triangle as usize].material as usize];
        let texture = material.base_texture.as_ref();
        let texel = texture.map_or(DVec4::ONE, |t| t.at(self.mesh.coordinates(triangle, weights)));
        material.base_color * texel * self.mesh.color(triangle, weights)
    }

    /// Whether the surface of a material has no inside, and is not translucent by default.
    pub(crate) fn is_sheet(&self, material: u16) -> bool {
        self.sheets.get(usize::from(material)).is_some_and(Option::is_some)
    }

    /// Whether the surface of a material is a sheet of clear glass, which rays pass or are mirrored by. It is none where it
    /// is sampled as translucent.
    pub fn is_pane(&self, material: u16) -> bool {
        matches!(self.sheets.get(usize::from(material)), Some(Some(Sheet::Pane(_))))
    }

    /// Whether it is a thin wall, which scatters light to both sides. It is none where it is sampled as translucent.
    pub fn is_wall(&self, material: u16) -> bool {
        self.sheets.get(usize::from(material)) == Some(&Some(Sheet::Wall))
    }

    /// The thin wall at the point of a triangle with these barycentric weights, if its surface is one.
    pub fn wall(&self, triangle: u32, weights: [f64; 3]) -> Option<ThinWall> {
        let material = self.mesh.triangles[triangle as usize].material;
        let wall = self.materials[usize::from(material)].wall.as_ref().filter(|_| self.is_wall(material))?;
        let shares = self.wall_shares(wall, triangle, weights);
        let color = self.color(triangle, weights).truncate();
        Some(ThinWall { back: shares.base * color + shares.back, through: shares.through })
    }

    /// The shares of a thin wall at the point of a triangle.
    pub(crate) fn wall_shares(&self, wall: &Wall, triangle: u32, weights: [f64; 3]) -> WallShares {
        let texel = |k: usize| {
            let texture = wall.textures[k].as_ref()?;
            Some(texture.at(self.mesh.scatter_coordinates(k, triangle, weights)))
        };
        wall.shares(texel(0).map_or(1.0, |texel| texel.w), texel(1).map_or(DVec3::ONE, DVec4::truncate))
    }

    /// How an opaque surface mirrors at the point of a triangle with these barycentric weights; none if it is matt.
    pub fn gloss(&self, triangle: u32, weights: [f64; 3]) -> Option<bsdf::Stated> {
        let material = &self.materials[self.mesh.triangles[triangle as usize].material as usize];
        let gloss = material.gloss.as_ref()?;
        let [metallic, roughness] = self.metallic_roughness(gloss, triangle, weights);
        let base_color = self.color(triangle, weights).truncate().clamp(DVec3::ZERO, DVec3::ONE);
        Some(bsdf::Stated { base_color, metallic, roughness, dielectric: gloss.dielectric })
    }

    /// The roughness at the point of a triangle, 0 to 1; none if the material states none.
    pub fn roughness(&self, triangle: u32, weights: [f64; 3]) -> Option<f64> {
        let material = &self.materials[self.mesh.triangles[triangle as usize].material as usize];
        material.gloss.as_ref().map(|gloss| self.metallic_roughness(gloss, triangle, weights)[1])
    }

    fn metallic_roughness(&self, gloss: &GlossStated, triangle: u32, weights: [f64; 3]) -> [f64; 2] {
        let texel = gloss.texture.as_ref().map(|t| t.numbers_at(self.mesh.gloss_coordinates(triangle, weights)));
        gloss.with(texel.unwrap_or(DVec4::ONE))
    }

    /// Share of diffuse light that an opaque surface reflects diffusely: nothing where it is a metal.
    pub fn diffuse(&self, triangle: u32, weights: [f64; 3]) -> DVec3 {
        let color = self.color(triangle, weights).truncate();
        match &self.materials[self.mesh.triangles[triangle as usize].material as usize].gloss {
            None => color,
            Some(gloss) => color * (1.0 - self.metallic_roughness(gloss, triangle, weights)[0]),
        }
    }

    /// Radiance that the point of a triangle with these barycentric weights emits, W/(m² sr).
    pub fn emission(&self, triangle: u32, weights: [f64; 3]) -> DVec3 {
        let material = &self.materials[self.mesh.triangles[triangle as usize].material as usize];
        match &material.emission_texture {
            Some(texture) => {
                material.emission * texture.at(self.mesh.emission_coordinates(triangle, weights)).truncate()
            }
            None => material.emission,
        }
    }

    /// Refuses a base color texture that cannot be read, if an opaque surface needs it.
    pub fn check_textures(&self, translucent: impl Fn(u16) -> bool) -> Result<(), SceneError> {
        let mut used = vec![false; self.materials.len()];
        self.mesh.triangles.iter().for_each(|t| used[t.material as usize] = true);
        let needed = |k: &u16| used.get(usize::from(*k)) == Some(&true) && !translucent(*k);
        match self.texture_faults.iter().find(|(k, _)| needed(k)) {
            Some((_, what)) => {
                let path = self.files.first().cloned().unwrap_or_default();
                Err(SceneError::Invalid { path, what: what.clone() })
            }
            None => Ok(()),
        }
    }

    fn lost(&self, materials: &[u16]) -> LostVolumes {
        let names: Vec<&str> = materials.iter().map(|k| self.materials[usize::from(*k)].name.as_str()).collect();
        let sum = |counts: &BTreeMap<u16, u64>| materials.iter().filter_map(|k| counts.get(k)).sum::<u64>();
        LostVolumes::new(&names, sum(&self.degenerate_triangles), sum(&self.rounded_triangles))
    }
}

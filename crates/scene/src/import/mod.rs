//! glTF to [`Scene`]: parse, check, then trust.
//!
//! The container, every index, range and component type are checked here; the gltf crate's own validation is not used
//! because it panics on some files. Node transforms are read in float64 and positions are rounded to float32 only
//! after they are made relative to the centre of the mesh.

mod accessor;
mod cameras;
mod clipping;
mod concerns;
mod container;
mod duplicates;
mod features;
pub(crate) mod files;
mod geometry;
mod honoured;
mod jpeg;
mod lights;
mod materials;
mod nodes;
mod number;
mod primitive;
mod survey;
mod textures;
mod volumes;

use crate::{
    Material, Scene, SceneError,
    light::Light,
    mesh::Mesh,
    unhonoured::{quoted, rest},
};
use concerns::RenderedParts;
use container::Document;
use geometry::{Geometry, Instance};
use gltf::json::{Index, Root};
use nodes::Placed;
use primitive::MeshParts;
use std::{
    collections::{BTreeMap, BTreeSet},
    path::{Path, PathBuf},
};

/// How to read the numbers of a file.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ImportOptions {
    /// Size of one unit of the file, m.
    pub metres_per_unit: f64,
    /// Of directional, point and spot lights.
    pub light_unit: LightUnit,
    /// Of emitting materials.
    pub emission_unit: LightUnit,
}

/// What the light numbers of a file mean. Those of lights and of emitting materials need not mean the same: Blender
/// multiplies the first by 683 lm/W and writes the second as they are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LightUnit {
    /// W/m², W/sr, W/(m² sr).
    Radiometric,
    /// Lux, candela, nit: divided by 683 lm/W.
    Photometric,
}

impl LightUnit {
    /// Factor that turns the file's numbers into watts.
    fn watts(self) -> f64 {
        match self {
            LightUnit::Radiometric => 1.0,
            LightUnit::Photometric => 1.0 / 683.0,
        }
    }
}

/// A fault in the file, still without its name.
type Fault = String;

impl Scene {
    /// Reads a .glb or .gltf file.
    pub fn import(path: &Path, options: &ImportOptions) -> Result<Scene, SceneError> {
        let document = Document::read(path)?;
        import(&document, options).map_err(|what| SceneError::Invalid { path: path.to_owned(), what })
    }

    /// The files that a scene consists of: itself, and those in its folder or below that its buffers and images name,
    /// whether or not they are there or anything uses them.
    pub fn files_of(path: &Path) -> Result<Vec<PathBuf>, SceneError> {
        let document = Document::read(path)?;
        let buffers = document.root.buffers.iter().filter_map(|buffer| buffer.uri.as_ref());
        let images = document.root.images.iter().filter_map(|image| image.uri.as_ref());
        let uris = buffers.chain(images).filter(|uri| !uri.starts_with("data:"));
        let named: BTreeSet<PathBuf> =
            uris.filter_map(|uri| document.files.borrow().place(uri).ok()).map(|(path, _)| path).collect();
        Ok(std::iter::once(path.to_owned()).chain(named).collect())
    }
}

fn import(document: &Document, options: &ImportOptions) -> Result<Scene, Fault> {
    let root = &document.root;
    let mut warnings = Vec::new();
    features::check(document)?;
    let nodes = nodes::place(document, options.metres_per_unit)?;
    features::check_nodes(root, &nodes, &mut warnings)?;
    let mut materials = materials::read(document, options, &mut warnings)?;
    let Geometry { mut mesh, origin, degenerate, rounded } = geometry(document, &nodes, &mut warnings)?;
    if mesh.triangles.iter().any(|t| usize::from(t.material) == materials.len()) {
        materials.push(materials::default());
    }
    tell_lost(&mesh, &materials, &degenerate, &mut warnings);
    let duplicates = duplicates::drop_duplicates(&mut mesh, &materials);
    if !duplicates.is_empty() {
        let count: u64 = duplicates.values().sum();
        warnings.push(format!("{count} triangles lie exactly on others of their material and are left out"));
    }
    let mut lights = lights::punctual(root, &nodes, options, origin, &mut warnings)?;
    lights.add_emitters(&mesh, &materials);
    let metres_per_unit = options.metres_per_unit;
    let cameras = cameras::read(root, &nodes, metres_per_unit)?;
    let drawn = RenderedParts { mesh: &mesh, nodes: &nodes, cameras: &cameras, origin, metres_per_unit };
    let unhonoured = [features::undeclared_effects(document), concerns::of(document, &drawn)].concat();
    Ok(Scene {
        files: document.files.borrow().read().to_owned(),
        claimed: claimed(root, &nodes),
        mesh,
        materials,
        lights: lights.list,
        cameras,
        origin,
        warnings,
        degenerate_triangles: degenerate,
        rounded_triangles: rounded,
        duplicate_triangles: duplicates,
        unhonoured,
        light_digest: *lights.digest.finalize().as_bytes(),
    })
}

/// The triangles of all nodes. Each mesh is checked once, however often it is placed.
fn geometry(document: &Document, nodes: &[Placed], warnings: &mut Vec<String>) -> Result<Geometry, Fault> {
    let meshes = &document.root.meshes;
    let mut parts: Vec<Option<MeshParts>> = meshes.iter().map(|_| None).collect();
    let mut instances = Vec::new();
    for placed in nodes {
        let Some(index) = &placed.node.mesh else { continue };
        let mesh = get(meshes, index, "node.mesh")?;
        instances.push((index.value(), placed));
        if parts[index.value()].is_none() {
            let name = mesh.name.as_deref().unwrap_or(&placed.name);
            parts[index.value()] = Some(MeshParts::new(document, mesh, name, warnings)?);
        }
    }
    let with_parts = |(k, placed): (usize, _)| Some(Instance { parts: parts[k].as_ref()?, placed });
    let instances: Vec<Instance> = instances.into_iter().filter_map(with_parts).collect();
    let geometry = geometry::join(&instances)?;
    Ok(geometry)
}

/// Says how many triangles had no area, and which materials have none left.
fn tell_lost(mesh: &Mesh, materials: &[Material], degenerate: &BTreeMap<u16, u64>, warnings: &mut Vec<String>) {
    const NAMED: usize = 3;
    let count: u64 = degenerate.values().sum();
    if count == 0 {
        return;
    }
    let mut lost: BTreeSet<u16> = degenerate.keys().copied().collect();
    mesh.triangles.iter().for_each(|t| _ = lost.remove(&t.material));
    let names: Vec<String> = lost
        .iter()
        .take(NAMED)
        .map(|k| quoted(materials.get(usize::from(*k)).map_or("default", |m| &m.name)))
        .collect();
    let all = if names.is_empty() { "" } else { ", all of " };
    let (names, more) = (names.join(", "), rest(lost.len().saturating_sub(NAMED)));
    warnings.push(format!("{count} triangles without area are left out{all}{names}{more}"));
}

/// Materials of the primitives that the scene places, whatever becomes of their triangles.
fn claimed(root: &Root, nodes: &[Placed]) -> BTreeSet<u16> {
    let meshes: BTreeSet<usize> = nodes.iter().filter_map(|placed| Some(placed.node.mesh.as_ref()?.value())).collect();
    let primitives = meshes.into_iter().filter_map(|k| root.meshes.get(k)).flat_map(|mesh| &mesh.primitives);
    primitives.filter_map(|p| u16::try_from(p.material.as_ref()?.value()).ok()).collect()
}

/// An element of a list of the file, by an index that the file gives.
fn get<'a, T>(list: &'a [T], index: &Index<T>, field: &str) -> Result<&'a T, Fault> {
    let i = index.value();
    list.get(i).ok_or_else(|| format!("{field}: index {i} is out of range, there are {}", list.len()))
}

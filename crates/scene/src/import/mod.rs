//! The import of glTF as a [`Scene`].
//!
//! The container, all indices, ranges and component types are checked here: the validation of the gltf crate panics on
//! some files and is not used. Node transforms are read in float64, and positions are rounded to float32 after they are
//! made relative to the center of the mesh.

mod accessor;
mod base_color;
mod cameras;
mod clipping;
mod container;
mod draco;
mod duplicates;
mod extras;
mod fault;
mod features;
pub(crate) mod files;
mod foreign;
mod geometry;
mod gloss;
mod honoured;
mod instancing;
mod jpeg;
mod lights;
mod materials;
mod meshopt;
mod nodes;
mod options;
mod pose;
mod primitive;
mod skin;
mod survey;
mod tangents;
mod text;
mod textures;
mod transform;
mod unhonoured;
pub(crate) mod units;
mod volumes;

use crate::{
    error::SceneError,
    light::Environment,
    material::Material,
    mesh::Mesh,
    panes,
    scene::Scene,
    unhonoured::{first_of, quoted},
};
use container::Document;
use fault::{Refusal, get};
use geometry::{Geometry, Instance};
use glam::DVec3;
use gltf::json::Root;
use instancing::Copies;
use materials::ReadMaterials;
use nodes::SceneNode;
pub use options::{ImportOptions, LightUnit, Pose};
use pose::Posed;
use primitive::CheckedMesh;
use skin::Skins;
use std::{
    collections::{BTreeMap, BTreeSet},
    path::{Path, PathBuf},
};
use unhonoured::RenderedParts;
pub use units::FileUnits;

impl Scene {
    /// Reads a .glb or .gltf file.
    pub fn import(path: &Path, options: &ImportOptions) -> Result<Scene, SceneError> {
        let document = Document::read(path)?;
        import(&document, options).map_err(|refusal| match refusal {
            Refusal::Invalid(what) => SceneError::Invalid { path: path.to_owned(), what },
            Refusal::NoPose(what) => SceneError::Pose { path: path.to_owned(), what },
            Refusal::TooLarge => SceneError::TooLarge { path: path.to_owned() },
        })
    }

    /// The files that a scene consists of: itself, and those in its folder or below that its buffers and images name,
    /// whether or not they are there or anything uses them.
    pub fn files_of(path: &Path) -> Result<Vec<PathBuf>, SceneError> {
        let document = Document::read(path)?;
        let buffers = document.root.buffers.iter().filter_map(|buffer| buffer.uri.as_ref());
        let images = document.root.images.iter().filter_map(|image| image.uri.as_ref());
        let uris = buffers.chain(images).filter(|uri| !uri.starts_with("data:"));
        let named: BTreeSet<PathBuf> =
            uris.filter_map(|uri| document.files.borrow().locate(uri).ok()).map(|(path, _)| path).collect();
        Ok(std::iter::once(path.to_owned()).chain(named).collect())
    }
}

fn import(document: &Document, options: &ImportOptions) -> Result<Scene, Refusal> {
    let root = &document.root;
    let mut warnings = Vec::new();
    let posed = pose::of(document, options.pose.as_ref(), &mut warnings)?;
    let nodes = nodes::in_world(document, &posed.transforms, options.metres_per_unit, &mut warnings)?;
    let units = units::decide(root, &nodes, options);
    let (metres_per_unit, claimed) = (options.metres_per_unit, claimed(root, &nodes));
    let context = materials::Context { document, metres_per_unit, units: &units, used: &claimed };
    let ReadMaterials { mut materials, faults: texture_faults, of_solids } = materials::read(&context, &mut warnings)?;
    let placed = geometry(document, &nodes, &posed, &mut warnings)?;
    let Geometry { mut mesh, origin, normal_coordinates, tangents, degenerate, rounded } = placed;
    if mesh.triangles.iter().any(|t| usize::from(t.material) == materials.len()) {
        materials.push(materials::default());
    }
    warn_of_lost(&mesh, &materials, &degenerate, &mut warnings);
    let duplicates = duplicates::drop_duplicates(&mut mesh, &materials);
    if !duplicates.is_empty() {
        let count: u64 = duplicates.values().sum();
        warnings.push(format!("{count} triangles lie exactly on others of their material and are left out"));
    }
    mesh.bumps = tangents::bumps(&mesh, &materials, normal_coordinates, &tangents, &mut warnings).map(Box::new);
    let mut lights = lights::punctual(root, &nodes, (metres_per_unit, &units), origin, &mut warnings)?;
    lights.extend(lights::emitters(&mesh, &materials));
    let cameras = cameras::read(root, &nodes, metres_per_unit)?;
    let parts = RenderedParts { mesh: &mesh, nodes: &nodes, cameras: &cameras, origin, metres_per_unit };
    let unhonoured = [features::undeclared_effects(root, &document.survey), unhonoured::of(document, &parts)].concat();
    let sheets = panes::find(&mesh, &materials);
    warnings.extend(of_solids.into_iter().filter(|(k, _)| sheets[usize::from(*k)].is_none()).map(|(_, note)| note));
    let mut scene = Scene {
        sheets,
        files: document.files.borrow().read.clone(),
        claimed,
        texture_faults,
        mesh,
        materials,
        file_lights: lights,
        environment: Environment::Constant(DVec3::ZERO),
        cameras,
        origin,
        pose: posed.name,
        units,
        warnings,
        degenerate_triangles: degenerate,
        rounded_triangles: rounded,
        duplicate_triangles: duplicates,
        unhonoured,
    };
    scene.take_mean_colors();
    Ok(scene)
}

/// The triangles of all nodes. A mesh is checked once, for any number of nodes.
fn geometry(
    document: &Document,
    nodes: &[SceneNode],
    posed: &Posed,
    warnings: &mut Vec<String>,
) -> Result<Geometry, Refusal> {
    let meshes = &document.root.meshes;
    let mut parts: Vec<Option<CheckedMesh>> = meshes.iter().map(|_| None).collect();
    let mut placed_meshes = Vec::new();
    for placed in nodes {
        let Some(index) = &placed.node.mesh else { continue };
        let mesh = get(meshes, index, "node.mesh")?;
        placed_meshes.push((index.value(), placed));
        if parts[index.value()].is_none() {
            let name = mesh.name.as_deref().unwrap_or(&placed.name);
            parts[index.value()] = Some(CheckedMesh::new(document, mesh, name, warnings)?);
        }
    }
    let skins = Skins::new(document, nodes)?;
    let mut instances = Vec::with_capacity(placed_meshes.len());
    for (k, placed) in placed_meshes {
        let Some(parts) = &parts[k] else { continue };
        let node = placed.node;
        let copies = Copies::of(document, node).map_err(|e| format!("node `{}`: {e}", placed.name))?;
        // The weights of a pose, of the node, of the mesh: the first of them counts.
        let of_file = node.weights.as_ref().or(meshes[k].weights.as_ref());
        let weights = posed.weights.get(&placed.index).or(of_file).map_or(&[][..], Vec::as_slice);
        let joints = node.skin.as_ref().and_then(|skin| skins.of(skin));
        instances.push(Instance { parts, placed, copies, weights, joints });
    }
    geometry::join(&instances)
}

/// Warns of triangles without area, and names the materials that have no others.
fn warn_of_lost(mesh: &Mesh, materials: &[Material], degenerate: &BTreeMap<u16, u64>, warnings: &mut Vec<String>) {
    const NAMED: usize = 3;
    let count: u64 = degenerate.values().sum();
    if count == 0 {
        return;
    }
    let mut lost: BTreeSet<u16> = degenerate.keys().copied().collect();
    mesh.triangles.iter().for_each(|t| _ = lost.remove(&t.material));
    let name = |k: &u16| quoted(materials.get(usize::from(*k)).map_or("default", |m| &m.name));
    let all = if lost.is_empty() { "" } else { ", all of " };
    let names = first_of(lost.iter().map(name), NAMED);
    warnings.push(format!("{count} triangles without area are left out{all}{names}"));
}

/// Materials of all primitives in the scene, even of those whose triangles are left out.
fn claimed(root: &Root, nodes: &[SceneNode]) -> BTreeSet<u16> {
    let meshes: BTreeSet<usize> = nodes.iter().filter_map(|placed| Some(placed.node.mesh.as_ref()?.value())).collect();
    let primitives = meshes.into_iter().filter_map(|k| root.meshes.get(k)).flat_map(|mesh| &mesh.primitives);
    primitives.filter_map(|p| u16::try_from(p.material.as_ref()?.value()).ok()).collect()
}

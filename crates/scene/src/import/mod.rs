//! glTF to [`Scene`]: parse, check, then trust.
//!
//! The container, every index, range and component type are checked here; the gltf crate's own validation is not used
//! because it panics on some files. Node transforms are read in float64 and positions are rounded to float32 only
//! after they are made relative to the centre of the mesh.

mod accessor;
mod container;
mod features;
mod geometry;
mod lights;

use crate::{Camera, Material, Projection, Scene, SceneError, light::Light};
use accessor::Buffers;
use container::Document;
use geometry::GeometryBuilder;
use glam::{DMat4, DVec3};
use gltf::json::{self, Index, validation::Checked};
use std::path::Path;

/// How to read the numbers of a file.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ImportOptions {
    /// Size of one unit of the file, m.
    pub metres_per_unit: f64,
    pub light_unit: LightUnit,
}

/// What the light numbers of a file mean.
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
        Importer::new(&document, options)
            .and_then(Importer::import)
            .map_err(|what| SceneError::Invalid { path: path.to_owned(), what })
    }
}

/// A node placed in the world.
struct Placed<'a> {
    node: &'a json::Node,
    name: String,
    /// To metres.
    transform: DMat4,
}

struct Importer<'a> {
    root: &'a json::Root,
    buffers: Buffers<'a>,
    options: &'a ImportOptions,
    nodes: Vec<Placed<'a>>,
    warnings: Vec<String>,
}

impl<'a> Importer<'a> {
    fn new(document: &'a Document, options: &'a ImportOptions) -> Result<Self, Fault> {
        let root = &document.root;
        let mut warnings = features::check(root)?;
        let nodes = place_nodes(document, options.metres_per_unit)?;
        features::check_nodes(root, &nodes, &mut warnings)?;
        let buffers = Buffers { root, data: &document.buffers };
        Ok(Importer { root, buffers, options, nodes, warnings })
    }

    fn import(mut self) -> Result<Scene, Fault> {
        let mut materials = self.materials()?;
        let mut builder = GeometryBuilder::new(self.buffers, materials.len());
        for placed in &self.nodes {
            if let Some(index) = &placed.node.mesh {
                builder.add(get(&self.root.meshes, index, "node.mesh")?, placed)?;
            }
        }
        if builder.uses_default_material {
            materials.push(default_material());
        }
        let geometry = builder.finish()?;
        self.warnings.extend(geometry.warnings);
        let (mesh, origin) = (geometry.mesh, geometry.origin);
        let mut lights = lights::punctual(self.root, &self.nodes, self.options, origin, &mut self.warnings)?;
        lights.add_emitters(&mesh, &materials);
        Ok(Scene {
            mesh,
            materials,
            lights: lights.list,
            cameras: self.cameras()?,
            origin,
            warnings: self.warnings,
            degenerate_triangles: geometry.degenerate,
            light_digest: *lights.digest.finalize().as_bytes(),
        })
    }

    fn materials(&mut self) -> Result<Vec<Material>, Fault> {
        let mut materials = Vec::new();
        for (k, m) in self.root.materials.iter().enumerate() {
            let name = m.name.clone().unwrap_or_else(|| format!("material{k}"));
            materials.push(self.material(name, m)?);
        }
        Ok(materials)
    }

    fn material(&mut self, name: String, m: &json::Material) -> Result<Material, Fault> {
        let extensions = m.extensions.as_ref();
        let strength = extensions
            .and_then(|e| e.emissive_strength.as_ref())
            .map_or(1.0, |s| f64::from(s.emissive_strength.0));
        let emission = DVec3::from_array(m.emissive_factor.0.map(f64::from)) * strength;
        let [r, g, b, _] = m.pbr_metallic_roughness.base_color_factor.0.map(f64::from);
        let base_color = DVec3::new(r, g, b);
        for (field, value) in [("emissiveFactor", emission), ("baseColorFactor", base_color)] {
            if !value.is_finite() || value.min_element() < 0.0 {
                return Err(format!("material `{name}`: {field} {value} must be finite and not negative"));
            }
        }
        if m.pbr_metallic_roughness.base_color_texture.is_some() {
            self.warnings.push(format!("material `{name}`: the base colour texture is not used, its factor is"));
        }
        if m.emissive_texture.is_some() {
            self.warnings.push(format!("material `{name}`: the emissive texture is not used, its factor is"));
        }
        let scatters = ["KHR_materials_volume_scatter", "KHR_materials_scatter"];
        let volume = extensions.is_some_and(|e| {
            e.volume.as_ref().is_some_and(|v| v.thickness_factor.0 > 0.0)
                || scatters.iter().any(|s| e.others.contains_key(*s))
        });
        let emission = emission * self.options.light_unit.watts();
        Ok(Material { name, base_color, emission, volume, double_sided: m.double_sided })
    }

    fn cameras(&self) -> Result<Vec<Camera>, Fault> {
        let mut cameras = Vec::new();
        for placed in &self.nodes {
            let Some(index) = &placed.node.camera else { continue };
            let camera = get(&self.root.cameras, index, "node.camera")?;
            cameras.push(self.camera(placed, camera)?);
        }
        Ok(cameras)
    }

    fn camera(&self, placed: &Placed, camera: &json::Camera) -> Result<Camera, Fault> {
        let fault = |what: &str| format!("camera of node `{}`: {what}", placed.name);
        let (projection, aspect) = match (&camera.type_, &camera.perspective, &camera.orthographic) {
            (Checked::Valid(json::camera::Type::Perspective), Some(p), _) => {
                let tangent = (0.5 * f64::from(p.yfov)).tan();
                if !(p.yfov > 0.0 && tangent > 0.0 && tangent.is_finite()) {
                    return Err(fault("yfov must lie between 0 and pi"));
                }
                (Projection::Perspective { tangent }, p.aspect_ratio.map(f64::from))
            }
            (Checked::Valid(json::camera::Type::Orthographic), _, Some(o)) => {
                let half_height = f64::from(o.ymag) * self.options.metres_per_unit;
                if !(half_height > 0.0 && half_height.is_finite()) {
                    return Err(fault("ymag must be positive"));
                }
                (Projection::Orthographic { half_height }, Some(f64::from(o.xmag) / f64::from(o.ymag)))
            }
            _ => return Err(fault("neither a perspective nor an orthographic projection")),
        };
        if aspect.is_some_and(|a| !(a > 0.0 && a.is_finite())) {
            return Err(fault("the aspect ratio must be positive"));
        }
        Camera::of_node(placed.name.clone(), &placed.transform, projection, aspect)
            .ok_or_else(|| fault("its node's matrix has no direction (scale 0?)"))
    }
}

fn default_material() -> Material {
    Material {
        name: "default".into(),
        base_color: DVec3::splat(0.8),
        emission: DVec3::ZERO,
        volume: false,
        double_sided: false,
    }
}

/// An element of a list of the file, by an index that the file gives.
fn get<'a, T>(list: &'a [T], index: &Index<T>, field: &str) -> Result<&'a T, Fault> {
    let i = index.value();
    list.get(i).ok_or_else(|| format!("{field}: index {i} is out of range, there are {}", list.len()))
}

/// The nodes of the default scene with their world transforms; refuses anything but a forest.
fn place_nodes(document: &Document, metres_per_unit: f64) -> Result<Vec<Placed<'_>>, Fault> {
    let root = &document.root;
    let mut stack = Vec::new();
    let world = DMat4::from_scale(DVec3::splat(metres_per_unit));
    for index in root_nodes(root)?.into_iter().rev() {
        stack.push((index, world));
    }
    let mut seen = vec![false; root.nodes.len()];
    let mut placed = Vec::new();
    while let Some((index, parent)) = stack.pop() {
        let node = root.nodes.get(index).ok_or_else(|| format!("node index {index} is out of range"))?;
        let name = node.name.clone().unwrap_or_else(|| format!("node{index}"));
        if std::mem::replace(&mut seen[index], true) {
            return Err(format!("node `{name}` is reached twice: the nodes must form a tree"));
        }
        let transform = parent * document.local_transform(index);
        if !transform.is_finite() {
            return Err(format!("node `{name}`: its transform is not finite"));
        }
        for child in node.children.iter().flatten().rev() {
            stack.push((child.value(), transform));
        }
        placed.push(Placed { node, name, transform });
    }
    Ok(placed)
}

/// Roots of the default scene, of the first one, or all nodes that are nobody's child.
fn root_nodes(root: &json::Root) -> Result<Vec<usize>, Fault> {
    let scene = match &root.scene {
        Some(index) => Some(get(&root.scenes, index, "scene")?),
        None => root.scenes.first(),
    };
    if let Some(scene) = scene {
        return Ok(scene.nodes.iter().map(|n| n.value()).collect());
    }
    let mut is_child = vec![false; root.nodes.len()];
    for child in root.nodes.iter().flat_map(|n| n.children.iter().flatten()) {
        if let Some(flag) = is_child.get_mut(child.value()) {
            *flag = true;
        }
    }
    Ok((0..root.nodes.len()).filter(|k| !is_child[*k]).collect())
}

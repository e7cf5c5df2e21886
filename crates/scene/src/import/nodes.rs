//! The nodes in use with their world transforms in float64; they form a forest, or the file is refused.

use super::{Fault, container::Document, get};
use glam::{DMat4, DQuat, DVec3, DVec4};
use gltf::json;
use serde::Deserialize;

/// A node's own transform, as the file has it.
#[derive(Deserialize)]
pub(super) struct NodeTransform {
    matrix: Option<[f64; 16]>,
    translation: Option<[f64; 3]>,
    rotation: Option<[f64; 4]>,
    scale: Option<[f64; 3]>,
}

/// A node placed in the world.
pub(super) struct Placed<'a> {
    pub node: &'a json::Node,
    /// In the file's list.
    pub index: usize,
    pub name: String,
    /// To metres.
    pub transform: DMat4,
}

impl NodeTransform {
    fn matrix(&self) -> Result<DMat4, Fault> {
        if let Some(m) = &self.matrix {
            if self.translation.is_some() || self.rotation.is_some() || self.scale.is_some() {
                return Err("`matrix` excludes `translation`, `rotation` and `scale`".into());
            }
            return affine(m);
        }
        let rotation = DQuat::from_array(self.rotation.unwrap_or([0.0, 0.0, 0.0, 1.0]));
        let length = rotation.length();
        if !(length > 0.0 && length.is_finite()) {
            return Err(format!("`rotation` {rotation} is no unit quaternion"));
        }
        let scale = DVec3::from_array(self.scale.unwrap_or([1.0; 3]));
        let translation = DVec3::from_array(self.translation.unwrap_or([0.0; 3]));
        Ok(DMat4::from_scale_rotation_translation(scale, rotation / length, translation))
    }
}

/// A matrix by columns, whose last row must be that of an affine map: nothing here divides by w.
fn affine(m: &[f64; 16]) -> Result<DMat4, Fault> {
    const ROUNDING: f64 = 1e-6; // of writers that compute in float32
    let row = DVec4::new(m[3], m[7], m[11], m[15]);
    if !row.abs_diff_eq(DVec4::W, ROUNDING) {
        return Err(format!("the last row of `matrix` is {row}, not [0, 0, 0, 1]"));
    }
    let mut columns = *m;
    (columns[3], columns[7], columns[11], columns[15]) = (0.0, 0.0, 0.0, 1.0);
    Ok(DMat4::from_cols_array(&columns))
}

/// The nodes of the default scene with their world transforms; refuses anything but a forest.
pub(super) fn place(document: &Document, metres_per_unit: f64) -> Result<Vec<Placed<'_>>, Fault> {
    let root = &document.root;
    let world = DMat4::from_scale(DVec3::splat(metres_per_unit));
    let mut stack: Vec<_> = root_nodes(root)?.into_iter().rev().map(|index| (index, world)).collect();
    let mut seen = vec![false; root.nodes.len()];
    let mut placed = Vec::new();
    while let Some((index, parent)) = stack.pop() {
        let (Some(node), Some(own)) = (root.nodes.get(index), document.transforms.get(index)) else {
            return Err(format!("node index {index} is out of range, there are {}", root.nodes.len()));
        };
        let name = node.name.clone().unwrap_or_else(|| format!("node{index}"));
        if std::mem::replace(&mut seen[index], true) {
            return Err(format!("node `{name}` is reached twice: the nodes must form a tree"));
        }
        let transform = parent * own.matrix().map_err(|e| format!("node `{name}`: {e}"))?;
        if !transform.is_finite() {
            return Err(format!("node `{name}`: its transform is not finite"));
        }
        stack.extend(node.children.iter().flatten().rev().map(|child| (child.value(), transform)));
        placed.push(Placed { node, index, name, transform });
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

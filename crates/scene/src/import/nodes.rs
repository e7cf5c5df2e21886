//! The nodes of the scene with their world transforms in float64. A file is refused unless they form a forest.

use super::{
    container::Document,
    fault::{Result, get},
    transform::NodeTransform,
};
use crate::unhonoured::quoted;
use glam::{DMat4, DVec3};
use gltf::json;

/// A node of the scene.
pub(super) struct SceneNode<'a> {
    pub node: &'a json::Node,
    /// Index in the file.
    pub index: usize,
    pub name: String,
    /// From the node to the world, m.
    pub transform: DMat4,
}

/// The nodes of the default scene with their world transforms, from those to their parents.
pub(super) fn in_world<'a>(
    document: &'a Document,
    transforms: &[NodeTransform],
    metres_per_unit: f64,
    warnings: &mut Vec<String>,
) -> Result<Vec<SceneNode<'a>>> {
    let root = &document.root;
    let world = DMat4::from_scale(DVec3::splat(metres_per_unit));
    let mut stack: Vec<_> = root_nodes(root, warnings)?.into_iter().rev().map(|index| (index, world)).collect();
    let mut seen = vec![false; root.nodes.len()];
    let mut placed = Vec::new();
    while let Some((index, parent)) = stack.pop() {
        let (Some(node), Some(own)) = (root.nodes.get(index), transforms.get(index)) else {
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
        placed.push(SceneNode { node, index, name, transform });
    }
    Ok(placed)
}

/// Roots of the default scene, or of the first scene, or all nodes without a parent. A scene without nodes is legal;
/// whoever renders the file wants what is in it.
fn root_nodes(root: &json::Root, warnings: &mut Vec<String>) -> Result<Vec<usize>> {
    let scene = match &root.scene {
        Some(index) => Some(get(&root.scenes, index, "scene")?),
        None => root.scenes.first(),
    };
    if let Some(scene) = scene.filter(|scene| !scene.nodes.is_empty()) {
        return Ok(scene.nodes.iter().map(|n| n.value()).collect());
    }
    if let Some(scene) = scene.filter(|_| !root.nodes.is_empty()) {
        let name = scene.name.as_deref().map_or_else(|| "without a name".into(), quoted);
        warnings.push(format!("the scene {name} lists no nodes: all nodes of the file are shown"));
    }
    let mut is_child = vec![false; root.nodes.len()];
    for child in root.nodes.iter().flat_map(|n| n.children.iter().flatten()) {
        if let Some(flag) = is_child.get_mut(child.value()) {
            *flag = true;
        }
    }
    Ok((0..root.nodes.len()).filter(|k| !is_child[*k]).collect())
}

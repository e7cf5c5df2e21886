//! Features that are not supported: an error where the image would be wrong, else a warning.

use super::{container::Document, fault::Result, honoured, nodes::SceneNode};
use crate::unhonoured::{Holder, Unhonoured, first_of, quoted};
use gltf::json;
use std::collections::BTreeSet;

/// Extensions that a file may require.
const SUPPORTED: &[&str] = &[
    "KHR_lights_punctual",
    "KHR_materials_emissive_strength",
    "KHR_materials_ior",
    "KHR_materials_scatter",
    "KHR_materials_transmission",
    "KHR_materials_volume",
    "KHR_materials_volume_scatter",
    "KHR_mesh_quantization",
    "KHR_texture_transform",
];

/// Whether an extension changes materials or their pictures alone. Without one that is not honoured the image is
/// plainer, and a warning names it; a picture that cannot be read is a fault only where it is needed.
fn is_appearance(name: &str) -> bool {
    name.starts_with("KHR_materials_") || ["EXT_texture_webp", "KHR_texture_basisu"].contains(&name)
}

/// Extensions that change the geometry, with the way out. Without them the image would be wrong, whether they are
/// required or not.
const GEOMETRY: &[(&str, &str)] = &[
    ("KHR_draco_mesh_compression", "export again without compression"),
    ("EXT_meshopt_compression", "export again without compression"),
    ("KHR_meshopt_compression", "export again without compression"),
    ("EXT_mesh_gpu_instancing", "export again with instances as nodes"),
    ("KHR_node_visibility", "delete what is hidden and export again"),
];

/// Refuses required extensions that are unknown, and used ones that change the geometry, declared or not.
pub(super) fn check(document: &Document) -> Result<()> {
    let root = &document.root;
    for name in &root.extensions_required {
        if !SUPPORTED.contains(&name.as_str()) && !is_appearance(name) {
            let hint = GEOMETRY.iter().find(|(n, _)| n == name).map_or("export again without it", |(_, hint)| hint);
            return Err(format!("extensionsRequired: {name} is not supported; {hint}"));
        }
    }
    for (name, hint) in GEOMETRY {
        if root.extensions_used.iter().chain(&document.survey.extensions).any(|n| n == name) {
            return Err(format!("extensionsUsed: {name} is not supported; {hint}"));
        }
    }
    Ok(())
}

/// Unknown extensions that the file declares but has no object of, so that their effect is unknown. Others are named
/// where their objects are.
pub(super) fn undeclared_effects(document: &Document) -> Vec<Unhonoured> {
    let declared: BTreeSet<&String> = document.root.extensions_used.iter().collect();
    let means_something = |name: &str| {
        let found = honoured::look_up(honoured::DOCUMENT, &format!("extensions.{name}"));
        !SUPPORTED.contains(&name) && found == honoured::Lookup::Unknown
    };
    let unseen = declared.into_iter().filter(|name| !document.survey.extensions.contains(*name));
    let named = unseen.filter(|name| means_something(name)).map(|name| Unhonoured {
        property: "extensionsUsed[]".into(),
        holder: Some(Holder::Named(name.clone())),
        on: [Some(&[]); 2],
    });
    named.collect()
}

/// Number of animations that a warning names.
const NAMED: usize = 3;

/// Refuses poses that are not baked into the mesh: skins, morph targets, and animations of a mesh or its ancestors.
pub(super) fn check_nodes(root: &json::Root, nodes: &[SceneNode], warnings: &mut Vec<String>) -> Result<()> {
    const BAKE: &str = "apply the pose to the mesh and export again";
    // Once for each mesh, for any number of nodes.
    let morphs = |p: &json::mesh::Primitive| p.targets.as_ref().is_some_and(|t| !t.is_empty());
    let morphs: Vec<bool> = root.meshes.iter().map(|mesh| mesh.primitives.iter().any(morphs)).collect();
    for placed in nodes {
        let Some(morphs) = placed.node.mesh.as_ref().and_then(|m| morphs.get(m.value())) else {
            continue;
        };
        if placed.node.skin.is_some() {
            return Err(format!("node `{}`: skinned meshes are not supported; {BAKE}", placed.name));
        }
        if *morphs {
            return Err(format!("node `{}`: morph targets are not supported; {BAKE}", placed.name));
        }
    }
    let moves_a_mesh = above_meshes(root);
    let mut unused = Vec::new();
    for (k, animation) in root.animations.iter().enumerate() {
        let name = animation.name.clone().unwrap_or_else(|| format!("animation{k}"));
        let targets = animation.channels.iter().map(|c| c.target.node.value());
        if let Some(node) = targets.into_iter().find(|n| moves_a_mesh.get(*n) == Some(&true)) {
            return Err(format!("animation `{name}` moves a mesh (node {node}), which is not supported; {BAKE}"));
        }
        unused.push(name);
    }
    if !unused.is_empty() {
        let names = first_of(unused.iter().map(|name| quoted(name)), NAMED);
        warnings.push(format!("animations are not used, and cameras and lights stay at rest: {names}"));
    }
    Ok(())
}

/// For each node, whether it or a descendant carries a mesh. Nodes outside the scene need not form a tree, so that each
/// is visited once.
fn above_meshes(root: &json::Root) -> Vec<bool> {
    let mut parents = vec![Vec::new(); root.nodes.len()];
    for (k, node) in root.nodes.iter().enumerate() {
        for child in node.children.iter().flatten() {
            if let Some(list) = parents.get_mut(child.value()) {
                list.push(k);
            }
        }
    }
    let mut above = vec![false; root.nodes.len()];
    let mut stack: Vec<usize> = (0..root.nodes.len()).filter(|k| root.nodes[*k].mesh.is_some()).collect();
    while let Some(index) = stack.pop() {
        if !std::mem::replace(&mut above[index], true) {
            stack.extend(&parents[index]);
        }
    }
    above
}

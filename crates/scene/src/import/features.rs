//! Features that are not supported: an error where the image would be wrong, else a warning.

use super::{fault::Result, honoured, survey::Survey, text::Text};
use crate::unhonoured::{Holder, Unhonoured};
use gltf::json::Root;
use std::collections::BTreeSet;

/// Extensions that a file may require.
const SUPPORTED: &[&str] = &[
    "EXT_mesh_gpu_instancing",
    "EXT_meshopt_compression",
    "KHR_animation_pointer",
    "KHR_draco_mesh_compression",
    "KHR_lights_punctual",
    "KHR_materials_emissive_strength",
    "KHR_materials_ior",
    "KHR_materials_scatter",
    "KHR_materials_transmission",
    "KHR_materials_volume",
    "KHR_materials_volume_scatter",
    "KHR_mesh_quantization",
    "KHR_meshopt_compression",
    "KHR_texture_transform",
];

/// Whether an extension changes materials or their pictures alone. Without one that is not honoured the image is
/// plainer, and a warning names it; a picture that cannot be read is a fault only where it is needed.
fn is_appearance(name: &str) -> bool {
    name.starts_with("KHR_materials_") || ["EXT_texture_webp", "KHR_texture_basisu"].contains(&name)
}

/// Extensions that change the geometry, with the way out. Without them the image would be wrong, whether they are
/// required or not.
const GEOMETRY: &[(&str, &str)] = &[("KHR_node_visibility", "delete what is hidden and export again")];

/// Refuses required extensions that are unknown, and used ones that change the geometry, declared or not.
pub(super) fn check(text: &Text) -> Result<()> {
    let root = &text.root;
    for name in &root.extensions_required {
        if !SUPPORTED.contains(&name.as_str()) && !is_appearance(name) {
            let hint = GEOMETRY.iter().find(|(n, _)| n == name).map_or("export again without it", |(_, hint)| hint);
            return Err(format!("extensionsRequired: {name} is not supported; {hint}"));
        }
    }
    for (name, hint) in GEOMETRY {
        if root.extensions_used.iter().chain(&text.survey.extensions).any(|n| n == name) {
            return Err(format!("extensionsUsed: {name} is not supported; {hint}"));
        }
    }
    Ok(())
}

/// Unknown extensions that the file declares but has no object of, so that their effect is unknown. Others are named
/// where their objects are.
pub(super) fn undeclared_effects(root: &Root, survey: &Survey) -> Vec<Unhonoured> {
    let declared: BTreeSet<&String> = root.extensions_used.iter().collect();
    let means_something = |name: &str| {
        let found = honoured::look_up(honoured::DOCUMENT, &format!("extensions.{name}"));
        !SUPPORTED.contains(&name) && found == honoured::Lookup::Unknown
    };
    let unseen = declared.into_iter().filter(|name| !survey.extensions.contains(*name));
    let named = unseen.filter(|name| means_something(name)).map(|name| Unhonoured {
        property: "extensionsUsed[]".into(),
        holder: Some(Holder::Named(name.clone())),
        on: [Some(&[]); 2],
    });
    named.collect()
}

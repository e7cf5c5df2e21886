//! The table of glTF properties and how each is honoured. Properties outside the table are not honoured, and a warning
//! names them.
//!
//! A path starts at an element of a list of the file. `[]` stands for any index, and a final `*` for any ending.
//! `name`, `extras` and metadata have no effect anywhere.

/// How a property is honoured.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Fate {
    /// The image shows it.
    Shown,
    /// It changes no image by itself.
    Neutral,
    /// An error or a warning of its own names it.
    Reported,
    /// The image is made as if the first numbers of the property were these; other values are named.
    TakenAs(&'static [f64]),
    /// Not shown, and without effect if its first numbers are these.
    Unless(&'static [f64]),
    /// Not shown, and named where it would cut anything off.
    Cuts,
    /// Not shown.
    No,
}

/// Properties that are honoured alike.
pub(super) struct Row {
    pub list: &'static str,
    pub paths: &'static [&'static str],
    pub opaque: Fate,
    pub translucent: Fate,
}

/// Lists of the file whose elements have properties. An element counts only if the image shows it or it lights the
/// scene.
pub(super) const LISTS: &[&str] =
    &[MATERIALS, TEXTURES, SAMPLERS, IMAGES, MESHES, NODES, LIGHTS, CAMERAS, SCENES, ACCESSORS, VIEWS, BUFFERS];

pub(super) const MATERIALS: &str = "materials";
pub(super) const TEXTURES: &str = "textures";
pub(super) const SAMPLERS: &str = "samplers";
pub(super) const IMAGES: &str = "images";
pub(super) const MESHES: &str = "meshes";
pub(super) const NODES: &str = "nodes";
pub(super) const LIGHTS: &str = "extensions.KHR_lights_punctual.lights";
pub(super) const CAMERAS: &str = "cameras";
pub(super) const SCENES: &str = "scenes";
pub(super) const ACCESSORS: &str = "accessors";
pub(super) const VIEWS: &str = "bufferViews";
pub(super) const BUFFERS: &str = "buffers";
/// The document itself.
pub(super) const DOCUMENT: &str = "";

/// Properties without effect anywhere.
pub(super) const ANYWHERE: &[&str] = &["name", "extras", "extensions.KHR_xmp", "extensions.KHR_xmp_json_ld"];

const fn row(list: &'static str, fate: Fate, paths: &'static [&'static str]) -> Row {
    Row { list, paths, opaque: fate, translucent: fate }
}

const fn material(opaque: Fate, translucent: Fate, paths: &'static [&'static str]) -> Row {
    Row { list: MATERIALS, paths, opaque, translucent }
}

use Fate::{Cuts, Neutral, No, Reported, Shown, TakenAs, Unless};

// rustfmt would break the rows.
#[rustfmt::skip]
pub(super) const TABLE: &[Row] = &[
    material(Shown, Shown, &["emissiveFactor", "extensions.KHR_materials_emissive_strength.emissiveStrength", "doubleSided"]),
    material(Shown, TakenAs(&[1.0, 1.0, 1.0]), &["pbrMetallicRoughness.baseColorFactor"]),
    material(Shown, Shown, &["pbrMetallicRoughness.baseColorTexture.index", "pbrMetallicRoughness.baseColorTexture.texCoord",
        "pbrMetallicRoughness.baseColorTexture.extensions.KHR_texture_transform.offset",
        "pbrMetallicRoughness.baseColorTexture.extensions.KHR_texture_transform.rotation",
        "pbrMetallicRoughness.baseColorTexture.extensions.KHR_texture_transform.scale",
        "pbrMetallicRoughness.baseColorTexture.extensions.KHR_texture_transform.texCoord"]),
    material(Shown, Reported, &["alphaMode", "alphaCutoff"]),
    material(Shown, Shown, &["emissiveTexture.index", "emissiveTexture.texCoord",
        "emissiveTexture.extensions.KHR_texture_transform.offset", "emissiveTexture.extensions.KHR_texture_transform.rotation",
        "emissiveTexture.extensions.KHR_texture_transform.scale", "emissiveTexture.extensions.KHR_texture_transform.texCoord"]),
    material(Shown, TakenAs(&[1.0, 1.0, 1.0]), &["extensions.KHR_materials_pbrSpecularGlossiness.diffuseFactor"]),
    material(Shown, Shown, &["extensions.KHR_materials_pbrSpecularGlossiness.diffuseTexture.index",
        "extensions.KHR_materials_pbrSpecularGlossiness.diffuseTexture.texCoord",
        "extensions.KHR_materials_pbrSpecularGlossiness.diffuseTexture.extensions.KHR_texture_transform.offset",
        "extensions.KHR_materials_pbrSpecularGlossiness.diffuseTexture.extensions.KHR_texture_transform.rotation",
        "extensions.KHR_materials_pbrSpecularGlossiness.diffuseTexture.extensions.KHR_texture_transform.scale",
        "extensions.KHR_materials_pbrSpecularGlossiness.diffuseTexture.extensions.KHR_texture_transform.texCoord"]),
    material(Shown, TakenAs(&[0.0]), &["pbrMetallicRoughness.metallicFactor"]),
    material(Shown, Shown, &["pbrMetallicRoughness.roughnessFactor", "pbrMetallicRoughness.metallicRoughnessTexture.index",
        "pbrMetallicRoughness.metallicRoughnessTexture.texCoord",
        "pbrMetallicRoughness.metallicRoughnessTexture.extensions.KHR_texture_transform.offset",
        "pbrMetallicRoughness.metallicRoughnessTexture.extensions.KHR_texture_transform.rotation",
        "pbrMetallicRoughness.metallicRoughnessTexture.extensions.KHR_texture_transform.scale",
        "pbrMetallicRoughness.metallicRoughnessTexture.extensions.KHR_texture_transform.texCoord"]),
    material(No, No, &["occlusionTexture"]),
    material(Shown, Shown, &["normalTexture.index", "normalTexture.texCoord", "normalTexture.scale",
        "normalTexture.extensions.KHR_texture_transform.offset", "normalTexture.extensions.KHR_texture_transform.rotation",
        "normalTexture.extensions.KHR_texture_transform.scale", "normalTexture.extensions.KHR_texture_transform.texCoord"]),
    material(Shown, Shown, &["extensions.KHR_materials_ior.ior"]),
    material(Unless(&[0.0]), TakenAs(&[1.0]), &["extensions.KHR_materials_transmission.transmissionFactor"]),
    material(No, No, &["extensions.KHR_materials_transmission.transmissionTexture"]),
    material(Unless(&[0.0]), TakenAs(&[1.0]), &["extensions.KHR_materials_diffuse_transmission.diffuseTransmissionFactor"]),
    material(Neutral, Unless(&[1.0, 1.0, 1.0]), &["extensions.KHR_materials_diffuse_transmission.diffuseTransmissionColorFactor"]),
    // Thin walls are among the opaque surfaces.
    material(Shown, No, &["extensions.KHR_materials_diffuse_transmission.diffuseTransmissionTexture",
        "extensions.KHR_materials_diffuse_transmission.diffuseTransmissionColorTexture",
        "extensions.KHR_materials_scatter.scatterStrengthTexture"]),
    material(Shown, Shown, &["extensions.KHR_materials_scatter.multiscatterColorTexture.index", "extensions.KHR_materials_scatter.multiscatterColorTexture.texCoord",
        "extensions.KHR_materials_scatter.multiscatterColorTexture.extensions.KHR_texture_transform.offset",
        "extensions.KHR_materials_scatter.multiscatterColorTexture.extensions.KHR_texture_transform.rotation",
        "extensions.KHR_materials_scatter.multiscatterColorTexture.extensions.KHR_texture_transform.scale",
        "extensions.KHR_materials_scatter.multiscatterColorTexture.extensions.KHR_texture_transform.texCoord"]),
    material(Unless(&[0.0]), Shown, &["extensions.KHR_materials_volume.thicknessFactor"]),
    material(Neutral, Shown, &["extensions.KHR_materials_volume.attenuationDistance", "extensions.KHR_materials_volume.attenuationColor"]),
    material(Neutral, No, &["extensions.KHR_materials_volume.thicknessTexture"]),
    material(No, Shown, &["extensions.KHR_materials_volume_scatter.multiscatterColorFactor",
        "extensions.KHR_materials_volume_scatter.multiscatterColor", "extensions.KHR_materials_scatter.multiscatterColorFactor",
        "extensions.KHR_materials_scatter.multiscatterColor"]),
    material(Neutral, Shown, &["extensions.KHR_materials_volume_scatter.scatterAnisotropy",
        "extensions.KHR_materials_scatter.scatterAnisotropy", "extensions.KHR_materials_scatter.scatterStrengthFactor"]),
    material(Neutral, Neutral, &["extensions.KHR_materials_volume_scatter.scatterStrengthFactor"]),
    material(Neutral, Shown, &["extensions.KHR_materials_volume_scatter.multiscatterColorTexture.index", "extensions.KHR_materials_volume_scatter.multiscatterColorTexture.texCoord",
        "extensions.KHR_materials_volume_scatter.multiscatterColorTexture.extensions.KHR_texture_transform.offset",
        "extensions.KHR_materials_volume_scatter.multiscatterColorTexture.extensions.KHR_texture_transform.rotation",
        "extensions.KHR_materials_volume_scatter.multiscatterColorTexture.extensions.KHR_texture_transform.scale",
        "extensions.KHR_materials_volume_scatter.multiscatterColorTexture.extensions.KHR_texture_transform.texCoord"]),
    material(Unless(&[0.0]), Unless(&[0.0]), &["extensions.KHR_materials_anisotropy.anisotropyStrength",
        "extensions.KHR_materials_clearcoat.clearcoatFactor",
        "extensions.KHR_materials_dispersion.dispersion", "extensions.KHR_materials_iridescence.iridescenceFactor"]),
    material(Unless(&[0.0, 0.0, 0.0]), Unless(&[0.0, 0.0, 0.0]), &["extensions.KHR_materials_sheen.sheenColorFactor"]),
    material(Shown, Unless(&[1.0]), &["extensions.KHR_materials_specular.specularFactor"]),
    material(Shown, Unless(&[1.0, 1.0, 1.0]), &["extensions.KHR_materials_specular.specularColorFactor"]),
    material(No, No, &["extensions.KHR_materials_specular.specularTexture", "extensions.KHR_materials_specular.specularColorTexture"]),
    // These have no effect where the factor of their extension is 0.
    material(Neutral, Neutral, &["extensions.KHR_materials_anisotropy.*", "extensions.KHR_materials_clearcoat.*",
        "extensions.KHR_materials_diffuse_transmission.*", "extensions.KHR_materials_iridescence.*", "extensions.KHR_materials_sheen.*"]),
    row(TEXTURES, Shown, &["source", "sampler", "extensions.EXT_texture_webp.source"]),
    row(TEXTURES, Neutral, &["extensions.KHR_texture_basisu.source"]),
    row(SAMPLERS, Shown, &["magFilter", "wrapS", "wrapT"]),
    row(SAMPLERS, Neutral, &["minFilter"]),
    row(IMAGES, Shown, &["uri", "bufferView"]),
    row(IMAGES, Neutral, &["mimeType"]),
    Row { list: MESHES, paths: &["primitives[].attributes.COLOR_0"], opaque: Shown, translucent: Reported },
    row(MESHES, Shown, &["primitives[].attributes.POSITION", "primitives[].attributes.NORMAL", "primitives[].attributes.TEXCOORD_*",
        "primitives[].indices", "primitives[].material", "primitives[].mode",
        "primitives[].extensions.KHR_draco_mesh_compression.*"]),
    row(MESHES, Shown, &["primitives[].attributes.JOINTS_*", "primitives[].attributes.WEIGHTS_*", "primitives[].targets", "weights"]),
    row(MESHES, Shown, &["primitives[].attributes.TANGENT"]),
    // These serve applications.
    row(MESHES, Neutral, &["primitives[].attributes.COLOR_*", "primitives[].attributes._*"]),
    row(NODES, Shown, &["mesh", "camera", "children", "matrix", "translation", "rotation", "scale", "extensions.KHR_lights_punctual.light"]),
    row(NODES, Shown, &["skin", "weights", "extensions.EXT_mesh_gpu_instancing.attributes.TRANSLATION",
        "extensions.EXT_mesh_gpu_instancing.attributes.ROTATION", "extensions.EXT_mesh_gpu_instancing.attributes.SCALE"]),
    row(NODES, Neutral, &["extensions.EXT_mesh_gpu_instancing.attributes._*"]),
    row(LIGHTS, Shown, &["type", "color", "intensity", "range", "spot.innerConeAngle", "spot.outerConeAngle"]),
    row(CAMERAS, Shown, &["type", "perspective.yfov", "perspective.aspectRatio", "orthographic.xmag", "orthographic.ymag"]),
    row(CAMERAS, Cuts, &["perspective.znear", "perspective.zfar", "orthographic.znear", "orthographic.zfar"]),
    row(SCENES, Shown, &["nodes"]),
    row(ACCESSORS, Shown, &["bufferView", "byteOffset", "componentType", "normalized", "count", "type", "sparse.count",
        "sparse.indices.bufferView", "sparse.indices.byteOffset", "sparse.indices.componentType", "sparse.values.bufferView",
        "sparse.values.byteOffset"]),
    row(ACCESSORS, Neutral, &["min", "max"]),
    row(VIEWS, Shown, &["buffer", "byteOffset", "byteLength", "byteStride"]),
    row(VIEWS, Neutral, &["target"]),
    row(VIEWS, Shown, &["extensions.EXT_meshopt_compression.*", "extensions.KHR_meshopt_compression.*"]),
    row(BUFFERS, Shown, &["uri", "byteLength"]),
    row(BUFFERS, Neutral, &["extensions.EXT_meshopt_compression.fallback", "extensions.KHR_meshopt_compression.fallback"]),
    row(DOCUMENT, Shown, &["scene"]),
    row(DOCUMENT, Neutral, &["asset"]),
    row(DOCUMENT, Reported, &["animations", "skins", "extensionsUsed", "extensionsRequired"]),
];

/// The result of looking a path up.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Lookup {
    /// The path is one of [`LISTS`].
    List(&'static str),
    /// Properties inside have rows of their own.
    Inside,
    /// Fates on opaque and on translucent surfaces.
    Property([Fate; 2]),
    Unknown,
}

/// Looks a path up. The first row that fits counts.
pub(super) fn look_up(list: &str, path: &str) -> Lookup {
    if list == DOCUMENT
        && let Some(known) = LISTS.iter().find(|known| **known == path)
    {
        return Lookup::List(known);
    }
    let ends = |with: &&str| path.strip_suffix(*with).is_some_and(|rest| rest.is_empty() || rest.ends_with('.'));
    if ANYWHERE.iter().any(ends) {
        return Lookup::Property([Neutral; 2]);
    }
    let fits = |known: &&str| known.strip_suffix('*').map_or(*known == path, |start| path.starts_with(start));
    let rows = || TABLE.iter().filter(|row| row.list == list);
    if let Some(row) = rows().find(|row| row.paths.iter().any(fits)) {
        return Lookup::Property([row.opaque, row.translucent]);
    }
    let below = |known: &&str| known.strip_prefix(path).is_some_and(|rest| rest.starts_with(['.', '[']));
    let inside = |paths: &[&str]| paths.iter().any(below);
    // Extensions are looked up one by one.
    let opens = ends(&"extensions") || list == DOCUMENT && inside(LISTS) || rows().any(|row| inside(row.paths));
    if opens { Lookup::Inside } else { Lookup::Unknown }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Paths in short: neighbors share their prefix, and extensions begin with their names.
    fn brief(paths: &[&'static str]) -> String {
        let split = |path: &&'static str| path.rsplit_once('.').unwrap_or(("", path));
        let parts: Vec<(&str, &str)> = paths.iter().map(split).collect();
        let group = |group: &[(&str, &str)]| {
            let ends: Vec<&str> = group.iter().map(|(_, end)| *end).collect();
            let (start, ends) = (group[0].0.replace("extensions.", ""), ends.join(", "));
            match (start.is_empty(), group.len()) {
                (true, _) => ends,
                (false, 1) => format!("{start}.{ends}"),
                (false, _) => format!("{start}.{{{ends}}}"),
            }
        };
        let groups: Vec<String> = parts.chunk_by(|a, b| a.0 == b.0).map(group).collect();
        format!("`{}`", groups.join(", "))
    }

    /// The table as Markdown.
    fn text() -> String {
        let numbers = |v: &[f64]| if v.iter().all(|x| *x == v[0]) { v[0].to_string() } else { format!("{v:?}") };
        let cell = |fate: Fate| match fate {
            Shown => "yes".to_owned(),
            Neutral => "no effect".into(),
            Reported => "own message".into(),
            TakenAs(v) => format!("taken as {}", numbers(v)),
            Unless(v) => format!("no, unless {}", numbers(v)),
            Cuts => "no, named where it cuts".into(),
            No => "no".into(),
        };
        let mut text = String::from("| of | property | opaque surfaces | translucent surfaces |\n|---|---|---|---|\n");
        for row in TABLE {
            let of = if row.list == DOCUMENT { "the file".to_owned() } else { format!("`{}[]`", row.list) };
            let (opaque, translucent) = (cell(row.opaque), cell(row.translucent));
            text += &format!("| {of} | {} | {opaque} | {translucent} |\n", brief(row.paths));
        }
        text
    }

    /// `docs/scenes.md` has the same table. Where it differs, the test prints the right one.
    #[test]
    fn the_documentation_has_this_table() {
        let file = concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs/scenes.md");
        let documented = std::fs::read_to_string(file).expect("docs/scenes.md");
        assert!(documented.contains(&text()), "docs/scenes.md should have:\n{}", text());
    }

    #[test]
    fn paths_are_looked_up() {
        assert_eq!(look_up(DOCUMENT, "materials"), Lookup::List(MATERIALS));
        assert_eq!(look_up(DOCUMENT, "extensions"), Lookup::Inside);
        assert_eq!(look_up(DOCUMENT, LIGHTS), Lookup::List(LIGHTS));
        assert_eq!(look_up(DOCUMENT, "extensions.EXT_lights_ies"), Lookup::Unknown);
        assert_eq!(look_up(MATERIALS, "extensions.KHR_materials_volume"), Lookup::Inside);
        assert_eq!(look_up(MATERIALS, "extensions.KHR_materials_volume.extras"), Lookup::Property([Neutral; 2]));
        assert_eq!(look_up(MATERIALS, "extensions.KHR_materials_unlit"), Lookup::Unknown);
        assert_eq!(look_up(MATERIALS, "pbrMetallicRoughness.extensions"), Lookup::Inside);
        assert_eq!(look_up(MESHES, "primitives[].attributes.TEXCOORD_3"), Lookup::Property([Shown; 2]));
        assert_eq!(look_up(MESHES, "primitives[].attributes.COLOR_0"), Lookup::Property([Shown, Reported]));
        assert_eq!(look_up(MESHES, "primitives[].attributes.KHR_x:ROTATION"), Lookup::Unknown);
        assert_eq!(look_up(NODES, "surname"), Lookup::Unknown);
        assert_eq!(look_up(CAMERAS, "perspective.znear"), Lookup::Property([Cuts; 2]));
    }
}

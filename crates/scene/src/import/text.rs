//! The JSON of a file.
//!
//! The gltf crate asks for more than glTF does: that every scene lists nodes, and that every channel of an animation
//! moves a node. Scenes and animations are therefore read as types of our own.

use super::{fault::Result, survey::Survey, transform::NodeTransform};
use gltf::json::{
    self, Index,
    animation::Sampler,
    extensions::root,
    scene::{Node, Scene},
};
use serde::{Deserialize, de::IgnoredAny};
use std::collections::BTreeMap;

/// The content of the JSON. Indices and numbers are not checked yet.
pub(super) struct Text {
    /// All but the animations.
    pub root: json::Root,
    pub animations: Vec<Animation>,
    /// The transform of each node.
    pub transforms: Vec<NodeTransform>,
    /// Properties of the file that are not honoured.
    pub survey: Survey,
}

/// A list of channels, each of which moves one property of one node.
#[derive(Deserialize)]
pub(super) struct Animation {
    pub name: Option<String>,
    #[serde(default)]
    pub channels: Vec<Channel>,
    #[serde(default)]
    pub samplers: Vec<Sampler>,
}

#[derive(Deserialize)]
pub(super) struct Channel {
    pub sampler: Index<Sampler>,
    pub target: Target,
}

/// What a channel moves. One without a node is to be ignored, says glTF.
#[derive(Deserialize)]
pub(super) struct Target {
    pub node: Option<Index<Node>>,
    #[serde(default)]
    pub path: String,
}

/// A list of nodes, which may be missing.
#[derive(Deserialize)]
struct SceneText {
    name: Option<String>,
    #[serde(default)]
    nodes: Vec<Index<Node>>,
}

/// The document. Its fields are those of the gltf crate, but for scenes and animations.
#[derive(Default, Deserialize)]
#[serde(rename_all = "camelCase", default)]
struct RootText {
    accessors: Vec<json::Accessor>,
    animations: Vec<Animation>,
    asset: Option<json::Asset>,
    buffers: Vec<json::Buffer>,
    buffer_views: Vec<json::buffer::View>,
    scene: Option<Index<Scene>>,
    extensions: Option<root::Root>,
    extensions_used: Vec<String>,
    extensions_required: Vec<String>,
    cameras: Vec<json::Camera>,
    images: Vec<json::Image>,
    materials: Vec<json::Material>,
    meshes: Vec<json::Mesh>,
    nodes: Vec<Node>,
    samplers: Vec<json::texture::Sampler>,
    scenes: Vec<SceneText>,
    skins: Vec<json::Skin>,
    textures: Vec<json::Texture>,
}

#[derive(Deserialize)]
struct Transforms {
    #[serde(default)]
    nodes: Vec<NodeTransform>,
}

/// A file of glTF 1, whose meshes have names for keys.
#[derive(Deserialize)]
struct Old {
    #[serde(rename = "meshes")]
    _meshes: BTreeMap<String, IgnoredAny>,
}

/// The way out for a file of glTF 1.
pub(super) const OF_VERSION_1: &str = "convert it with `gltf-pipeline -i OLD.gltf -o NEW.glb`";

impl Text {
    pub fn parse(text: &[u8]) -> Result<Text> {
        let not_gltf = |e: json::Error| match json::deserialize::from_slice::<Old>(text) {
            Ok(_) => format!("glTF 1, and only version 2 is read; {OF_VERSION_1}"),
            Err(_) => format!("not a glTF file (.glb or .gltf): {e}"),
        };
        let read: RootText = json::deserialize::from_slice(text).map_err(not_gltf)?;
        let transforms: Transforms = json::deserialize::from_slice(text).map_err(not_gltf)?;
        let survey: Survey = json::deserialize::from_slice(text).map_err(not_gltf)?;
        let asset = read.asset.ok_or("not a glTF file (.glb or .gltf): no `asset`")?;
        let scene = |s: SceneText| Scene { extensions: None, extras: Default::default(), name: s.name, nodes: s.nodes };
        let root = json::Root {
            accessors: read.accessors,
            animations: Vec::new(),
            asset,
            buffers: read.buffers,
            buffer_views: read.buffer_views,
            scene: read.scene,
            extensions: read.extensions,
            extras: Default::default(),
            extensions_used: read.extensions_used,
            extensions_required: read.extensions_required,
            cameras: read.cameras,
            images: read.images,
            materials: read.materials,
            meshes: read.meshes,
            nodes: read.nodes,
            samplers: read.samplers,
            scenes: read.scenes.into_iter().map(scene).collect(),
            skins: read.skins,
            textures: read.textures,
        };
        Ok(Text { root, animations: read.animations, transforms: transforms.nodes, survey })
    }
}

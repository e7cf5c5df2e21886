//! Writes a scene as binary glTF 2.0: one JSON chunk, one binary chunk.

use glam::{DQuat, DVec3, Vec3};
use picture::Picture;
use serde_json::{Value, json};

use crate::scene::{Indices, Light, LightKind, Part, Pictures, Scene, Shot, Surface};

/// Numbers that the glTF 2.0 specification fixes, sections 3.6, 5.1 and 5.11.
const MAGIC: u32 = 0x4654_6C67;
const VERSION: u32 = 2;
const JSON_CHUNK: u32 = 0x4E4F_534A;
const BINARY_CHUNK: u32 = 0x004E_4942;
const FLOAT: u32 = 5126;
const UNSIGNED_INT: u32 = 5125;
const UNSIGNED_SHORT: u32 = 5123;
const ARRAY_BUFFER: u32 = 34962;
const ELEMENT_ARRAY_BUFFER: u32 = 34963;

/// Clip plane nearest to the camera, metres; glTF requires one, ray tracing does not use it.
const NEAR_M: f64 = 0.001;

pub fn encode(scene: &Scene) -> Vec<u8> {
    let mut buffer = Buffer::default();
    let meshes: Vec<_> = scene.parts.iter().enumerate().map(|(i, p)| buffer.mesh(i, p, scene.indices)).collect();
    let textures = textures(&mut buffer, scene);
    let mut document = json!({
        "asset": { "version": "2.0", "generator": "make-scenes" },
        "extensionsUsed": extensions(scene),
        "extensions": { "KHR_lights_punctual": { "lights": list(&scene.lights, light) } },
        "scene": 0,
        "scenes": [{ "name": scene.name, "nodes": (0..node_count(scene)).collect::<Vec<_>>() }],
        "nodes": nodes(scene),
        "cameras": list(&scene.cameras, camera),
        "materials": materials(scene),
        "meshes": meshes,
        "accessors": buffer.accessors,
        "bufferViews": buffer.views,
        "buffers": [{ "byteLength": buffer.bytes.len() }],
    });
    if !textures.is_empty() {
        document["images"] = textures.into();
        document["textures"] = (0..buffer.pictures).map(|k| json!({ "source": k })).collect();
    }
    // Whether serde_json keeps the order of insertion depends on the features that other crates enable. Sorted keys
    // make the bytes independent of that.
    document.sort_all_objects();
    container(document.to_string().into_bytes(), buffer.bytes)
}

fn list<T>(items: &[T], to_json: impl Fn(&T) -> Value) -> Vec<Value> {
    items.iter().map(to_json).collect()
}

fn node_count(scene: &Scene) -> usize {
    scene.parts.len() + scene.lights.len() + scene.cameras.len()
}

fn nodes(scene: &Scene) -> Vec<Value> {
    let parts = scene.parts.iter().enumerate();
    let parts = parts.map(|(i, part)| json!({ "name": part.name, "mesh": i }));
    let lights = scene.lights.iter().enumerate().map(|(i, light)| {
        let reference = json!({ "KHR_lights_punctual": { "light": i } });
        let Light { name, position, .. } = *light;
        placed(json!({ "name": name, "extensions": reference }), position, light.rotation())
    });
    let cameras = scene
        .cameras
        .iter()
        .enumerate()
        .map(|(i, shot)| placed(json!({ "name": shot.name, "camera": i }), shot.eye, shot.rotation()));
    parts.chain(lights).chain(cameras).collect()
}

fn placed(mut node: Value, position: DVec3, rotation: DQuat) -> Value {
    node["translation"] = json!(position.to_array());
    node["rotation"] = json!(rotation.to_array());
    node
}

fn light(light: &Light) -> Value {
    let mut value = json!({ "name": light.name, "color": light.color, "intensity": light.intensity });
    value["type"] = match light.kind {
        LightKind::Directional => json!("directional"),
        LightKind::Point => json!("point"),
        LightKind::Spot { .. } => json!("spot"),
    };
    if let LightKind::Spot { inner_cone_radians, outer_cone_radians } = light.kind {
        value["spot"] = json!({ "innerConeAngle": inner_cone_radians, "outerConeAngle": outer_cone_radians });
    }
    value
}

/// The aspect of a square image, which every view here has.
fn camera(shot: &Shot) -> Value {
    let yfov = shot.yfov_degrees.to_radians();
    json!({
        "name": shot.name,
        "type": "perspective",
        "perspective": { "aspectRatio": 1.0, "yfov": yfov, "znear": NEAR_M },
    })
}

/// The pictures of all parts, in the order in which `materials` counts them.
fn textures(buffer: &mut Buffer, scene: &Scene) -> Vec<Value> {
    let pictures = scene.parts.iter().filter_map(|part| part.surface.pictures());
    let pictures = pictures.flat_map(|p| [Some(p.base_color), p.bumps.map(|bumps| bumps.picture)]);
    pictures.flatten().map(|picture| buffer.picture(&picture())).collect()
}

fn materials(scene: &Scene) -> Vec<Value> {
    let mut texture = 0;
    let dressed = scene.parts.iter().map(|part| {
        let mut value = material(part);
        if let Some(Pictures { bumps, .. }) = part.surface.pictures() {
            value["pbrMetallicRoughness"]["baseColorTexture"] = json!({ "index": texture });
            texture += 1;
            if let Some(bumps) = bumps {
                let scale = json!({ "scale": [bumps.repeats, bumps.repeats] });
                value["normalTexture"] = json!({ "index": texture, "extensions": { "KHR_texture_transform": scale } });
                texture += 1;
            }
        }
        value
    });
    dressed.collect()
}

fn material(part: &Part) -> Value {
    let reflectance = |[r, g, b]: [f64; 3]| json!({ "baseColorFactor": [r, g, b, 1.0], "metallicFactor": 0.0 });
    match part.surface {
        Surface::Translucent { index_of_refraction, finish } => json!({
            "name": part.name,
            "pbrMetallicRoughness": { "metallicFactor": 0.0, "roughnessFactor": finish.roughness },
            "extensions": {
                "KHR_materials_ior": { "ior": index_of_refraction },
                "KHR_materials_transmission": { "transmissionFactor": 1.0 },
                // Positive thickness is what marks the inside of a closed surface as a volume.
                "KHR_materials_volume": { "thicknessFactor": 1.0 },
            },
        }),
        Surface::Opaque { base_color } => {
            json!({ "name": part.name, "pbrMetallicRoughness": reflectance(base_color) })
        }
        Surface::Pictured { .. } => json!({ "name": part.name, "pbrMetallicRoughness": reflectance([1.0; 3]) }),
        Surface::Glossy { finish } => {
            let mut shown = reflectance(finish.base_color);
            shown["metallicFactor"] = json!(finish.metallic);
            shown["roughnessFactor"] = json!(finish.roughness);
            json!({ "name": part.name, "pbrMetallicRoughness": shown })
        }
        Surface::Emitting { radiance } => {
            // The factor may not exceed 1.
            let strength = radiance.into_iter().fold(0.0, f64::max);
            json!({
                "name": part.name,
                "pbrMetallicRoughness": reflectance([0.0; 3]),
                "emissiveFactor": radiance.map(|x| x / strength),
                "extensions": { "KHR_materials_emissive_strength": { "emissiveStrength": strength } },
            })
        }
    }
}

/// The extensions of every scene, and those of scenes with an emitting surface or a normal map.
fn extensions(scene: &Scene) -> Vec<&'static str> {
    let shines = scene.parts.iter().any(|part| matches!(part.surface, Surface::Emitting { .. }));
    let mut names =
        vec!["KHR_lights_punctual", "KHR_materials_ior", "KHR_materials_transmission", "KHR_materials_volume"];
    names.extend(shines.then_some("KHR_materials_emissive_strength"));
    let bumps = |part: &Part| part.surface.pictures()?.bumps;
    names.extend(scene.parts.iter().find_map(bumps).map(|_| "KHR_texture_transform"));
    names
}

/// The binary chunk as it grows, with the descriptions that refer to it.
#[derive(Default)]
struct Buffer {
    bytes: Vec<u8>,
    views: Vec<Value>,
    accessors: Vec<Value>,
    /// Number of the pictures.
    pictures: usize,
}

impl Buffer {
    /// Stores the mesh and describes it; its material has the same index as its part.
    fn mesh(&mut self, index: usize, part: &Part, indices: Indices) -> Value {
        let mesh = &part.mesh;
        let (low, high) = mesh.bounds();
        let mut positions = vectors(&mesh.positions);
        positions["min"] = json!(low.to_array());
        positions["max"] = json!(high.to_array());
        let mut attributes = json!({ "POSITION": self.add(positions, bytes_of(&mesh.positions)) });
        if !mesh.normals.is_empty() {
            attributes["NORMAL"] = json!(self.add(vectors(&mesh.normals), bytes_of(&mesh.normals)));
        }
        if let Some(pictures) = part.surface.pictures() {
            let coordinates = |p: &Vec3| (pictures.coordinates)(p.as_dvec3()).as_vec2().to_array();
            let bytes = mesh.positions.iter().flat_map(coordinates).flat_map(f32::to_le_bytes).collect();
            let pairs = json!({ "componentType": FLOAT, "count": mesh.positions.len(), "type": "VEC2" });
            attributes["TEXCOORD_0"] = json!(self.add(pairs, bytes));
        }
        let corners = mesh.triangles.as_flattened();
        // The largest number of 16 bits is no index in glTF.
        let short = indices == Indices::Short && mesh.positions.len() < usize::from(u16::MAX);
        let width = if short { 2 } else { 4 };
        let kind = if short { UNSIGNED_SHORT } else { UNSIGNED_INT };
        let index_bytes = corners.iter().flat_map(|corner| corner.to_le_bytes().into_iter().take(width)).collect();
        let indices = json!({ "componentType": kind, "count": corners.len(), "type": "SCALAR" });
        let primitive = json!({
            "attributes": attributes,
            "indices": self.add(indices, index_bytes),
            "material": index,
        });
        json!({ "name": part.name, "primitives": [primitive] })
    }

    /// Appends a picture as a PNG file, padded to four bytes; returns its description.
    fn picture(&mut self, picture: &Picture) -> Value {
        let bytes = picture.encode(png::Compression::High, &[]).expect("a picture of the scene has texels");
        self.views.push(json!({ "buffer": 0, "byteOffset": self.bytes.len(), "byteLength": bytes.len() }));
        self.bytes.extend(bytes);
        self.bytes.resize(self.bytes.len().next_multiple_of(4), 0);
        self.pictures += 1;
        json!({ "bufferView": self.views.len() - 1, "mimeType": "image/png" })
    }

    /// Appends an array in a view of its own; returns the index of its accessor. Arrays are padded to four
    /// bytes, so that every one starts aligned.
    fn add(&mut self, mut accessor: Value, bytes: Vec<u8>) -> usize {
        let target = if accessor["type"] == "SCALAR" { ELEMENT_ARRAY_BUFFER } else { ARRAY_BUFFER };
        accessor["bufferView"] = json!(self.views.len());
        self.views.push(json!({
            "buffer": 0, "byteOffset": self.bytes.len(), "byteLength": bytes.len(), "target": target,
        }));
        self.bytes.extend(bytes);
        self.bytes.resize(self.bytes.len().next_multiple_of(4), 0);
        self.accessors.push(accessor);
        self.accessors.len() - 1
    }
}

fn vectors(items: &[Vec3]) -> Value {
    json!({ "componentType": FLOAT, "count": items.len(), "type": "VEC3" })
}

fn bytes_of(items: &[Vec3]) -> Vec<u8> {
    items.iter().flat_map(|v| v.to_array()).flat_map(f32::to_le_bytes).collect()
}

/// Header and both chunks, each padded to four bytes with what its format ignores.
fn container(mut json: Vec<u8>, mut binary: Vec<u8>) -> Vec<u8> {
    json.resize(json.len().next_multiple_of(4), b' ');
    binary.resize(binary.len().next_multiple_of(4), 0);
    let total = 12 + 8 + json.len() + 8 + binary.len();
    let mut bytes = Vec::with_capacity(total);
    for word in [MAGIC, VERSION, total as u32, json.len() as u32, JSON_CHUNK] {
        bytes.extend(word.to_le_bytes());
    }
    bytes.extend(json);
    for word in [binary.len() as u32, BINARY_CHUNK] {
        bytes.extend(word.to_le_bytes());
    }
    bytes.extend(binary);
    bytes
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The limits on the size of files in the repository.
    const FILE_LIMIT_BYTES: usize = 1_200_000;
    const TOTAL_LIMIT_BYTES: usize = 6_000_000;

    #[test]
    fn files_are_small_and_equal_on_every_build() {
        let files = |scenes: &[Scene]| scenes.iter().map(encode).collect::<Vec<_>>();
        let first = files(&crate::SCENES);
        assert!(first == files(&crate::all()), "two builds differ");
        assert!(first.iter().all(|file| file.len() < FILE_LIMIT_BYTES));
        assert!(first.iter().map(Vec::len).sum::<usize>() < TOTAL_LIMIT_BYTES);
    }

    #[test]
    fn chunks_are_aligned_and_fill_the_file() {
        for scene in crate::SCENES.iter() {
            let bytes = encode(scene);
            let word = |at: usize| u32::from_le_bytes([bytes[at], bytes[at + 1], bytes[at + 2], bytes[at + 3]]);
            assert_eq!([word(0), word(4), word(8)], [MAGIC, VERSION, bytes.len() as u32]);
            let json_bytes = word(12) as usize;
            assert_eq!((word(16), json_bytes % 4), (JSON_CHUNK, 0));
            let document: Value = serde_json::from_slice(&bytes[20..20 + json_bytes]).expect("valid JSON");
            let binary_at = 20 + json_bytes;
            assert_eq!(word(binary_at + 4), BINARY_CHUNK);
            assert_eq!(document["buffers"][0]["byteLength"], word(binary_at));
            assert_eq!(bytes.len(), binary_at + 8 + word(binary_at) as usize);
        }
    }
}

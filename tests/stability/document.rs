//! The smallest glTF scene with every kind of number that can be wrong: a triangle with normals, three kinds of
//! light, two kinds of camera.

use scene::{Scene, SceneError};
use serde_json::{Value, json};
use test_support::{Bench, glb::OPTIONS};

/// Positions, normals and indices of one triangle.
pub fn binary() -> Vec<u8> {
    let positions = [0.0f32, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0];
    let normals = [0.0f32, 0.0, 1.0, 0.0, 0.0, 1.0, 0.0, 0.0, 1.0];
    let floats = positions.into_iter().chain(normals).flat_map(f32::to_le_bytes);
    floats.chain([0u32, 1, 2].into_iter().flat_map(u32::to_le_bytes)).collect()
}

fn nodes() -> Value {
    let light = |index: usize| json!({ "KHR_lights_punctual": { "light": index } });
    json!([
        { "mesh": 0, "translation": [0.0, 0.0, 0.0], "rotation": [0.0, 0.0, 0.0, 1.0], "scale": [1.0, 1.0, 1.0] },
        { "extensions": light(0), "rotation": [0.0, 0.0, 0.0, 1.0] },
        { "extensions": light(1), "translation": [0.0, 0.0, 3.0] },
        { "extensions": light(2), "matrix": [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 1, 1] },
        { "camera": 0, "translation": [0.0, 0.0, 3.0] },
        { "camera": 1, "translation": [0.0, 0.0, 3.0] },
        { "children": [2, 4], "scale": [1.0, 1.0, 1.0], "translation": [0.0, 0.0, 0.0] },
    ])
}

pub fn document() -> Value {
    json!({
        "asset": { "version": "2.0" },
        "extensionsUsed": ["KHR_lights_punctual", "KHR_materials_volume", "KHR_materials_emissive_strength"],
        "extensions": { "KHR_lights_punctual": { "lights": [
            { "type": "directional", "intensity": 1.0, "color": [1.0, 1.0, 1.0] },
            { "type": "point", "intensity": 1.0, "range": 10.0 },
            { "type": "spot", "intensity": 1.0, "spot": { "innerConeAngle": 0.1, "outerConeAngle": 0.2 } },
        ] } },
        "nodes": nodes(),
        "cameras": [
            { "type": "perspective", "perspective": { "yfov": 0.5, "aspectRatio": 1.5, "znear": 0.1 } },
            { "type": "orthographic", "orthographic": { "xmag": 1.5, "ymag": 1.0, "znear": 0.1, "zfar": 9.0 } },
        ],
        "meshes": [{ "primitives": [{ "attributes": { "POSITION": 0, "NORMAL": 1 }, "indices": 2, "material": 0 }] }],
        "materials": [{
            "pbrMetallicRoughness": { "baseColorFactor": [0.5, 0.5, 0.5, 1.0] },
            "emissiveFactor": [0.5, 0.5, 0.5],
            "extensions": {
                "KHR_materials_volume": { "thicknessFactor": 1.0 },
                "KHR_materials_emissive_strength": { "emissiveStrength": 2.0 },
            },
        }],
        "buffers": [{ "uri": "scene.bin", "byteLength": 84 }],
        "bufferViews": [
            { "buffer": 0, "byteOffset": 0, "byteLength": 36 },
            { "buffer": 0, "byteOffset": 36, "byteLength": 36 },
            { "buffer": 0, "byteOffset": 72, "byteLength": 12 },
        ],
        "accessors": [
            { "bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3" },
            { "bufferView": 1, "componentType": 5126, "count": 3, "type": "VEC3" },
            { "bufferView": 2, "componentType": 5125, "count": 3, "type": "SCALAR" },
        ],
    })
}

/// A folder that holds the buffer.
pub fn bench(binary: &[u8]) -> Bench {
    let bench = Bench::new();
    bench.write("scene.bin", binary);
    bench
}

/// Imports a document with the buffer of that folder.
pub fn import(bench: &Bench, document: &str) -> Result<Scene, SceneError> {
    Scene::import(&bench.write("scene.gltf", document), &OPTIONS)
}

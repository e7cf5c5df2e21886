//! Small glTF files: written field by field, taken apart and imported.

use scene::{ImportOptions, LightUnit, Scene};
use serde_json::{Value, json};

pub const OPTIONS: ImportOptions =
    ImportOptions { metres_per_unit: 1.0, light_unit: Some(WATTS), emission_unit: Some(WATTS), pose: None };
const WATTS: LightUnit = LightUnit::Radiometric;

pub const UNSIGNED_BYTE: u32 = 5121;
pub const UNSIGNED_SHORT: u32 = 5123;
pub const UNSIGNED_INT: u32 = 5125;
pub const FLOAT: u32 = 5126;

/// A glTF document and its binary buffer.
#[derive(Clone)]
pub struct Asset {
    pub json: Value,
    pub binary: Vec<u8>,
}

impl Default for Asset {
    fn default() -> Asset {
        Asset::new()
    }
}

impl Asset {
    /// The document and the buffer of a .glb.
    pub fn read(bytes: &[u8]) -> Asset {
        let [text, binary] = chunks(bytes)[..] else { panic!("not a .glb of two chunks") };
        Asset { json: serde_json::from_slice(text).expect("JSON"), binary: binary.to_vec() }
    }

    /// A scene without anything.
    pub fn new() -> Asset {
        let json = json!({
            "asset": { "version": "2.0" },
            "scene": 0,
            "scenes": [{ "nodes": [] }],
            "nodes": [],
            "meshes": [],
            "accessors": [],
            "bufferViews": [],
        });
        Asset { json, binary: Vec::new() }
    }

    /// Appends to one of the document's lists; returns the index.
    pub fn push(&mut self, list: &str, item: Value) -> usize {
        let document = self.json.as_object_mut().expect("an object");
        let items = document.entry(list).or_insert_with(|| json!([])).as_array_mut().expect("a list");
        items.push(item);
        items.len() - 1
    }

    /// A buffer view with these bytes, and an accessor for all of it.
    pub fn accessor(&mut self, bytes: &[u8], kind: &str, component: u32, count: usize) -> usize {
        self.binary.resize(self.binary.len().next_multiple_of(4), 0);
        let view = json!({ "buffer": 0, "byteOffset": self.binary.len(), "byteLength": bytes.len() });
        self.binary.extend(bytes);
        let view = self.push("bufferViews", view);
        self.push("accessors", json!({ "bufferView": view, "componentType": component, "type": kind, "count": count }))
    }

    /// An accessor of points or directions.
    pub fn vectors(&mut self, vectors: &[[f32; 3]]) -> usize {
        let bytes: Vec<u8> = vectors.as_flattened().iter().flat_map(|x| x.to_le_bytes()).collect();
        self.accessor(&bytes, "VEC3", FLOAT, vectors.len())
    }

    /// An accessor of the corners of triangles.
    pub fn indices(&mut self, indices: &[u16]) -> usize {
        let bytes: Vec<u8> = indices.iter().flat_map(|x| x.to_le_bytes()).collect();
        self.accessor(&bytes, "SCALAR", UNSIGNED_SHORT, indices.len())
    }

    /// An accessor of the corners of triangles, for meshes of any size.
    pub fn long_indices(&mut self, indices: &[u32]) -> usize {
        let bytes: Vec<u8> = indices.iter().flat_map(|x| x.to_le_bytes()).collect();
        self.accessor(&bytes, "SCALAR", UNSIGNED_INT, indices.len())
    }

    /// A mesh of one primitive.
    pub fn mesh(&mut self, primitive: Value) -> usize {
        self.push("meshes", json!({ "primitives": [primitive] }))
    }

    /// A node that is a root of the scene.
    pub fn node(&mut self, node: Value) -> usize {
        let index = self.push("nodes", node);
        self.json["scenes"][0]["nodes"].as_array_mut().expect("a list").push(json!(index));
        index
    }

    /// A light on a node of its own.
    pub fn light(&mut self, light: Value, mut node: Value) -> usize {
        let lights = &mut self.json["extensions"]["KHR_lights_punctual"]["lights"];
        if lights.is_null() {
            *lights = json!([]);
        }
        let lights = lights.as_array_mut().expect("a list");
        lights.push(light);
        node["extensions"] = json!({ "KHR_lights_punctual": { "light": lights.len() - 1 } });
        self.node(node)
    }

    /// Sets the value at a JSON pointer whose parent is there.
    pub fn set(&mut self, pointer: &str, value: Value) {
        let (parent, key) = pointer.rsplit_once('/').expect("a pointer");
        let parent = self.json.pointer_mut(parent).expect("the parent is there");
        match (parent, key.parse::<usize>()) {
            (Value::Array(items), Ok(k)) => items[k] = value,
            (object, _) => object[key] = value,
        }
    }

    /// The file as a .glb.
    pub fn glb(&self) -> Vec<u8> {
        let mut document = self.json.clone();
        document["buffers"] = json!([{ "byteLength": self.binary.len() }]);
        container(&[(b"JSON", document.to_string().as_bytes()), (b"BIN\0", &self.binary)])
    }

    pub fn import_with(&self, options: &ImportOptions) -> Result<Scene, String> {
        import_bytes("tiny.glb", &self.glb(), options)
    }

    pub fn import(&self) -> Result<Scene, String> {
        self.import_with(&OPTIONS)
    }
}

/// A .glb of these chunks.
pub fn container(chunks: &[(&[u8; 4], &[u8])]) -> Vec<u8> {
    let mut body = Vec::new();
    for (kind, content) in chunks {
        let filler = if *kind == b"JSON" { b' ' } else { 0 };
        let mut content = content.to_vec();
        content.resize(content.len().next_multiple_of(4), filler);
        body.extend((content.len() as u32).to_le_bytes());
        body.extend(*kind);
        body.extend(content);
    }
    let length = body.len() as u32 + 12;
    [b"glTF".as_slice(), &2u32.to_le_bytes(), &length.to_le_bytes(), &body].concat()
}

/// The contents of the chunks of a .glb, up to the first one whose length does not fit.
pub fn chunks(bytes: &[u8]) -> Vec<&[u8]> {
    let mut rest = bytes.get(12..).filter(|_| bytes.starts_with(b"glTF")).unwrap_or_default();
    let mut found = Vec::new();
    while let Some((length, body)) = rest.split_first_chunk::<4>() {
        let end = (u32::from_le_bytes(*length) as usize).saturating_add(4);
        let Some(content) = body.get(4..end) else { break };
        found.push(content);
        rest = &body[end..];
    }
    found
}

pub fn import_bytes(name: &str, bytes: &[u8], options: &ImportOptions) -> Result<Scene, String> {
    let folder = tempfile::tempdir().expect("the temporary folder is writable");
    let path = folder.path().join(name);
    std::fs::write(&path, bytes).expect("writes");
    Scene::import(&path, options).map_err(|e| e.to_string())
}

/// The message of an import that must fail.
pub fn fault(asset: &Asset) -> String {
    match asset.import() {
        Ok(_) => panic!("the file was accepted: {}", asset.json),
        Err(message) => message,
    }
}

pub const TETRAHEDRON: [[f32; 3]; 4] = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
pub const TETRAHEDRON_SIDES: [u16; 12] = [0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3];

/// A tetrahedron wound outwards, with the normals of its corners, a material, a spot light and a camera.
pub fn tetrahedron() -> Asset {
    let mut asset = Asset::new();
    let positions = asset.vectors(&TETRAHEDRON);
    let normals = asset.vectors(&TETRAHEDRON.map(|p| p.map(|x| x - 0.25)));
    let indices = asset.indices(&TETRAHEDRON_SIDES);
    asset.push("materials", json!({ "name": "wax" }));
    let attributes = json!({ "POSITION": positions, "NORMAL": normals });
    asset.mesh(json!({ "attributes": attributes, "indices": indices, "material": 0 }));
    asset.node(json!({ "name": "body", "mesh": 0 }));
    asset.light(json!({ "type": "spot", "spot": {}, "intensity": 2.0 }), json!({ "name": "lamp" }));
    asset.push("cameras", json!({ "type": "perspective", "perspective": { "yfov": 0.5, "znear": 0.1 } }));
    asset.node(json!({ "name": "eye", "camera": 0 }));
    asset
}

//! The file as bytes: .glb or .gltf, its buffers, its node transforms in float64.

use super::Fault;
use crate::SceneError;
use base64::{Engine, engine::general_purpose::STANDARD};
use glam::{DMat4, DQuat, DVec3};
use gltf::json;
use serde::Deserialize;
use std::path::{Component, Path};

/// A parsed file with its buffers; nothing in it is checked yet.
pub(super) struct Document {
    pub root: json::Root,
    pub buffers: Vec<Vec<u8>>,
    transforms: Vec<NodeTransform>,
}

/// Transforms as the file has them: the gltf crate rounds them to float32.
#[derive(Deserialize)]
struct Transforms {
    #[serde(default)]
    nodes: Vec<NodeTransform>,
}

#[derive(Deserialize)]
struct NodeTransform {
    matrix: Option<[f64; 16]>,
    translation: Option<[f64; 3]>,
    rotation: Option<[f64; 4]>,
    scale: Option<[f64; 3]>,
}

impl Document {
    pub fn read(path: &Path) -> Result<Document, SceneError> {
        let bytes = std::fs::read(path).map_err(|source| SceneError::Read { path: path.to_owned(), source })?;
        Document::parse(&bytes, path).map_err(|what| SceneError::Invalid { path: path.to_owned(), what })
    }

    fn parse(bytes: &[u8], path: &Path) -> Result<Document, Fault> {
        let (text, binary) = if bytes.starts_with(b"glTF") { split_glb(bytes)? } else { (bytes, None) };
        let not_gltf = |e: json::Error| format!("not a glTF file (.glb or .gltf): {e}");
        let root: json::Root = json::deserialize::from_slice(text).map_err(not_gltf)?;
        let transforms: Transforms = json::deserialize::from_slice(text).map_err(not_gltf)?;
        if !root.asset.version.starts_with("2.") {
            return Err(format!("asset.version is `{}`; only glTF 2 is read", root.asset.version));
        }
        let folder = path.parent().unwrap_or(Path::new(""));
        let mut buffers = Vec::new();
        for (k, buffer) in root.buffers.iter().enumerate() {
            let data = match (&buffer.uri, binary) {
                (Some(uri), _) => read_uri(uri, folder).map_err(|e| format!("buffers[{k}].uri: {e}"))?,
                (None, Some(chunk)) if k == 0 => chunk.to_vec(),
                (None, _) => return Err(format!("buffers[{k}] has no uri and the file no binary chunk for it")),
            };
            if (data.len() as u64) < buffer.byte_length.0 {
                let (have, want) = (data.len(), buffer.byte_length.0);
                return Err(format!("buffers[{k}] holds {have} bytes, byteLength says {want}; is the file truncated?"));
            }
            buffers.push(data);
        }
        Ok(Document { root, buffers, transforms: transforms.nodes })
    }

    /// A node's own transform; `index` is in range.
    pub fn local_transform(&self, index: usize) -> DMat4 {
        let t = &self.transforms[index];
        if let Some(matrix) = &t.matrix {
            return DMat4::from_cols_array(matrix);
        }
        let rotation = DQuat::from_array(t.rotation.unwrap_or([0.0, 0.0, 0.0, 1.0]));
        let length = rotation.length();
        let rotation = if length > 0.0 { rotation / length } else { DQuat::IDENTITY };
        DMat4::from_scale_rotation_translation(
            DVec3::from_array(t.scale.unwrap_or([1.0; 3])),
            rotation,
            DVec3::from_array(t.translation.unwrap_or([0.0; 3])),
        )
    }
}

/// JSON and binary chunk of a .glb file.
fn split_glb(bytes: &[u8]) -> Result<(&[u8], Option<&[u8]>), Fault> {
    let word = |at: usize| -> Result<u32, Fault> {
        let four = bytes.get(at..at + 4).and_then(|b| b.try_into().ok());
        four.map(u32::from_le_bytes).ok_or_else(|| "the .glb header is truncated".into())
    };
    let version = word(4)?;
    if version != 2 {
        return Err(format!("the .glb has version {version}; only version 2 is read"));
    }
    let length = word(8)? as usize;
    if length > bytes.len() {
        return Err(format!("the .glb is truncated: {} of {length} bytes are there", bytes.len()));
    }
    let chunk = |at: usize, kind: &[u8; 4]| -> Result<(&[u8], usize), Fault> {
        let size = word(at)? as usize;
        let end = at.checked_add(8).and_then(|start| start.checked_add(size));
        match end.filter(|end| *end <= bytes.len() && bytes.get(at + 4..at + 8) == Some(&kind[..])) {
            Some(end) => Ok((&bytes[at + 8..end], end)),
            None => Err(format!("the .glb has no whole {} chunk at byte {at}", kind.escape_ascii())),
        }
    };
    let (text, end) = chunk(12, b"JSON")?;
    let end = end.next_multiple_of(4);
    let binary = if end + 8 <= length { Some(chunk(end, b"BIN\0")?.0) } else { None };
    Ok((text, binary))
}

/// A data URI, or a file in the scene's folder or below.
fn read_uri(uri: &str, folder: &Path) -> Result<Vec<u8>, Fault> {
    if let Some(data) = uri.strip_prefix("data:") {
        let encoded = data.split_once(";base64,").ok_or("only base64 data is read")?.1;
        return STANDARD.decode(encoded).map_err(|e| format!("not base64: {e}"));
    }
    let decoded = percent_encoding::percent_decode_str(uri)
        .decode_utf8()
        .map_err(|_| format!("`{uri}` is not UTF-8"))?;
    let relative = Path::new(decoded.as_ref());
    let inside = relative.components().all(|c| matches!(c, Component::Normal(_) | Component::CurDir));
    if !inside || decoded.contains("://") {
        return Err(format!("`{decoded}` is not a file in the scene's folder"));
    }
    let path = folder.join(relative);
    std::fs::read(&path).map_err(|e| format!("{}: {e}", path.display()))
}

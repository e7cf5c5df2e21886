//! KHR_draco_mesh_compression: primitives whose vertices and triangles are one compressed stream.

use super::{
    accessor::CheckedAccessor,
    container::Document,
    fault::{Result, get},
};
use draco_core::{DataType, DecodeLimits, DecoderBuffer, Mesh, MeshDecoder};
use gltf::json::{Accessor, Index, buffer::View, mesh::Primitive};
use serde::Deserialize;
use std::collections::BTreeMap;

/// The name of the extension.
pub(super) const NAME: &str = "KHR_draco_mesh_compression";

/// The extension's object of a primitive.
#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
struct Compressed {
    buffer_view: Index<View>,
    /// Identifier in the stream of each attribute.
    attributes: BTreeMap<String, u32>,
}

/// The decoded stream of a primitive.
pub(super) struct Decoded {
    mesh: Mesh,
    attributes: BTreeMap<String, u32>,
}

/// Most bytes of memory that a decoder takes for a triangle. 115 were measured.
const BYTES_PER_FACE: u64 = 192;

impl Decoded {
    /// Decodes the stream of a primitive, if it has one. What it may hold is limited by the length of the file.
    pub fn of(document: &Document, primitive: &Primitive) -> Result<Option<Decoded>> {
        let Some(object) = primitive.extensions.as_ref().and_then(|e| e.others.get(NAME)) else { return Ok(None) };
        let fault = |what: &dyn std::fmt::Display| format!("{NAME}: {what}");
        let compressed = Compressed::deserialize(object).map_err(|e| fault(&e))?;
        let stream = document.view(&compressed.buffer_view).map_err(|e| fault(&e))?;
        let room = document.room();
        let limits = DecodeLimits::default()
            .with_max_points(room / 12)
            .with_max_faces(room / BYTES_PER_FACE)
            .with_max_decoded_bytes(room);
        let mut mesh = Mesh::new();
        let decoded = MeshDecoder::new().decode(&mut DecoderBuffer::new(stream).with_limits(limits), &mut mesh);
        let way_out = "convert it with `gltf-transform copy IN.glb OUT.glb`";
        decoded.map_err(|e| fault(&format!("the stream cannot be decoded: {e}; {way_out}")))?;
        document.spend(mesh.num_faces() as u64 * BYTES_PER_FACE)?;
        Ok(Some(Decoded { mesh, attributes: compressed.attributes }))
    }

    /// An attribute that the stream holds, as `components` numbers to a vertex. `index` is its accessor, which has
    /// everything but the bytes.
    pub fn attribute<'a>(
        &self,
        document: &'a Document,
        (semantic, index): (&str, &Index<Accessor>),
        components: usize,
        field: String,
    ) -> Result<Option<CheckedAccessor<'a>>> {
        let Some(id) = self.attributes.get(semantic) else { return Ok(None) };
        let Some(attribute) = self.mesh.attribute_by_unique_id(*id) else {
            return Err(format!("{field}: the {NAME} stream has no attribute {id}"));
        };
        let points = self.mesh.num_points();
        document.spend(4 * (points as u64) * components as u64)?;
        let mut numbers = attribute.read_f32s(points, components);
        let own = usize::from(attribute.num_components());
        if own < components {
            // Colors without alpha are opaque.
            numbers.chunks_exact_mut(components).for_each(|vertex| vertex[own..].fill(1.0));
        }
        if get(&document.root.accessors, index, &field)?.normalized
            && let Some(largest) = largest(attribute.data_type())
        {
            let given = own.min(components);
            let vertices = numbers.chunks_exact_mut(components);
            vertices.flat_map(|vertex| &mut vertex[..given]).for_each(|x| *x = (*x / largest).max(-1.0));
        }
        Ok(Some(CheckedAccessor::of_reals(field, &numbers, components)))
    }

    /// Corners of the triangles.
    pub fn indices<'a>(&self, field: String) -> CheckedAccessor<'a> {
        let corners: Vec<u32> = self.mesh.faces().as_flattened().iter().map(|point| point.0).collect();
        CheckedAccessor::of_indices(field, &corners)
    }
}

/// The largest integer of a type, which represents 1 where numbers are normalized.
fn largest(kind: DataType) -> Option<f32> {
    match kind {
        DataType::Int8 => Some(127.0),
        DataType::Uint8 => Some(255.0),
        DataType::Int16 => Some(32767.0),
        DataType::Uint16 => Some(65535.0),
        _ => None,
    }
}

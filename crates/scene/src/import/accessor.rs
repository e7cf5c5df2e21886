//! Typed reading of accessors with every range checked.

use super::{Fault, get};
use glam::Vec3;
use gltf::json::{
    Accessor, Index, Root,
    accessor::{ComponentType, Type},
    validation::Checked,
};

/// The file's lists and the bytes of its buffers.
#[derive(Clone, Copy)]
pub(super) struct Buffers<'a> {
    pub root: &'a Root,
    pub data: &'a [Vec<u8>],
}

/// The bytes of an accessor, element by element.
struct Elements<'a> {
    bytes: &'a [u8],
    count: usize,
    stride: usize,
    size: usize,
}

impl<'a> Elements<'a> {
    fn iter(&self) -> impl Iterator<Item = &'a [u8]> + use<'a> {
        let (bytes, stride, size) = (self.bytes, self.stride, self.size);
        (0..self.count).map(move |k| &bytes[k * stride..k * stride + size])
    }
}

impl<'a> Buffers<'a> {
    /// A list of float32 vectors, every component finite.
    pub fn vectors(&self, index: &Index<Accessor>, field: &str) -> Result<Vec<Vec3>, Fault> {
        let accessor = get(&self.root.accessors, index, field)?;
        let wanted = (Checked::Valid(Type::Vec3), ComponentType::F32);
        match &accessor.component_type {
            Checked::Valid(c) if (accessor.type_, c.0) == wanted => {}
            _ => return Err(format!("{field}: the accessor must hold VEC3 of 32-bit float")),
        }
        let elements = self.elements(accessor, 12, 4, field)?;
        let mut vectors = Vec::with_capacity(elements.count);
        for (k, bytes) in elements.iter().enumerate() {
            let at = |i: usize| f32::from_le_bytes([bytes[i], bytes[i + 1], bytes[i + 2], bytes[i + 3]]);
            let vector = Vec3::new(at(0), at(4), at(8));
            if !vector.is_finite() {
                return Err(format!("{field}: element {k} is {vector}, not finite; repair the mesh and export again"));
            }
            vectors.push(vector);
        }
        Ok(vectors)
    }

    /// A list of vertex indices, each below `vertices`.
    pub fn indices(&self, index: &Index<Accessor>, vertices: usize, field: &str) -> Result<Vec<u32>, Fault> {
        let accessor = get(&self.root.accessors, index, field)?;
        let scalar = accessor.type_ == Checked::Valid(Type::Scalar);
        let size = match &accessor.component_type {
            Checked::Valid(c) if scalar && c.0 == ComponentType::U8 => 1,
            Checked::Valid(c) if scalar && c.0 == ComponentType::U16 => 2,
            Checked::Valid(c) if scalar && c.0 == ComponentType::U32 => 4,
            _ => return Err(format!("{field}: the accessor must hold unsigned integers")),
        };
        let elements = self.elements(accessor, size, size, field)?;
        let mut indices = Vec::with_capacity(elements.count);
        for (k, bytes) in elements.iter().enumerate() {
            let value = bytes.iter().rev().fold(0u32, |sum, b| sum << 8 | u32::from(*b));
            if value as usize >= vertices {
                return Err(format!("{field}: index {value} at {k} is out of range, there are {vertices} vertices"));
            }
            indices.push(value);
        }
        Ok(indices)
    }

    /// The bytes of `accessor` with elements of `size` bytes, all within the buffer.
    fn elements(&self, accessor: &Accessor, size: usize, align: usize, field: &str) -> Result<Elements<'a>, Fault> {
        if accessor.sparse.is_some() {
            return Err(format!("{field}: sparse accessors are not read; export the mesh with its changes applied"));
        }
        let Some(view) = &accessor.buffer_view else {
            return Err(format!("{field}: the accessor has no buffer view (compressed geometry?)"));
        };
        let view = get(&self.root.buffer_views, view, "accessor.bufferView")?;
        let data = self
            .data
            .get(view.buffer.value())
            .ok_or_else(|| format!("{field}: bufferView.buffer {} is out of range", view.buffer.value()))?;
        let stride = view.byte_stride.map_or(size, |s| s.0);
        if stride < size || stride % align != 0 {
            return Err(format!("{field}: byteStride {stride} does not fit elements of {size} bytes"));
        }
        let count = accessor.count.0;
        let bytes = slice(data, view.byte_offset.map_or(0, |o| o.0), view.byte_length.0)
            .and_then(|view| view.get(usize::try_from(accessor.byte_offset.map_or(0, |o| o.0)).ok()?..));
        let needed = count
            .checked_sub(1)
            .map_or(Some(0), |last| last.checked_mul(stride as u64)?.checked_add(size as u64));
        match (bytes, needed) {
            (Some(bytes), Some(needed)) if needed <= bytes.len() as u64 => {
                Ok(Elements { bytes, count: count as usize, stride, size })
            }
            _ => Err(format!("{field}: {count} elements do not fit their buffer; is the file truncated?")),
        }
    }
}

fn slice(data: &[u8], offset: u64, length: u64) -> Option<&[u8]> {
    let end = offset.checked_add(length)?;
    data.get(usize::try_from(offset).ok()?..usize::try_from(end).ok()?)
}

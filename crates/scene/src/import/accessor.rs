//! Accessors with every range checked before anything is read.

use super::{Fault, container::Document, get};
use glam::Vec3;
use gltf::json::{
    Accessor, Index,
    accessor::{ComponentType, Type, sparse::Sparse},
    buffer::View,
    validation::Checked,
};

/// An accessor whose type and range are right; its elements are still bytes.
pub(super) struct Column<'a> {
    /// Where the file names it, for messages.
    field: String,
    elements: Elements<'a>,
    changes: Option<Changes<'a>>,
}

/// Elements of a sparse accessor that differ from its buffer view.
struct Changes<'a> {
    places: Elements<'a>,
    values: Elements<'a>,
}

/// `count` elements of `size` bytes, all within `bytes`.
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

impl<'a> Column<'a> {
    /// A list of float32 vectors.
    pub fn vectors(document: &'a Document, index: &Index<Accessor>, field: String) -> Result<Self, Fault> {
        let accessor = get(&document.root.accessors, index, &field)?;
        let float = component(accessor) == Some(ComponentType::F32);
        if !float && component(accessor).is_some() || accessor.normalized {
            let quantised = "quantised (KHR_mesh_quantization), not 32-bit float; export again without quantisation";
            return Err(format!("{field}: the accessor is {quantised}"));
        }
        if !float || accessor.type_ != Checked::Valid(Type::Vec3) {
            return Err(format!("{field}: the accessor must hold VEC3 of 32-bit float"));
        }
        Column::new(document, accessor, 12, field)
    }

    /// A list of vertex indices.
    pub fn indices(document: &'a Document, index: &Index<Accessor>, field: String) -> Result<Self, Fault> {
        let accessor = get(&document.root.accessors, index, &field)?;
        let size = component(accessor).and_then(unsigned_size);
        match size {
            Some(size) if accessor.type_ == Checked::Valid(Type::Scalar) && !accessor.normalized => {
                Column::new(document, accessor, size, field)
            }
            _ => Err(format!("{field}: the accessor must hold SCALAR unsigned integers, not normalized")),
        }
    }

    fn new(document: &'a Document, accessor: &Accessor, size: usize, field: String) -> Result<Self, Fault> {
        let Some(view) = &accessor.buffer_view else {
            let way_out = "compressed geometry? export again without compression";
            return Err(format!("{field}: the accessor has no bufferView ({way_out})"));
        };
        let fault = |e: Fault| format!("{field}: {e}");
        let offset = accessor.byte_offset.map_or(0, |o| o.0);
        let run = Run { view, offset, count: accessor.count.0, size };
        let elements = run.elements(document).map_err(fault)?;
        let changes = accessor.sparse.as_ref().map(|s| Changes::new(document, s, size)).transpose();
        let changes = changes.map_err(|e| fault(format!("sparse: {e}")))?;
        Ok(Column { field, elements, changes })
    }

    pub fn len(&self) -> usize {
        self.elements.count
    }

    /// The vectors, every component finite.
    pub fn read_vectors(&self) -> Result<Vec<Vec3>, Fault> {
        let vectors = self.read(|bytes| {
            let at = |i: usize| f32::from_le_bytes([bytes[i], bytes[i + 1], bytes[i + 2], bytes[i + 3]]);
            Vec3::new(at(0), at(4), at(8))
        })?;
        match vectors.iter().enumerate().find(|(_, v)| !v.is_finite()) {
            Some((k, v)) => {
                Err(format!("{}: element {k} is {v}, not finite; repair the mesh and export again", self.field))
            }
            None => Ok(vectors),
        }
    }

    /// The indices, each below `vertices`.
    pub fn read_indices(&self, vertices: usize) -> Result<Vec<u32>, Fault> {
        let indices = self.read(unsigned)?;
        match indices.iter().enumerate().find(|(_, i)| **i as usize >= vertices) {
            Some((k, i)) => {
                Err(format!("{}: index {i} at {k} is out of range, there are {vertices} vertices", self.field))
            }
            None => Ok(indices),
        }
    }

    fn read<T>(&self, decode: impl Fn(&[u8]) -> T) -> Result<Vec<T>, Fault> {
        let mut list: Vec<T> = self.elements.iter().map(&decode).collect();
        let Some(changes) = &self.changes else { return Ok(list) };
        for (place, value) in changes.places.iter().zip(changes.values.iter()) {
            let k = unsigned(place) as usize;
            let slot = list.get_mut(k).ok_or_else(|| format!("{}: sparse index {k} is out of range", self.field))?;
            *slot = decode(value);
        }
        Ok(list)
    }
}

impl<'a> Changes<'a> {
    fn new(document: &'a Document, sparse: &Sparse, size: usize) -> Result<Self, Fault> {
        let count = sparse.count.0;
        let (indices, values) = (&sparse.indices, &sparse.values);
        let index_size = match &indices.component_type {
            Checked::Valid(c) => unsigned_size(c.0),
            Checked::Invalid => None,
        };
        let index_size = index_size.ok_or("the indices must be unsigned integers")?;
        let places = Run { view: &indices.buffer_view, offset: indices.byte_offset.0, count, size: index_size };
        let values = Run { view: &values.buffer_view, offset: values.byte_offset.0, count, size };
        Ok(Changes { places: places.elements(document)?, values: values.elements(document)? })
    }
}

/// Elements as the file describes them, in a buffer view.
struct Run<'a> {
    view: &'a Index<View>,
    offset: u64,
    count: u64,
    size: usize,
}

impl Run<'_> {
    /// The elements, if all lie within view and buffer.
    fn elements<'a>(&self, document: &'a Document) -> Result<Elements<'a>, Fault> {
        let view = get(&document.root.buffer_views, self.view, "accessor.bufferView")?;
        let buffer = view.buffer.value();
        let data = document.buffer(buffer).ok_or_else(|| format!("bufferView.buffer {buffer} is out of range"))?;
        let (size, count) = (self.size, self.count);
        let stride = view.byte_stride.map_or(size, |s| s.0);
        if stride < size || stride % size.min(4) != 0 {
            return Err(format!("byteStride {stride} does not fit elements of {size} bytes"));
        }
        let (start, length) = (view.byte_offset.map_or(0, |o| o.0), view.byte_length.0);
        let Some(bytes) = part(data, start, length) else {
            let have = data.len();
            return Err(format!("the bufferView (bytes {start} + {length}) exceeds its buffer of {have} bytes"));
        };
        let bytes = part(bytes, self.offset, length.saturating_sub(self.offset)).unwrap_or_default();
        let needed = count.checked_sub(1).map_or(Some(0), |n| n.checked_mul(stride as u64)?.checked_add(size as u64));
        if needed.is_none_or(|n| n > bytes.len() as u64) {
            let have = bytes.len();
            return Err(format!("{count} elements of {size} bytes do not fit the {have} bytes of their bufferView"));
        }
        Ok(Elements { bytes, count: count as usize, stride, size })
    }
}

fn part(data: &[u8], start: u64, length: u64) -> Option<&[u8]> {
    let end = start.checked_add(length)?;
    data.get(usize::try_from(start).ok()?..usize::try_from(end).ok()?)
}

fn component(accessor: &Accessor) -> Option<ComponentType> {
    match &accessor.component_type {
        Checked::Valid(c) => Some(c.0),
        Checked::Invalid => None,
    }
}

fn unsigned_size(component: ComponentType) -> Option<usize> {
    match component {
        ComponentType::U8 => Some(1),
        ComponentType::U16 => Some(2),
        ComponentType::U32 => Some(4),
        _ => None,
    }
}

/// Little-endian.
fn unsigned(bytes: &[u8]) -> u32 {
    bytes.iter().rev().fold(0, |sum, b| sum << 8 | u32::from(*b))
}

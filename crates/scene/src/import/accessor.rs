//! Accessors and their little-endian numbers. Ranges are checked before any element is read.

use super::{
    container::{Document, part},
    fault::{Fault, Result, get},
};
use gltf::json::{
    Accessor, Index,
    accessor::{ComponentType, Type, sparse::Sparse},
    buffer::View,
    validation::Checked,
};
use std::borrow::Cow;

/// An accessor whose type and range are checked. Its elements are still bytes.
pub(super) struct CheckedAccessor<'a> {
    /// The field of the file that names it, for messages.
    field: String,
    /// The type of its numbers.
    number: Number,
    elements: Elements<'a>,
    changes: Option<Changes<'a>>,
}

/// Elements of a sparse accessor that replace those of its buffer view.
struct Changes<'a> {
    indices: Elements<'a>,
    values: Elements<'a>,
}

/// `count` elements of `size` bytes, all within `bytes`.
struct Elements<'a> {
    bytes: Cow<'a, [u8]>,
    count: usize,
    stride: usize,
    size: usize,
}

impl Elements<'_> {
    fn iter(&self) -> impl Iterator<Item = &[u8]> {
        (0..self.count).map(|k| self.get(k))
    }

    /// Element `k`, which is below `count`.
    fn get(&self, k: usize) -> &[u8] {
        &self.bytes[k * self.stride..k * self.stride + self.size]
    }
}

impl<'a> CheckedAccessor<'a> {
    /// A list of vectors of float32 or quantized (KHR_mesh_quantization).
    pub fn vectors(document: &'a Document, index: &Index<Accessor>, field: String) -> Result<Self> {
        let expected = "VEC3 of 32-bit float, or of 8 or 16-bit integers";
        CheckedAccessor::new(document, index, field, Number::of_vector, &[Type::Vec3], expected)
    }

    /// A list of texture coordinates of float32 or integers.
    pub fn coordinates(document: &'a Document, index: &Index<Accessor>, field: String) -> Result<Self> {
        let expected = "VEC2 of 32-bit float, or of 8 or 16-bit integers";
        CheckedAccessor::new(document, index, field, Number::of_vector, &[Type::Vec2], expected)
    }

    /// A list of colors with or without alpha, of float32 or normalized integers.
    pub fn colors(document: &'a Document, index: &Index<Accessor>, field: String) -> Result<Self> {
        let expected = "VEC3 or VEC4 of 32-bit float, or of normalized 8 or 16-bit unsigned integers";
        CheckedAccessor::new(document, index, field, Number::of_color, &[Type::Vec3, Type::Vec4], expected)
    }

    /// A list of tangents, each with the sign of its bitangent.
    pub fn tangents(document: &'a Document, index: &Index<Accessor>, field: String) -> Result<Self> {
        let expected = "VEC4 of 32-bit float, or of 8 or 16-bit integers";
        CheckedAccessor::new(document, index, field, Number::of_vector, &[Type::Vec4], expected)
    }

    /// A list of vertex indices.
    pub fn indices(document: &'a Document, index: &Index<Accessor>, field: String) -> Result<Self> {
        let expected = "SCALAR unsigned integers, not normalized";
        CheckedAccessor::new(document, index, field, Number::of_index, &[Type::Scalar], expected)
    }

    /// Keys and values of animations, and places of copies: of float32 or normalized integers.
    pub fn animated(document: &'a Document, index: &Index<Accessor>, field: String, shape: Type) -> Result<Self> {
        let shape_name = format!("{shape:?}").to_uppercase();
        let expected = format!("{shape_name} of 32-bit float, or of normalized 8 or 16-bit integers");
        CheckedAccessor::new(document, index, field, Number::of_animation, &[shape], &expected)
    }

    /// A list of matrices by columns.
    pub fn matrices(document: &'a Document, index: &Index<Accessor>, field: String) -> Result<Self> {
        let expected = "MAT4 of 32-bit float";
        CheckedAccessor::new(document, index, field, Number::of_matrix, &[Type::Mat4], expected)
    }

    /// The joints of each vertex, four to a set.
    pub fn joints(document: &'a Document, index: &Index<Accessor>, field: String) -> Result<Self> {
        let expected = "VEC4 of 8 or 16-bit unsigned integers, not normalized";
        CheckedAccessor::new(document, index, field, Number::of_joint, &[Type::Vec4], expected)
    }

    /// The weights of the joints of each vertex.
    pub fn weights(document: &'a Document, index: &Index<Accessor>, field: String) -> Result<Self> {
        CheckedAccessor::animated(document, index, field, Type::Vec4)
    }

    /// Elements of one of these shapes, of numbers that `number` accepts: what is `expected`.
    fn new(
        document: &'a Document,
        index: &Index<Accessor>,
        field: String,
        number: fn(ComponentType, bool) -> Option<Number>,
        shapes: &[Type],
        expected: &str,
    ) -> Result<Self> {
        let accessor = get(&document.root.accessors, index, &field)?;
        let number = valid(&accessor.component_type).and_then(|c| number(c.0, accessor.normalized));
        let shape = shapes.iter().find(|shape| accessor.type_ == Checked::Valid(**shape));
        let (Some(number), Some(shape)) = (number, shape) else {
            return Err(format!("{field}: the accessor must hold {expected}"));
        };
        let fault = |e: Fault| format!("{field}: {e}");
        let (count, unit) = (accessor.count.0, number.size());
        let size = shape.multiplicity() * unit;
        let elements = match &accessor.buffer_view {
            Some(view) => {
                let offset = accessor.byte_offset.map_or(0, |o| o.0);
                Run { view, offset, count, size, unit }.elements(document)
            }
            None if accessor.sparse.is_some() => zeros(count, size, document.longest),
            None => Err("the accessor has no bufferView (a compression that is not supported?)".into()),
        };
        let elements = elements.map_err(fault)?;
        let changes = accessor.sparse.as_ref().map(|s| Changes::new(document, s, count, size, unit)).transpose();
        let changes = changes.map_err(|e| fault(format!("sparse: {e}")))?;
        Ok(CheckedAccessor { field, number, elements, changes })
    }

    /// Vectors that were decoded, of `components` numbers.
    pub fn of_reals(field: String, numbers: &[f32], components: usize) -> Self {
        let bytes = numbers.iter().flat_map(|x| x.to_le_bytes()).collect();
        let number = Number { component: ComponentType::F32, normalized: false };
        CheckedAccessor::of_bytes(field, number, bytes, components)
    }

    /// Indices that were decoded.
    pub fn of_indices(field: String, indices: &[u32]) -> Self {
        let bytes = indices.iter().flat_map(|x| x.to_le_bytes()).collect();
        CheckedAccessor::of_bytes(field, Number { component: ComponentType::U32, normalized: false }, bytes, 1)
    }

    fn of_bytes(field: String, number: Number, bytes: Vec<u8>, components: usize) -> Self {
        let size = components * number.size();
        let elements = Elements { count: bytes.len() / size, bytes: bytes.into(), stride: size, size };
        CheckedAccessor { field, number, elements, changes: None }
    }

    pub fn len(&self) -> usize {
        self.elements.count
    }

    /// The elements. Every number is finite, and components that the accessor lacks are 1.
    pub fn read_reals<const N: usize>(&self) -> Result<Vec<[f32; N]>> {
        let number = self.number;
        let list = self.read(|bytes| number.reals(bytes))?;
        match list.iter().enumerate().find(|(_, v)| !v.iter().all(|x| x.is_finite())) {
            // Here and below, messages do not state the value, because a link can make a buffer of any file.
            Some((k, _)) => Err(format!("{}: element {k} is not finite; repair the mesh and export again", self.field)),
            None => Ok(list),
        }
    }

    /// One element, which is below the number of elements, without reading the others.
    pub fn real<const N: usize>(&self, k: usize) -> Result<[f32; N]> {
        let sparse = self.changes.as_ref().and_then(|changes| changes.of(k));
        let numbers = self.number.reals(sparse.unwrap_or_else(|| self.elements.get(k)));
        if numbers.iter().all(|x: &f32| x.is_finite()) {
            return Ok(numbers);
        }
        Err(format!("{}: element {k} is not finite; repair the file and export again", self.field))
    }

    /// The indices, each below `vertices`.
    pub fn read_indices(&self, vertices: usize) -> Result<Vec<u32>> {
        let indices = self.read(Number::unsigned)?;
        match indices.iter().enumerate().find(|(_, i)| **i as usize >= vertices) {
            Some((k, _)) => {
                Err(format!("{}: the index at {k} is out of range, there are {vertices} vertices", self.field))
            }
            None => Ok(indices),
        }
    }

    fn read<T>(&self, decode: impl Fn(&[u8]) -> T) -> Result<Vec<T>> {
        let mut list: Vec<T> = self.elements.iter().map(&decode).collect();
        let Some(changes) = &self.changes else { return Ok(list) };
        for (at, (index, value)) in changes.indices.iter().zip(changes.values.iter()).enumerate() {
            let slot = list.get_mut(Number::unsigned(index) as usize);
            let slot = slot.ok_or_else(|| format!("{}: the sparse index at {at} is out of range", self.field))?;
            *slot = decode(value);
        }
        Ok(list)
    }
}

impl<'a> Changes<'a> {
    /// The new value of element `k`, by bisection: glTF says that the indices ascend.
    fn of(&self, k: usize) -> Option<&[u8]> {
        let at = |i: usize| Number::unsigned(self.indices.get(i)) as usize;
        let (mut low, mut high) = (0, self.indices.count);
        while low < high {
            let middle = low + (high - low) / 2;
            if at(middle) < k {
                low = middle + 1;
            } else {
                high = middle;
            }
        }
        (low < self.indices.count && at(low) == k).then(|| self.values.get(low))
    }

    /// The changes of an accessor of `all` elements. There are at most as many, so that a short accessor is not slow to
    /// read.
    fn new(document: &'a Document, sparse: &Sparse, all: u64, size: usize, unit: usize) -> Result<Self> {
        let count = sparse.count.0;
        if count > all {
            return Err(format!("count {count} exceeds the {all} elements of the accessor"));
        }
        let (indices, values) = (&sparse.indices, &sparse.values);
        let index_size = valid(&indices.component_type).and_then(|c| Number::of_index(c.0, false)).map(Number::size);
        let index_size = index_size.ok_or("the indices must be unsigned integers")?;
        let offset = indices.byte_offset.0;
        let replaced = Run { view: &indices.buffer_view, offset, count, size: index_size, unit: index_size };
        let values = Run { view: &values.buffer_view, offset: values.byte_offset.0, count, size, unit };
        Ok(Changes { indices: replaced.elements(document)?, values: values.elements(document)? })
    }
}

/// Elements as the file describes them, in a buffer view.
struct Run<'a> {
    view: &'a Index<View>,
    offset: u64,
    count: u64,
    size: usize,
    /// Bytes of one of the numbers that an element is made of.
    unit: usize,
}

impl Run<'_> {
    /// The elements, if all lie within view and buffer.
    fn elements<'a>(&self, document: &'a Document) -> Result<Elements<'a>> {
        let view = get(&document.root.buffer_views, self.view, "accessor.bufferView")?;
        let (size, count) = (self.size, self.count);
        let stride = view.byte_stride.map_or(size, |s| s.0);
        if stride < size || stride % self.unit != 0 {
            return Err(format!("byteStride {stride} does not fit elements of {size} bytes"));
        }
        let bytes = document.view(self.view)?;
        let bytes = part(bytes, self.offset, (bytes.len() as u64).saturating_sub(self.offset)).unwrap_or_default();
        let needed = count.checked_sub(1).map_or(Some(0), |n| n.checked_mul(stride as u64)?.checked_add(size as u64));
        if needed.is_none_or(|n| n > bytes.len() as u64) {
            let have = bytes.len();
            return Err(format!("{count} elements of {size} bytes do not fit the {have} bytes of their bufferView"));
        }
        Ok(Elements { bytes: bytes.into(), count: count as usize, stride, size })
    }
}

/// Fewest bytes of a vertex in a file: an aligned position of 8-bit integers.
const MIN_BYTES_PER_VERTEX: u64 = 4;

/// The zeros that a sparse accessor without a buffer view changes. They take no bytes of the file, but other attributes
/// of the same vertices do; without this limit, a short file could need any memory.
fn zeros(count: u64, size: usize, longest: usize) -> Result<Elements<'static>> {
    const ZEROS: [u8; 64] = [0; 64];
    let limit = longest as u64 / MIN_BYTES_PER_VERTEX;
    if count > limit {
        return Err(format!("{count} elements without a bufferView, a file of this length holds at most {limit}"));
    }
    Ok(Elements { bytes: ZEROS[..].into(), count: count as usize, stride: 0, size })
}

/// The value of a field of the file, if glTF knows it.
fn valid<T: Copy>(field: &Checked<T>) -> Option<T> {
    match field {
        Checked::Valid(value) => Some(*value),
        Checked::Invalid => None,
    }
}

/// The type of a number.
#[derive(Clone, Copy)]
struct Number {
    component: ComponentType,
    /// Integers represent 0 to 1, or -1 to 1.
    normalized: bool,
}

impl Number {
    /// The type of a component of a position or normal: float32, or an integer of 8 or 16 bits (KHR_mesh_quantization).
    fn of_vector(component: ComponentType, normalized: bool) -> Option<Number> {
        let refused = matches!((component, normalized), (ComponentType::U32, _) | (ComponentType::F32, true));
        (!refused).then_some(Number { component, normalized })
    }

    /// The type of a component of a color: float32, or an integer of 8 or 16 bits that represents 0 to 1.
    fn of_color(component: ComponentType, normalized: bool) -> Option<Number> {
        use ComponentType::{F32, U8, U16};
        let allowed = matches!((component, normalized), (F32, false) | (U8 | U16, true));
        allowed.then_some(Number { component, normalized })
    }

    /// The type of a component of a key of an animation.
    fn of_animation(component: ComponentType, normalized: bool) -> Option<Number> {
        use ComponentType::{F32, U32};
        let allowed = if normalized { !matches!(component, F32 | U32) } else { component == F32 };
        allowed.then_some(Number { component, normalized })
    }

    /// The type of an element of a matrix.
    fn of_matrix(component: ComponentType, normalized: bool) -> Option<Number> {
        (component == ComponentType::F32 && !normalized).then_some(Number { component, normalized })
    }

    /// The type of a joint's index.
    fn of_joint(component: ComponentType, normalized: bool) -> Option<Number> {
        let allowed = matches!(component, ComponentType::U8 | ComponentType::U16) && !normalized;
        allowed.then_some(Number { component, normalized })
    }

    /// The type of a vertex index.
    fn of_index(component: ComponentType, normalized: bool) -> Option<Number> {
        let allowed = matches!(component, ComponentType::U8 | ComponentType::U16 | ComponentType::U32) && !normalized;
        allowed.then_some(Number { component, normalized })
    }

    /// Size, bytes.
    fn size(self) -> usize {
        self.component.size()
    }

    /// The values of an element. Components that it lacks are 1.
    fn reals<const N: usize>(self, bytes: &[u8]) -> [f32; N] {
        let mut numbers = bytes.chunks_exact(self.size()).map(|b| self.real(b));
        std::array::from_fn(|_| numbers.next().unwrap_or(1.0))
    }

    /// The value of its bytes.
    fn real(self, bytes: &[u8]) -> f32 {
        let bits = Number::unsigned(bytes);
        let (value, largest) = match self.component {
            ComponentType::I8 => (f32::from(bits as u8 as i8), 127.0),
            ComponentType::U8 => (f32::from(bits as u8), 255.0),
            ComponentType::I16 => (f32::from(bits as u16 as i16), 32767.0),
            ComponentType::U16 => (f32::from(bits as u16), 65535.0),
            ComponentType::U32 | ComponentType::F32 => return f32::from_bits(bits),
        };
        // The smallest integer is a little below -1.
        if self.normalized { (value / largest).max(-1.0) } else { value }
    }

    /// The value of up to four bytes as an unsigned integer.
    fn unsigned(bytes: &[u8]) -> u32 {
        bytes.iter().rev().fold(0, |sum, b| sum << 8 | u32::from(*b))
    }
}

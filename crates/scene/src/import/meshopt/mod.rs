//! EXT_meshopt_compression and KHR_meshopt_compression: buffer views whose bytes are compressed. The decoders follow the
//! specifications of the bitstream there, and check every read: what a stream lacks or has too much is an error.

mod attributes;
mod filters;
mod indices;
mod triangles;

use super::fault::Result;
use gltf::json::buffer::View;
use serde::Deserialize;

/// The names of the extension.
pub(super) const NAMES: [&str; 2] = ["EXT_meshopt_compression", "KHR_meshopt_compression"];

/// The extension's object of a buffer view.
#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct Compressed {
    pub buffer: usize,
    #[serde(default)]
    pub byte_offset: u64,
    pub byte_length: u64,
    byte_stride: usize,
    count: usize,
    mode: Mode,
    #[serde(default)]
    filter: Filter,
}

#[derive(Clone, Copy, Deserialize, PartialEq)]
#[serde(rename_all = "UPPERCASE")]
enum Mode {
    Attributes,
    Triangles,
    Indices,
}

/// What is undone after an attribute is decoded.
#[derive(Clone, Copy, Default, Deserialize, PartialEq)]
#[serde(rename_all = "UPPERCASE")]
enum Filter {
    #[default]
    None,
    Octahedral,
    Quaternion,
    Exponential,
    Color,
}

impl Compressed {
    /// The extension's object, if the view has one; its numbers fit each other and the view.
    pub fn of(view: &View) -> Result<Option<Compressed>> {
        let others = view.extensions.as_ref().map(|e| &e.others);
        let found = NAMES.iter().find_map(|name| Some((name, others?.get(*name)?)));
        let Some((name, object)) = found else { return Ok(None) };
        let compressed = Compressed::deserialize(object).map_err(|e| format!("{name}: {e}"))?;
        compressed.check(view).map_err(|what| format!("{name}: {what}"))?;
        Ok(Some(compressed))
    }

    fn check(&self, view: &View) -> Result<()> {
        let stride = self.byte_stride;
        let length = stride.checked_mul(self.count).map(|length| length as u64);
        if length != Some(view.byte_length.0) || view.byte_stride.is_some_and(|own| own.0 != stride) {
            return Err("count and byteStride differ from those of the bufferView".into());
        }
        let fits = match self.mode {
            Mode::Attributes => stride > 0 && stride.is_multiple_of(4) && stride <= 256,
            Mode::Triangles => matches!(stride, 2 | 4) && self.count.is_multiple_of(3),
            Mode::Indices => matches!(stride, 2 | 4),
        };
        let filtered = match self.filter {
            Filter::None => true,
            Filter::Octahedral | Filter::Color => matches!(stride, 4 | 8),
            Filter::Quaternion => stride == 8,
            Filter::Exponential => stride.is_multiple_of(4),
        };
        if !fits || !filtered || self.filter != Filter::None && self.mode != Mode::Attributes {
            return Err(format!("byteStride {stride} and count {} do not fit the mode and filter", self.count));
        }
        Ok(())
    }

    /// Bytes of the view after decoding.
    pub fn decoded_bytes(&self) -> u64 {
        self.byte_stride as u64 * self.count as u64
    }

    /// Decodes the stream. The memory is at most 64 times that of the stream, except for streams of version 1.
    pub fn decode(&self, stream: &[u8]) -> Result<Vec<u8>> {
        let (count, stride) = (self.count, self.byte_stride);
        let decoded = match self.mode {
            Mode::Attributes => attributes::decode(stream, count, stride),
            Mode::Triangles => triangles::decode(stream, count / 3).map(|list| bytes_of(list.as_flattened(), stride)),
            Mode::Indices => indices::decode(stream, count).map(|list| bytes_of(&list, stride)),
        };
        let mut decoded = decoded.ok_or("the compressed stream is damaged; export or convert the file again")?;
        match self.filter {
            Filter::None => {}
            Filter::Octahedral => filters::octahedral(&mut decoded, stride),
            Filter::Quaternion => filters::quaternion(&mut decoded),
            Filter::Exponential => filters::exponential(&mut decoded),
            Filter::Color => filters::color(&mut decoded, stride),
        }
        Ok(decoded)
    }
}

/// Indices as little-endian numbers of 2 or 4 bytes.
fn bytes_of(indices: &[u32], stride: usize) -> Vec<u8> {
    indices.iter().flat_map(|i| i.to_le_bytes().into_iter().take(stride)).collect()
}

/// Takes a number of 7 bits to a byte, the lowest first, off the front of a stream. Extra bits are ignored.
fn varint(stream: &mut &[u8]) -> Option<u32> {
    let mut value = 0;
    for shift in [0, 7, 14, 21, 28] {
        let byte = *stream.split_off_first()?;
        value |= u32::from(byte & 0x7f) << shift;
        if byte < 0x80 {
            return Some(value);
        }
    }
    None
}

/// The signed number whose sign is the lowest bit.
fn unzigzag(v: u32) -> u32 {
    if v & 1 == 0 { v >> 1 } else { !(v >> 1) }
}

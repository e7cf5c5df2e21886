//! The container, .glb or .gltf, and its buffers.

use super::{
    fault::{Result, get},
    features,
    files::{self, Files},
    foreign, meshopt,
    survey::Survey,
    text::{Animation, OF_VERSION_1, Text},
    transform::NodeTransform,
};
use crate::error::SceneError;
use gltf::json::{self, Index, buffer::View};
use std::{
    cell::{Cell, OnceCell, RefCell},
    collections::BTreeMap,
    ops::Range,
    path::Path,
    rc::Rc,
};

/// A parsed file with its buffers. Its content is not checked yet.
pub(super) struct Document {
    /// The file itself and the files that it names.
    pub files: RefCell<Files>,
    pub root: json::Root,
    pub animations: Vec<Animation>,
    /// The transform of each node.
    pub transforms: Vec<NodeTransform>,
    /// Properties of the file that are not honoured.
    pub survey: Survey,
    /// Length of the file or of its longest buffer, bytes.
    pub longest: usize,
    bytes: Vec<u8>,
    buffers: Vec<Buffer>,
    /// The bytes of compressed buffer views, once they were needed.
    decoded: Vec<OnceCell<Vec<u8>>>,
    /// Bytes that may still be decoded.
    room: Cell<u64>,
}

/// The most memory that compressed geometry may need for each byte of the file's buffers. Without this limit, a short
/// file could need any memory. Streams of meshopt reach 64, those of Draco rarely 40.
const EXPANSION: u64 = 64;
/// The most memory that compressed geometry of any file may need, bytes: a character of 220,000 triangles has been seen in
/// 430 kB.
const FREE: u64 = 256 << 20;

/// The bytes of a buffer.
enum Buffer {
    /// A range of the .glb itself.
    Chunk(Range<usize>),
    /// A file or a data URI, and the length of the buffer. Buffers that name the same file share it.
    Loaded(Rc<Vec<u8>>, usize),
    /// Stands for what is compressed elsewhere.
    Absent,
}

impl Buffer {
    fn len(&self) -> usize {
        match self {
            Buffer::Chunk(range) => range.len(),
            Buffer::Loaded(_, length) => *length,
            Buffer::Absent => 0,
        }
    }
}

impl Document {
    pub fn read(path: &Path) -> Result<Document, SceneError> {
        let bytes = files::read(path).map_err(|source| SceneError::Read { path: path.to_owned(), source })?;
        Document::parse(bytes, path).map_err(|what| SceneError::Invalid { path: path.to_owned(), what })
    }

    fn parse(bytes: Vec<u8>, path: &Path) -> Result<Document> {
        if let Some(what) = foreign::name(&bytes, path) {
            return Err(what);
        }
        let whole = 0..bytes.len();
        let (text, chunk) = if bytes.starts_with(b"glTF") { split_glb(&bytes)? } else { (whole, None) };
        let text = &bytes[text];
        let text = text.strip_prefix(b"\xef\xbb\xbf").unwrap_or(text); // Some editors write a byte order mark.
        let text = Text::parse(text)?;
        check_version(&text.root.asset)?;
        // What the file needs is said before what is missing without it.
        features::check(&text)?;
        let mut files = Files::new(path);
        let mut buffers = Vec::with_capacity(text.root.buffers.len());
        for (k, buffer) in text.root.buffers.iter().enumerate() {
            // Buffers that stand for what is compressed need not be there.
            let is_needless = buffer.uri.is_none() && (k > 0 || chunk.is_none()) && is_compressed(&text);
            let chunk = chunk.clone();
            buffers.push(if is_needless { Buffer::Absent } else { locate(k, buffer, chunk, &mut files)? });
        }
        let longest = buffers.iter().map(Buffer::len).fold(bytes.len(), usize::max);
        let files = RefCell::new(files);
        let Text { root, animations, transforms, survey } = text;
        let decoded = vec![OnceCell::new(); root.buffer_views.len()];
        let room = Cell::new(0);
        let document = Document { files, root, animations, transforms, survey, longest, bytes, buffers, decoded, room };
        document.room.set(document.buffer_bytes().saturating_mul(EXPANSION).saturating_add(FREE));
        Ok(document)
    }

    /// Bytes of compressed geometry that may still be decoded.
    pub fn room(&self) -> u64 {
        self.room.get()
    }

    /// Takes decoded bytes off that limit.
    pub fn spend(&self, bytes: u64) -> Result<()> {
        let left = self.room.get().checked_sub(bytes);
        self.room.set(left.ok_or("the compressed geometry is too large for the length of the file")?);
        Ok(())
    }

    /// The first `byteLength` bytes of a buffer.
    pub fn buffer(&self, index: usize) -> Option<&[u8]> {
        match self.buffers.get(index)? {
            Buffer::Chunk(range) => self.bytes.get(range.clone()),
            Buffer::Loaded(data, length) => data.get(..*length),
            Buffer::Absent => None,
        }
    }

    /// Bytes of all buffers; shared ones count once.
    pub fn buffer_bytes(&self) -> u64 {
        let mut longest_at: BTreeMap<*const u8, usize> = BTreeMap::new();
        for data in (0..self.buffers.len()).filter_map(|k| self.buffer(k)) {
            let known = longest_at.entry(data.as_ptr()).or_default();
            *known = data.len().max(*known);
        }
        longest_at.values().map(|length| *length as u64).sum()
    }

    /// The bytes of a buffer view, decoded if they are compressed.
    pub fn view(&self, index: &Index<View>) -> Result<&[u8]> {
        let view = get(&self.root.buffer_views, index, "bufferView")?;
        let Some(compressed) = meshopt::Compressed::of(view)? else {
            let (start, length) = (view.byte_offset.map_or(0, |o| o.0), view.byte_length.0);
            return self.range(view.buffer.value(), start, length);
        };
        let cell = self.decoded.get(index.value()).ok_or("bufferView: out of range")?;
        if cell.get().is_none() {
            self.spend(compressed.decoded_bytes())?;
            let stream = self.range(compressed.buffer, compressed.byte_offset, compressed.byte_length)?;
            // It was empty.
            _ = cell.set(compressed.decode(stream).map_err(|e| format!("bufferViews[{}]: {e}", index.value()))?);
        }
        Ok(cell.get().map_or(&[], Vec::as_slice))
    }

    /// Bytes of a buffer.
    fn range(&self, buffer: usize, start: u64, length: u64) -> Result<&[u8]> {
        if matches!(self.buffers.get(buffer), Some(Buffer::Absent)) {
            return Err(format!("buffers[{buffer}] has no uri and the file no binary chunk for it"));
        }
        let data = self.buffer(buffer).ok_or_else(|| format!("bufferView.buffer {buffer} is out of range"))?;
        part(data, start, length).ok_or_else(|| {
            let have = data.len();
            format!("the bufferView (bytes {start} + {length}) exceeds its buffer of {have} bytes")
        })
    }
}

/// A part of the bytes; none if it exceeds them.
pub(super) fn part(data: &[u8], start: u64, length: u64) -> Option<&[u8]> {
    let end = start.checked_add(length)?;
    data.get(usize::try_from(start).ok()?..usize::try_from(end).ok()?)
}

fn check_version(asset: &json::Asset) -> Result<()> {
    if !asset.version.starts_with("2.") {
        return Err(format!("asset.version is `{}`; only glTF 2 is supported", asset.version));
    }
    match &asset.min_version {
        Some(version) if version != "2.0" => Err(format!("asset.minVersion is `{version}`; only 2.0 is supported")),
        _ => Ok(()),
    }
}

/// Whether the file declares compressed buffer views.
fn is_compressed(text: &Text) -> bool {
    text.root.extensions_used.iter().chain(&text.survey.extensions).any(|n| meshopt::NAMES.contains(&n.as_str()))
}

/// Finds the bytes of buffer `k`, and checks their number.
fn locate(k: usize, buffer: &json::Buffer, chunk: Option<Range<usize>>, files: &mut Files) -> Result<Buffer> {
    let wanted = buffer.byte_length.0;
    let enough = |have: usize| match usize::try_from(wanted) {
        Ok(wanted) if wanted <= have => Ok(wanted),
        _ => Err(format!("buffers[{k}] holds {have} bytes, byteLength says {wanted}; is the file truncated?")),
    };
    match (&buffer.uri, chunk) {
        (Some(uri), _) => {
            let data = files.resolve(uri).map_err(|e| format!("buffers[{k}].uri: {e}"))?;
            let length = enough(data.len())?;
            Ok(Buffer::Loaded(data, length))
        }
        (None, Some(chunk)) if k == 0 => {
            let length = enough(chunk.len())?;
            Ok(Buffer::Chunk(chunk.start..chunk.start + length))
        }
        (None, _) => Err(format!("buffers[{k}] has no uri and the file no binary chunk for it")),
    }
}

/// The ranges of the JSON chunk and of the binary chunk, which is the second one if there is any.
fn split_glb(bytes: &[u8]) -> Result<(Range<usize>, Option<Range<usize>>)> {
    let version = word(bytes, 4)?;
    if version != 2 {
        let way_out = if version == 1 { format!("; {OF_VERSION_1}") } else { String::new() };
        return Err(format!("the .glb has version {version}; only version 2 is supported{way_out}"));
    }
    let length = word(bytes, 8)? as usize;
    let Some(bytes) = bytes.get(..length) else {
        return Err(format!("the .glb is truncated: {} of {length} bytes are there", bytes.len()));
    };
    let (kind, text) = chunk_at(bytes, 12)?;
    if &kind != b"JSON" {
        return Err(format!("the first chunk of the .glb is `{}`, not `JSON`", kind.escape_ascii()));
    }
    // Some writers leave the padding out.
    let unpadded = chunk_at(bytes, text.end).is_ok_and(|(kind, _)| &kind == b"BIN\0");
    let second = if unpadded { text.end } else { text.end.next_multiple_of(4) };
    if second >= length {
        return Ok((text, None));
    }
    let (kind, binary) = chunk_at(bytes, second)?;
    // glTF says that chunks of other kinds are ignored.
    Ok((text, (&kind == b"BIN\0").then_some(binary)))
}

/// The kind of the chunk at a byte of a .glb, and the range of its content.
fn chunk_at(bytes: &[u8], at: usize) -> Result<([u8; 4], Range<usize>)> {
    let size = word(bytes, at)? as usize;
    let kind = word(bytes, at + 4)?.to_le_bytes();
    let (start, left) = (at + 8, bytes.len() - (at + 8));
    if size > left {
        return Err(format!("the .glb chunk at byte {at} has {size} bytes, {left} are left; is the file truncated?"));
    }
    Ok((kind, start..start + size))
}

fn word(bytes: &[u8], at: usize) -> Result<u32> {
    let four = bytes.get(at..at.saturating_add(4)).and_then(|b| b.try_into().ok());
    four.map(u32::from_le_bytes).ok_or_else(|| "the .glb header is truncated".into())
}

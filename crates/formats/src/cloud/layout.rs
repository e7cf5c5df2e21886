//! Header and section table of a cloud: their bytes and checks.
//!
//! ```text
//! offset  bytes  field
//!      0      8  magic 89 'P' 'C' 'L' 0D 0A 1A 0A
//!      8    2+2  version (major, minor)
//!     12      4  flags, zero
//!     16      8  file length
//!     24      8  stored samples
//!     32    4+4  sections, bytes per table entry (64)
//!     40     16  zero
//!     56      8  xxh3-64 of bytes 0..56 and the table
//!     64   64·n  table
//! ```
//!
//! A table entry: name (16, zero padded); element type, components, layout, codec (4 × u16); offset, stored bytes, raw
//! bytes, elements (4 × u64); checksum of the stored bytes (u64). Layout 1: elements follow each other, and within each
//! its components. The checksum is the xxh3-64 of up to 256 KiB; of more it is the xxh3-64 of those of its blocks of
//! 256 KiB, in order, as little-endian numbers, so that several threads may check a large section at once.

use xxhash_rust::xxh3::{Xxh3, xxh3_64};

pub(super) const MAGIC: [u8; 8] = [0x89, b'P', b'C', b'L', 0x0D, 0x0A, 0x1A, 0x0A];
pub(super) const HEADER: usize = 64;
const ENTRY: usize = 64;
const MAX_SECTIONS: u32 = 64;
/// Sections start at multiples of this; the tiles start at a page.
const ALIGN: u64 = 64;
const PAGE: u64 = 4096;
/// Bytes of the blocks by which a section is checked. A block fits the cache of a core, so that it is read from memory
/// once for its checksum and for its values.
pub(super) const BLOCK: usize = 1 << 18;
/// The layout in which elements follow each other.
const RECORDS: u16 = 1;

/// The major version of the format. It is raised when a record changes its meaning.
pub fn version() -> u16 {
    include_str!("../../cloud-version").trim().parse().unwrap_or(0)
}

/// Type of a section's elements.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u16)]
pub(super) enum Kind {
    F32 = 1,
    U32 = 3,
    U8 = 5,
}

impl Kind {
    fn size(self) -> u64 {
        match self {
            Kind::F32 | Kind::U32 => 4,
            Kind::U8 => 1,
        }
    }
}

/// A section to be written, or one that was read and checked.
#[derive(Clone, Debug)]
pub(super) struct Section {
    pub name: &'static str,
    pub kind: Kind,
    pub components: u16,
    pub offset: u64,
    pub bytes: u64,
    pub elements: u64,
    pub checksum: u64,
}

impl Section {
    /// A section of `elements` elements that starts at the first fitting offset after `end`.
    pub fn after(end: u64, name: &'static str, kind: Kind, components: u16, elements: u64) -> Section {
        let align = if name == "tile" { PAGE } else { ALIGN };
        let offset = end.next_multiple_of(align);
        let bytes = elements * kind.size() * u64::from(components);
        Section { name, kind, components, offset, bytes, elements, checksum: 0 }
    }

    pub fn end(&self) -> u64 {
        self.offset + self.bytes
    }
}

/// Header and table as bytes.
pub(super) fn encode(sections: &[Section], length: u64, samples: u64) -> Vec<u8> {
    let mut bytes = Vec::with_capacity(HEADER + ENTRY * sections.len());
    bytes.extend(MAGIC);
    bytes.extend(version().to_le_bytes());
    bytes.extend([0; 6]);
    bytes.extend(length.to_le_bytes());
    bytes.extend(samples.to_le_bytes());
    bytes.extend((sections.len() as u32).to_le_bytes());
    bytes.extend((ENTRY as u32).to_le_bytes());
    bytes.extend([0; 24]);
    for s in sections {
        let mut name = [0; 16];
        name[..s.name.len()].copy_from_slice(s.name.as_bytes());
        bytes.extend(name);
        [s.kind as u16, s.components, RECORDS, 0].iter().for_each(|v| bytes.extend(v.to_le_bytes()));
        let numbers = [s.offset, s.bytes, s.bytes, s.elements, s.checksum];
        numbers.iter().for_each(|v| bytes.extend(v.to_le_bytes()));
    }
    let sum = table_checksum(&bytes);
    bytes[56..64].copy_from_slice(&sum.to_le_bytes());
    bytes
}

fn table_checksum(bytes: &[u8]) -> u64 {
    let mut hasher = Xxh3::new();
    hasher.update(&bytes[..56]);
    hasher.update(&bytes[HEADER..]);
    hasher.digest()
}

fn word<const N: usize>(bytes: &[u8], at: usize) -> Result<[u8; N], String> {
    bytes.get(at..at + N).and_then(|b| b.try_into().ok()).ok_or_else(|| "the file is truncated".into())
}

/// A checked header.
pub(super) struct Header {
    pub samples: u64,
    pub sections: Vec<Section>,
}

impl Header {
    pub fn section(&self, name: &str) -> Result<&Section, String> {
        self.sections.iter().find(|s| s.name == name).ok_or_else(|| format!("section `{name}` is missing"))
    }
}

/// Reads header and table, and checks them against the file.
pub(super) fn decode(file: &[u8], known: &[(&'static str, Kind, u16)]) -> Result<Header, String> {
    if file.get(..8) != Some(&MAGIC) {
        return Err("not a cloud written by sample-surface".into());
    }
    let major = u16::from_le_bytes(word(file, 8)?);
    if major != version() {
        return Err(format!("the cloud has format version {major}, this program reads {}; sample again", version()));
    }
    let length = u64::from_le_bytes(word(file, 16)?);
    if length != file.len() as u64 {
        return Err(format!("the cloud is truncated or damaged: {} of {length} bytes; sample again", file.len()));
    }
    let count = u32::from_le_bytes(word(file, 32)?);
    let end = HEADER + ENTRY * count as usize;
    if count > MAX_SECTIONS || u32::from_le_bytes(word(file, 36)?) != ENTRY as u32 || end > file.len() {
        return Err("the cloud's section table is damaged; sample again".into());
    }
    if table_checksum(&file[..end]) != u64::from_le_bytes(word(file, 56)?) || word(file, 12)? != [0u8; 4] {
        return Err("the cloud's header is damaged (checksum); sample again".into());
    }
    let mut sections = Vec::new();
    for k in 0..count as usize {
        let entry = &file[HEADER + k * ENTRY..HEADER + (k + 1) * ENTRY];
        let section = decode_entry(entry, known, file.len() as u64)?;
        if let Some(twice) = section.as_ref().filter(|s| sections.iter().any(|other: &Section| other.name == s.name)) {
            return Err(format!("section `{}` occurs twice; sample again", twice.name));
        }
        sections.extend(section);
    }
    Ok(Header { samples: u64::from_le_bytes(word(file, 24)?), sections })
}

/// Reads a table entry; none if its section is of a later minor version.
fn decode_entry(entry: &[u8], known: &[(&'static str, Kind, u16)], length: u64) -> Result<Option<Section>, String> {
    let is_named =
        |name: &str| entry[..name.len()] == *name.as_bytes() && entry[name.len()..16].iter().all(|b| *b == 0);
    let Some(&(name, kind, components)) = known.iter().find(|(name, ..)| is_named(name)) else {
        return Ok(None);
    };
    let short = |at| word(entry, at).map(u16::from_le_bytes);
    let long = |at| word(entry, at).map(u64::from_le_bytes);
    let [offset, bytes, elements, checksum] = [long(24)?, long(32)?, long(48)?, long(56)?];
    let section = Section { name, kind, components, offset, bytes, elements, checksum };
    let expected = u64::checked_mul(section.elements, u64::from(components) * kind.size());
    let fits = section.offset.checked_add(section.bytes).is_some_and(|end| end <= length)
        && section.offset.is_multiple_of(ALIGN)
        && expected == Some(section.bytes)
        && long(40)? == section.bytes
        && [short(16)?, short(18)?, short(20)?, short(22)?] == [kind as u16, components, RECORDS, 0];
    if fits { Ok(Some(section)) } else { Err(format!("section `{name}` is damaged; sample again")) }
}

/// The checksum of a section's bytes.
pub(super) fn checksum(bytes: &[u8]) -> u64 {
    checksum_of(&bytes.chunks(BLOCK).map(xxh3_64).collect::<Vec<u64>>())
}

/// The checksum of a section from those of its blocks.
pub(super) fn checksum_of(blocks: &[u64]) -> u64 {
    match blocks {
        [] => xxh3_64(&[]),
        [one] => *one,
        _ => xxh3_64(&blocks.iter().flat_map(|block| block.to_le_bytes()).collect::<Vec<u8>>()),
    }
}

/// Compares the checksum of a section's bytes with the one in the table.
pub(super) fn verify(found: u64, s: &Section) -> Result<(), String> {
    if found == s.checksum { Ok(()) } else { Err(format!("section `{}` is damaged (checksum); sample again", s.name)) }
}

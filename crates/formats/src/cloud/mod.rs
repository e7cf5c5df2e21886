//! The point cloud: lit surface samples of phase one.
//!
//! Readable without this code: the sections `tile` and `node` are little-endian arrays of [`Record`] and [`Node`] that
//! start where the section table says, and the section `provenance` repeats the facts as JSON. It is mapped as it lies.

mod layout;
mod meta;
mod record;

pub use layout::version;
pub use meta::{Group, Meta, Options, SampledMaterial, Shard, hex};
pub use record::{Node, Record, TILE, Tile, first_leaf, node_count, tile};

use crate::{Error, atomic::Output};
use bytemuck::Pod;
use glam::{DVec3, Vec3};
use layout::{HEADER, Header, Kind, Section};
use memmap2::Mmap;
use meta::Versioned;
use std::{fs::File, io::Write, path::Path, time::SystemTime};
use xxhash_rust::xxh3::xxh3_64;

/// The sections this version knows: name, element type, components.
const SECTIONS: [(&str, Kind, u16); 4] = [
    ("meta", Kind::U8, 1),
    ("provenance", Kind::U8, 1),
    ("tile", Kind::U32, (size_of::<Tile>() / 4) as u16),
    ("node", Kind::F32, (size_of::<Node>() / 4) as u16),
];

/// Largest metadata block that is read.
const META_LIMIT: usize = 1 << 20;

/// Most samples drawn for a cloud: the sums over thousands of clouds are whole numbers still, in float64 too.
const MOST_DRAWN: u64 = 1 << 40;

/// No scene is wider, m.
const FARTHEST: f64 = 1e18;

fn meta_config() -> impl bincode::config::Config {
    bincode::config::standard().with_little_endian().with_fixed_int_encoding().with_limit::<META_LIMIT>()
}

/// One sample: a lit point of the surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sample {
    /// m, relative to the cloud's origin.
    pub position: Vec3,
    /// Unit normal that the irradiance was taken with.
    pub normal: DVec3,
    /// Unit direction towards the light.
    pub direction: DVec3,
    /// `Φ = E/pdf(x)`, without 1/K, W.
    pub flux: Vec3,
}

/// The stored part of a cloud: groups of tiles and the trees over them, see [`Group`].
#[derive(Clone, Debug, Default)]
pub struct Content {
    /// Stored samples, fillers not counted.
    pub samples: u64,
    pub tiles: Vec<Tile>,
    pub nodes: Vec<Node>,
}

impl Content {
    /// The tiles and nodes of one group.
    pub fn group(&self, group: &Group) -> (&[Tile], &[Node]) {
        part(&self.tiles, &self.nodes, group)
    }
}

fn part<'a>(tiles: &'a [Tile], nodes: &'a [Node], group: &Group) -> (&'a [Tile], &'a [Node]) {
    let range = |first: u64, count: u64| first as usize..(first + count) as usize;
    (&tiles[range(group.first_tile, group.tiles())], &nodes[range(group.first_node, group.nodes())])
}

/// Writes a cloud; the same content and facts give the same bytes.
pub fn write(output: &mut Output, path: &Path, content: &Content, meta: &Meta) -> Result<(), Error> {
    let facts = bincode::serde::encode_to_vec(Versioned::V5(meta.clone()), meta_config())
        .map_err(|e| Error::invalid(path, format!("the cloud's facts do not fit the file: {e}")))?;
    let provenance = serde_json::to_vec_pretty(&provenance(meta))
        .map_err(|e| Error::invalid(path, format!("the cloud's facts do not fit the file: {e}")))?;
    let (tiles, nodes) = (bytemuck::cast_slice(&content.tiles), bytemuck::cast_slice(&content.nodes));
    let blocks: [&[u8]; 4] = [&facts, &provenance, tiles, nodes];
    let counts = [facts.len(), provenance.len(), content.tiles.len(), content.nodes.len()];
    let mut end = (HEADER + 64 * blocks.len()) as u64;
    let mut sections = Vec::new();
    for (k, (name, kind, components)) in SECTIONS.into_iter().enumerate() {
        let mut section = Section::after(end, name, kind, components, counts[k] as u64);
        section.checksum = xxh3_64(blocks[k]);
        end = section.end();
        sections.push(section);
    }
    let head = layout::encode(&sections, end, content.samples);
    let mut at = head.len() as u64;
    let mut put = |bytes: &[u8]| output.write_all(bytes).map_err(|source| Error::write(path, source));
    put(&head)?;
    for (section, bytes) in sections.iter().zip(blocks) {
        put(&vec![0; (section.offset - at) as usize])?;
        put(bytes)?;
        at = section.end();
    }
    Ok(())
}

/// The facts as people read them: digests in hexadecimal.
fn provenance(meta: &Meta) -> serde_json::Value {
    let mut value = serde_json::json!(meta);
    for (key, digest) in [("content", &meta.content), ("geometry", &meta.geometry), ("lights", &meta.lights)] {
        value[key] = hex(digest).into();
    }
    value["format_version"] = version().into();
    value
}

/// An open cloud, mapped into memory.
pub struct Cloud {
    file: File,
    /// When the file was last written before it was mapped.
    modified: Option<SystemTime>,
    map: Mmap,
    header: Header,
    meta: Meta,
}

impl Cloud {
    /// Maps a file and checks its structure and facts, not its samples: milliseconds whatever its size.
    pub fn open(path: &Path) -> Result<Cloud, Error> {
        let file = File::open(path).map_err(|source| Error::read(path, source))?;
        let kind = file.metadata().map_err(|source| Error::read(path, source))?;
        if !kind.is_file() {
            return Err(Error::invalid(path, "not a file; a cloud is mapped into memory"));
        }
        let map = map(&file).map_err(|source| Error::read(path, source))?;
        let invalid = |what| Error::invalid(path, what);
        let header = layout::decode(&map, &SECTIONS).map_err(invalid)?;
        let meta = read_meta(&map, &header).map_err(invalid)?;
        Ok(Cloud { modified: kind.modified().ok(), file, map, header, meta })
    }

    /// Refuses a file that was written to since it was opened. One that was replaced keeps its content here, and a new
    /// time stamp alone is no harm.
    pub fn check_unchanged(&self, path: &Path) -> Result<(), Error> {
        let now = self.file.metadata().map_err(|source| Error::read(path, source))?;
        if now.len() == self.bytes() && now.modified().ok() == self.modified {
            return Ok(());
        }
        let written = |_| Error::invalid(path, "written to while it was read; rename a new cloud over it instead");
        if now.len() != self.bytes() {
            return Err(written(String::new()));
        }
        let content = layout::decode(&self.map, &SECTIONS).and_then(|header| read_meta(&self.map, &header));
        match content {
            Ok(meta) if meta.content == self.meta.content => self.verify(path),
            Ok(_) => Err(written(String::new())),
            Err(what) => Err(written(what)),
        }
    }

    pub fn meta(&self) -> &Meta {
        &self.meta
    }

    /// Bytes of the whole file.
    pub fn bytes(&self) -> u64 {
        self.map.len() as u64
    }

    /// Samples in the file.
    pub fn len(&self) -> u64 {
        self.header.samples
    }

    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Checks every section against its checksum, every sample for being a point of the scene with flux not negative, and
    /// every node for numbers. Reads the whole file.
    pub fn verify(&self, path: &Path) -> Result<(), Error> {
        for section in &self.header.sections {
            layout::verify(&self.map, section).map_err(|what| Error::invalid(path, what))?;
        }
        if !records_are_good(self.tiles().as_flattened(), self.meta.diagonal_m.clamp(0.0, FARTHEST) as f32) {
            let what = "a sample is not finite or lies beyond its scene, or its flux is negative; sample again";
            return Err(Error::invalid(path, what));
        }
        let numbers: &[f32] = bytemuck::cast_slice(self.nodes());
        if !numbers.iter().all(|x| x.is_finite()) || !self.nodes().iter().all(|n| n.flux >= 0.0) {
            return Err(Error::invalid(path, "a node of the tree is not finite, or its flux negative; sample again"));
        }
        Ok(())
    }

    /// All tiles, see [`Group::first_tile`].
    pub fn tiles(&self) -> &[Tile] {
        self.section("tile")
    }

    /// All nodes, see [`Group::first_node`].
    pub fn nodes(&self) -> &[Node] {
        self.section("node")
    }

    /// The tiles and nodes of one group of this cloud.
    pub fn group(&self, group: &Group) -> (&[Tile], &[Node]) {
        part(self.tiles(), self.nodes(), group)
    }

    /// The samples of one material, its first half first.
    pub fn samples<'a>(&'a self, material: &'a SampledMaterial) -> impl Iterator<Item = Sample> + 'a {
        material.halves.iter().flat_map(|half| {
            let (tiles, _) = self.group(half);
            (0..half.samples as usize).map(move |k| tiles[k / TILE][k % TILE].sample())
        })
    }

    /// A section's elements. The header was checked: the section is there, inside the file and aligned.
    fn section<T: Pod>(&self, name: &str) -> &[T] {
        let Some(s) = self.header.sections.iter().find(|s| s.name == name) else {
            return &[];
        };
        bytemuck::cast_slice(&self.map[s.offset as usize..s.end() as usize])
    }
}

/// True if positions lie within `reach` of the origin along each axis, and fluxes are finite and not negative.
fn records_are_good(records: &[Record], reach: f32) -> bool {
    // As whole numbers: of floats without sign those that are finite come first, of all the positive ones. Without a
    // branch for each record this takes as long as reading the memory does.
    const SIGN: u32 = 1 << 31;
    const MASKS: [u32; 8] = [!SIGN, !SIGN, !SIGN, 0, 0, !0, !0, !0];
    let words: &[[u32; 8]] = bytemuck::cast_slice(records);
    let worst = words
        .iter()
        .fold([0; 8], |worst: [u32; 8], record| std::array::from_fn(|i| worst[i].max(record[i] & MASKS[i])));
    let limits = [reach, reach, reach, f32::MAX, f32::MAX, f32::MAX, f32::MAX, f32::MAX];
    worst.iter().zip(limits).all(|(word, limit)| *word <= limit.to_bits())
}

/// Maps a file for reading.
#[allow(unsafe_code)]
fn map(file: &File) -> std::io::Result<Mmap> {
    // SAFETY: a mapping is sound while nobody changes the file. Clouds are never written in place: a new one is
    // written to a temporary file and renamed over the old, whose mapping keeps the old content.
    unsafe { Mmap::map(file) }
}

/// Facts that fit the header.
fn read_meta(file: &[u8], header: &Header) -> Result<Meta, String> {
    for (name, ..) in SECTIONS {
        header.section(name)?;
    }
    let section = header.section("meta")?;
    layout::verify(file, section)?;
    let bytes = &file[section.offset as usize..section.end() as usize];
    let damaged = "the cloud's facts are damaged; sample again";
    let (Versioned::V5(meta), used) =
        bincode::serde::decode_from_slice(bytes, meta_config()).map_err(|_| damaged.to_owned())?;
    let fits = used == bytes.len() && groups_fit(&meta, header).is_some() && meta.is_finite();
    if fits { Ok(meta) } else { Err(damaged.into()) }
}

/// Some if the groups of the materials follow each other and fill the sections.
fn groups_fit(meta: &Meta, header: &Header) -> Option<()> {
    let (mut samples, mut tiles, mut nodes) = (0u64, 0u64, 0u64);
    for half in meta.materials.iter().flat_map(|m| &m.halves) {
        let placed = half.samples <= header.samples && (half.first_tile, half.first_node) == (tiles, nodes);
        placed.then_some(())?;
        samples = samples.checked_add(half.samples)?;
        tiles = tiles.checked_add(half.tiles())?;
        nodes = nodes.checked_add(half.nodes())?;
    }
    let elements = |name| header.section(name).map(|s| s.elements).ok();
    let full = samples == header.samples && elements("tile") == Some(tiles) && elements("node") == Some(nodes);
    (full && (samples.max(1)..=MOST_DRAWN).contains(&meta.samples_drawn)).then_some(())
}

#[cfg(test)]
mod tests;

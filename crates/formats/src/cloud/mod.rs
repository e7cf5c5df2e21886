//! The point cloud: the lit surface samples of phase one.
//!
//! The file is mapped into memory as it lies. Other programs can read it, too: the section table states where the
//! sections start, `tile` and `node` are little-endian arrays of [`Record`] and [`Node`], and `provenance` repeats the
//! facts as JSON.

pub(crate) mod bounded;
mod layout;
mod meta;
mod record;
mod settings;
pub mod shards;

pub use layout::version;
pub use meta::{Group, Meta, Options, SampledMaterial, Shard, hex};
pub use record::{Node, Record, Sample, TILE, Tile, first_leaf, node_count, tile};
pub use settings::{Choice, LightUnit, Normals, Pattern};

use crate::{Error, atomic::Output, image::parallel::parallel};
use bytemuck::Pod;
use layout::{BLOCK, HEADER, Header, Kind, Section};
use memmap2::Mmap;
use meta::Versioned;
use std::{fs::File, io::Write, num::NonZeroUsize, path::Path, time::SystemTime};
use xxhash_rust::xxh3::xxh3_64;

/// The sections of this version: name, element type, components.
const SECTIONS: [(&str, Kind, u16); 4] = [
    ("meta", Kind::U8, 1),
    ("provenance", Kind::U8, 1),
    ("tile", Kind::U32, (size_of::<Tile>() / 4) as u16),
    ("node", Kind::F32, (size_of::<Node>() / 4) as u16),
];

/// Most bytes of the facts, and of the same facts as text.
const META_LIMIT: usize = 1 << 20;
const PROVENANCE_LIMIT: usize = 16 * META_LIMIT;

/// Most samples of a group: estimators pick them by an index of 32 bits.
const LARGEST_GROUP: u64 = 1 << 32;

/// Most samples drawn for a cloud, so that the sum over thousands of clouds is still exact in float64.
const MAX_DRAWN: u64 = 1 << 40;

/// Largest diagonal of a scene, m.
const MAX_DIAGONAL: f64 = 1e18;

fn meta_config() -> impl bincode::config::Config {
    bincode::config::standard().with_little_endian().with_fixed_int_encoding().with_limit::<META_LIMIT>()
}

/// The stored part of a cloud: groups of tiles and the trees over them, see [`Group`].
#[derive(Clone, Debug, Default)]
pub struct Content {
    /// Stored samples without the fillers of tiles.
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

/// Writes a cloud. The same content and facts give the same bytes.
pub fn write(output: &mut Output, path: &Path, content: &Content, meta: &Meta) -> Result<(), Error> {
    let facts = bincode::serde::encode_to_vec(Versioned::V7(meta.clone()), meta_config())
        .map_err(|e| Error::invalid(path, format!("the cloud's facts do not fit the file: {e}")))?;
    let provenance = serde_json::to_vec_pretty(&provenance(meta))
        .map_err(|e| Error::invalid(path, format!("the cloud's facts do not fit the file: {e}")))?;
    if provenance.len() > PROVENANCE_LIMIT {
        return Err(Error::invalid(path, "the cloud's facts do not fit the file: they are too long as text"));
    }
    let (tiles, nodes) = (bytemuck::cast_slice(&content.tiles), bytemuck::cast_slice(&content.nodes));
    let blocks: [&[u8]; 4] = [&facts, &provenance, tiles, nodes];
    let counts = [facts.len(), provenance.len(), content.tiles.len(), content.nodes.len()];
    let mut end = (HEADER + 64 * blocks.len()) as u64;
    let mut sections = Vec::new();
    for (k, (name, kind, components)) in SECTIONS.into_iter().enumerate() {
        let mut section = Section::after(end, name, kind, components, counts[k] as u64);
        section.checksum = layout::checksum(blocks[k]);
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

/// The facts as JSON, with digests in hexadecimal.
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
    /// When the file was last modified before it was mapped.
    modified: Option<SystemTime>,
    map: Mmap,
    header: Header,
    meta: Meta,
}

impl Cloud {
    /// Maps a file, and checks its structure and facts but not its samples. That takes milliseconds for any size.
    pub fn open(path: &Path) -> Result<Cloud, Error> {
        let whole = |kind: std::fs::Metadata| {
            let refused = || Error::invalid(path, "not a file; a cloud is mapped into memory");
            kind.is_file().then_some(kind).ok_or_else(refused)
        };
        // The kind of the file is checked before it is opened, because opening a pipe waits for its writer.
        std::fs::metadata(path).map_err(|source| Error::read(path, source)).and_then(whole)?;
        let file = File::open(path).map_err(|source| Error::read(path, source))?;
        let kind = file.metadata().map_err(|source| Error::read(path, source)).and_then(whole)?;
        let map = map(&file).map_err(|source| Error::read(path, source))?;
        let invalid = |what| Error::invalid(path, what);
        let header = layout::decode(&map, &SECTIONS).map_err(invalid)?;
        let meta = read_meta(&map, &header).map_err(invalid)?;
        Ok(Cloud { modified: kind.modified().ok(), file, map, header, meta })
    }

    /// Refuses a file that was modified since it was opened. A file that was replaced keeps its content in the mapping,
    /// and a new time stamp alone does no harm.
    pub fn check_unchanged(&self, path: &Path) -> Result<(), Error> {
        let now = self.file.metadata().map_err(|source| Error::read(path, source))?;
        if now.len() == self.bytes() && now.modified().ok() == self.modified {
            return Ok(());
        }
        let written = || Error::invalid(path, "written to while it was read; rename a new cloud over it instead");
        if now.len() != self.bytes() {
            return Err(written());
        }
        let header = layout::decode(&self.map, &SECTIONS);
        let now = header.and_then(|header| read_meta(&self.map, &header)).map_err(|_| written())?;
        if now.content == self.meta.content { self.verify(path) } else { Err(written()) }
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

    /// [`Cloud::verify_with`] on one thread.
    pub fn verify(&self, path: &Path) -> Result<(), Error> {
        self.verify_with(NonZeroUsize::MIN, path)
    }

    /// Checks the checksum of every section, that every sample lies in the scene and has no negative flux, and that
    /// every node has values in range. It reads the whole file once, at 6 GB/s for each thread where the file is in
    /// memory already.
    pub fn verify_with(&self, threads: NonZeroUsize, path: &Path) -> Result<(), Error> {
        let max_coordinate = self.meta.diagonal_m.clamp(0.0, MAX_DIAGONAL) as f32;
        for section in &self.header.sections {
            let is_good = |block: &[u8]| match section.name {
                "tile" => records_are_good(bytemuck::cast_slice(block), max_coordinate),
                "node" => nodes_are_good(bytemuck::cast_slice(block), max_coordinate),
                _ => true,
            };
            let blocks = self.map[section.offset as usize..section.end() as usize].chunks(BLOCK).collect();
            let checked = parallel(threads, blocks, |block: &[u8]| (xxh3_64(block), is_good(block)));
            let (sums, good): (Vec<u64>, Vec<bool>) = checked.into_iter().unzip();
            layout::verify(layout::checksum_of(&sums), section).map_err(|what| Error::invalid(path, what))?;
            if good.contains(&false) {
                let what = match section.name {
                    "tile" => "a sample is not finite or lies beyond its scene, or its flux is negative",
                    _ => "a node of the tree is not finite or lies beyond its scene, or a size or its flux is negative",
                };
                return Err(Error::invalid(path, format!("{what}; sample again")));
            }
        }
        Ok(())
    }

    /// The tiles of all groups; a group starts at [`Group::first_tile`].
    pub fn tiles(&self) -> &[Tile] {
        self.section("tile")
    }

    /// The nodes of all groups; a group starts at [`Group::first_node`].
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

    /// The elements of a section. The header was checked, so that the section exists, lies inside the file and is
    /// aligned.
    fn section<T: Pod>(&self, name: &str) -> &[T] {
        let Some(s) = self.header.sections.iter().find(|s| s.name == name) else {
            return &[];
        };
        bytemuck::cast_slice(&self.map[s.offset as usize..s.end() as usize])
    }
}

const SIGN: u32 = 1 << 31;

/// True if positions lie within `max_coordinate` of the origin along each axis, and fluxes are finite and not negative.
fn records_are_good(records: &[Record], max_coordinate: f32) -> bool {
    const MASKS: [u32; 8] = [!SIGN, !SIGN, !SIGN, 0, 0, !0, !0, !0];
    let limits = [max_coordinate, max_coordinate, max_coordinate, f32::MAX, f32::MAX, f32::MAX, f32::MAX, f32::MAX];
    are_within(bytemuck::cast_slice(records), MASKS, limits)
}

/// True if centers lie within `max_coordinate` of the origin along each axis, no radius or spread exceeds the distance
/// between two such points, and flux and deviations are finite and not negative.
fn nodes_are_good(nodes: &[Node], max_coordinate: f32) -> bool {
    const MASKS: [u32; 8] = [!SIGN, !SIGN, !SIGN, !0, !0, !0, !0, !0];
    let apart = 4.0 * max_coordinate;
    let limits = [max_coordinate, max_coordinate, max_coordinate, apart, apart, f32::MAX, f32::MAX, 2.0];
    are_within(bytemuck::cast_slice(nodes), MASKS, limits)
}

/// True if in each row of eight floats, the masked bits of every float are at most those of its limit.
fn are_within(floats: &[[u32; 8]], masks: [u32; 8], limits: [f32; 8]) -> bool {
    // As integers, finite floats without their sign come before infinity and NaN, and positive floats before negative
    // ones. One maximum without branches takes as long as reading the memory.
    let max = floats.iter().fold([0; 8], |max: [u32; 8], x| std::array::from_fn(|i| max[i].max(x[i] & masks[i])));
    max.iter().zip(limits).all(|(word, limit)| *word <= limit.to_bits())
}

/// Maps a file for reading.
#[allow(unsafe_code)]
fn map(file: &File) -> std::io::Result<Mmap> {
    // SAFETY: a mapping is sound while nobody changes the file. Clouds are never modified: a new one is written to a
    // temporary file and renamed over the old one, whose mapping keeps the old content.
    unsafe { Mmap::map(file) }
}

/// Reads the facts, and checks them against the header.
fn read_meta(file: &[u8], header: &Header) -> Result<Meta, String> {
    for (name, ..) in SECTIONS {
        header.section(name)?;
    }
    let damaged = "the cloud's facts are damaged; sample again";
    let section = header.section("meta")?;
    // The lengths are checked before the facts are read, so that opening takes milliseconds whatever a file claims.
    if section.bytes > META_LIMIT as u64 || header.section("provenance")?.bytes > PROVENANCE_LIMIT as u64 {
        return Err(format!("the cloud's facts are longer than the {META_LIMIT} bytes they may have; sample again"));
    }
    let bytes = &file[section.offset as usize..section.end() as usize];
    layout::verify(layout::checksum(bytes), section)?;
    let (Versioned::V7(meta), used) =
        bincode::serde::decode_from_slice(bytes, meta_config()).map_err(|_| damaged.to_owned())?;
    let fits = used == bytes.len() && groups_fit(&meta, header).is_some() && meta.is_sound();
    if fits { Ok(meta) } else { Err(damaged.into()) }
}

/// Some if the groups of the materials follow each other and fill their sections.
fn groups_fit(meta: &Meta, header: &Header) -> Option<()> {
    let (mut samples, mut tiles, mut nodes) = (0u64, 0u64, 0u64);
    for half in meta.materials.iter().flat_map(|m| &m.halves) {
        let counted = half.samples <= header.samples.min(LARGEST_GROUP);
        let follows = counted && (half.first_tile, half.first_node) == (tiles, nodes);
        follows.then_some(())?;
        samples = samples.checked_add(half.samples)?;
        tiles = tiles.checked_add(half.tiles())?;
        nodes = nodes.checked_add(half.nodes())?;
    }
    let elements = |name| header.section(name).map(|s| s.elements).ok();
    let full = samples == header.samples && elements("tile") == Some(tiles) && elements("node") == Some(nodes);
    (full && (samples.max(1)..=MAX_DRAWN).contains(&meta.samples_drawn)).then_some(())
}

#[cfg(test)]
mod tests;

//! The point cloud: lit surface samples of phase one.
//!
//! Readable without this code: the sections `tile` and `node` are little-endian arrays of [`Record`] and [`Node`] that
//! start where the section table says, and the section `provenance` repeats the facts as JSON. It is mapped as it lies.

mod bounded;
mod layout;
mod meta;
mod record;
mod settings;

pub use layout::version;
pub use meta::{Group, Meta, Options, SampledMaterial, Shard, hex};
pub use record::{Node, Record, TILE, Tile, first_leaf, node_count, tile};
pub use settings::{Choice, LightUnit, Normals, Pattern};

use crate::{Error, atomic::Output, image::parallel::parallel};
use bytemuck::Pod;
use glam::{DVec3, Vec3};
use layout::{BLOCK, HEADER, Header, Kind, Section};
use memmap2::Mmap;
use meta::Versioned;
use std::{fs::File, io::Write, num::NonZeroUsize, path::Path, time::SystemTime};
use xxhash_rust::xxh3::xxh3_64;

/// The sections this version knows: name, element type, components.
const SECTIONS: [(&str, Kind, u16); 4] = [
    ("meta", Kind::U8, 1),
    ("provenance", Kind::U8, 1),
    ("tile", Kind::U32, (size_of::<Tile>() / 4) as u16),
    ("node", Kind::F32, (size_of::<Node>() / 4) as u16),
];

/// Largest metadata block that is written or read, bytes, and the largest text of the same facts.
const META_LIMIT: usize = 1 << 20;
const PROVENANCE_LIMIT: usize = 16 * META_LIMIT;

/// Samples of a group are counted by 32 bits where they are picked.
const LARGEST_GROUP: u64 = 1 << 32;

/// Most samples drawn for a cloud: the sums over thousands of clouds are whole numbers still, in float64 too.
const MAX_DRAWN: u64 = 1 << 40;

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
    let facts = bincode::serde::encode_to_vec(Versioned::V6(meta.clone()), meta_config())
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
        let whole = |kind: std::fs::Metadata| {
            let refused = || Error::invalid(path, "not a file; a cloud is mapped into memory");
            kind.is_file().then_some(kind).ok_or_else(refused)
        };
        // Before it is opened, too: to open a pipe is to wait for its writer.
        std::fs::metadata(path).map_err(|source| Error::read(path, source)).and_then(whole)?;
        let file = File::open(path).map_err(|source| Error::read(path, source))?;
        let kind = file.metadata().map_err(|source| Error::read(path, source)).and_then(whole)?;
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

    /// [`Cloud::verify_with`] by this thread alone.
    pub fn verify(&self, path: &Path) -> Result<(), Error> {
        self.verify_with(NonZeroUsize::MIN, path)
    }

    /// Checks every section against its checksum, every sample for being a point of the scene with flux not negative, and
    /// every node for numbers that a node can have. Reads the whole file, once, by so many threads: 6 GB/s each where it
    /// is in memory already.
    pub fn verify_with(&self, threads: NonZeroUsize, path: &Path) -> Result<(), Error> {
        let reach = self.meta.diagonal_m.clamp(0.0, FARTHEST) as f32;
        for section in &self.header.sections {
            let is_good = |block: &[u8]| match section.name {
                "tile" => records_are_good(bytemuck::cast_slice(block), reach),
                "node" => nodes_are_good(bytemuck::cast_slice(block), reach),
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

const SIGN: u32 = 1 << 31;

/// True if positions lie within `reach` of the origin along each axis, and fluxes are finite and not negative.
fn records_are_good(records: &[Record], reach: f32) -> bool {
    const MASKS: [u32; 8] = [!SIGN, !SIGN, !SIGN, 0, 0, !0, !0, !0];
    let limits = [reach, reach, reach, f32::MAX, f32::MAX, f32::MAX, f32::MAX, f32::MAX];
    are_within(bytemuck::cast_slice(records), MASKS, limits)
}

/// True if centres lie within `reach` of the origin along each axis, no sample is farther from them than two such points
/// can be, and flux and deviations are finite and not negative.
fn nodes_are_good(nodes: &[Node], reach: f32) -> bool {
    const MASKS: [u32; 8] = [!SIGN, !SIGN, !SIGN, !0, !0, !0, !0, !0];
    let apart = 4.0 * reach;
    are_within(bytemuck::cast_slice(nodes), MASKS, [reach, reach, reach, apart, apart, f32::MAX, f32::MAX, 2.0])
}

/// True if the masked bits of eight floats, each time, are not above those of the limits.
fn are_within(floats: &[[u32; 8]], masks: [u32; 8], limits: [f32; 8]) -> bool {
    // As whole numbers: of floats without sign those that are finite come first, of all the positive ones. Without a
    // branch for each this takes as long as reading the memory does.
    let worst = floats.iter().fold([0; 8], |worst: [u32; 8], x| std::array::from_fn(|i| worst[i].max(x[i] & masks[i])));
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
    let damaged = "the cloud's facts are damaged; sample again";
    let section = header.section("meta")?;
    // Before a byte of them is read: opening takes milliseconds whatever a file claims.
    if section.bytes > META_LIMIT as u64 || header.section("provenance")?.bytes > PROVENANCE_LIMIT as u64 {
        return Err(format!("the cloud's facts are longer than the {META_LIMIT} bytes they may have; sample again"));
    }
    let bytes = &file[section.offset as usize..section.end() as usize];
    layout::verify(layout::checksum(bytes), section)?;
    let (Versioned::V6(meta), used) =
        bincode::serde::decode_from_slice(bytes, meta_config()).map_err(|_| damaged.to_owned())?;
    let fits = used == bytes.len() && groups_fit(&meta, header).is_some() && meta.is_sound();
    if fits { Ok(meta) } else { Err(damaged.into()) }
}

/// Some if the groups of the materials follow each other and fill the sections.
fn groups_fit(meta: &Meta, header: &Header) -> Option<()> {
    let (mut samples, mut tiles, mut nodes) = (0u64, 0u64, 0u64);
    for half in meta.materials.iter().flat_map(|m| &m.halves) {
        let counted = half.samples <= header.samples.min(LARGEST_GROUP);
        let placed = counted && (half.first_tile, half.first_node) == (tiles, nodes);
        placed.then_some(())?;
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

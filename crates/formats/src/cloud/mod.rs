//! The point cloud: lit surface samples of phase one.
//!
//! Readable without this code: `data` planes are little-endian arrays that start where the section table says, and the
//! section `provenance` repeats the facts as JSON.

mod layout;
mod meta;

pub use layout::version;
pub use meta::{Meta, Options, SampledMaterial, hex};

use crate::{Error, atomic::Output, octahedral};
use bytemuck::Pod;
use glam::{DVec3, Vec3};
use layout::{HEADER, Header, Kind, Section, plane_bytes};
use memmap2::Mmap;
use meta::Versioned;
use std::{fs::File, io::Write, path::Path};
use xxhash_rust::xxh3::xxh3_64;

/// The sections this version knows: name, element type, components.
const SECTIONS: [(&str, Kind, u16); 6] = [
    ("meta", Kind::U8, 1),
    ("provenance", Kind::U8, 1),
    ("position", Kind::F32, 3),
    ("normal", Kind::I16, 2),
    ("direction", Kind::I16, 2),
    ("flux", Kind::F32, 3),
];

/// Largest metadata block that is read.
const META_LIMIT: usize = 1 << 20;

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

/// Samples as they are collected: structure of arrays, as in the file.
#[derive(Clone, Debug, Default)]
pub struct Samples {
    position: [Vec<f32>; 3],
    normal: [Vec<i16>; 2],
    direction: [Vec<i16>; 2],
    flux: [Vec<f32>; 3],
}

impl Samples {
    pub fn len(&self) -> usize {
        self.position[0].len()
    }

    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    pub fn push(&mut self, sample: &Sample) {
        let (normal, direction) = (octahedral::encode(sample.normal), octahedral::encode(sample.direction));
        for c in 0..3 {
            self.position[c].push(sample.position[c]);
            self.flux[c].push(sample.flux[c]);
        }
        for c in 0..2 {
            self.normal[c].push(normal[c]);
            self.direction[c].push(direction[c]);
        }
    }

    /// Moves all samples of `other` behind these.
    pub fn append(&mut self, other: &mut Samples) {
        for c in 0..3 {
            self.position[c].append(&mut other.position[c]);
            self.flux[c].append(&mut other.flux[c]);
        }
        for c in 0..2 {
            self.normal[c].append(&mut other.normal[c]);
            self.direction[c].append(&mut other.direction[c]);
        }
    }
}

/// Writes a cloud; the same samples and facts give the same bytes.
pub fn write(output: &mut Output, path: &Path, samples: &Samples, meta: &Meta) -> Result<(), Error> {
    let facts = bincode::serde::encode_to_vec(Versioned::V1(meta.clone()), meta_config())
        .map_err(|e| Error::invalid(path, format!("the cloud's facts do not fit the file: {e}")))?;
    let provenance = serde_json::to_vec_pretty(&provenance(meta))
        .map_err(|e| Error::invalid(path, format!("the cloud's facts do not fit the file: {e}")))?;
    let planes: [Vec<u8>; 6] = [
        facts,
        provenance,
        planes(&samples.position),
        planes(&samples.normal),
        planes(&samples.direction),
        planes(&samples.flux),
    ];
    let mut end = (HEADER + 64 * planes.len()) as u64;
    let mut sections = Vec::new();
    for ((name, kind, components), bytes) in SECTIONS.into_iter().zip(&planes) {
        let elements = if kind == Kind::U8 { bytes.len() } else { samples.len() };
        let mut section = Section::after(end, name, kind, components, elements as u64);
        section.checksum = xxh3_64(bytes);
        end = section.end();
        sections.push(section);
    }
    let head = layout::encode(&sections, end, samples.len() as u64);
    let mut at = head.len() as u64;
    let mut put = |bytes: &[u8]| output.write_all(bytes).map_err(|source| Error::write(path, source));
    put(&head)?;
    for (section, bytes) in sections.iter().zip(&planes) {
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

/// The padded planes of a section, one after the other.
fn planes<T: Pod>(components: &[Vec<T>]) -> Vec<u8> {
    let mut bytes = Vec::new();
    for plane in components {
        bytes.extend_from_slice(bytemuck::cast_slice(plane));
        bytes.resize(bytes.len().next_multiple_of(16 * size_of::<T>()), 0);
    }
    bytes
}

/// An open cloud, mapped into memory.
pub struct Cloud {
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
        Ok(Cloud { map, header, meta })
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

    /// Checks every section against its checksum and every sample for being a finite point with flux not negative.
    pub fn verify(&self, path: &Path) -> Result<(), Error> {
        for section in &self.header.sections {
            layout::verify(&self.map, section).map_err(|what| Error::invalid(path, what))?;
        }
        let good = |name, test: fn(f32) -> bool| (0..3).all(|c| self.plane::<f32>(name, c).iter().all(|v| test(*v)));
        if !good("position", f32::is_finite) || !good("flux", |v| v.is_finite() && v >= 0.0) {
            return Err(Error::invalid(path, "a sample is not finite, or its flux negative; sample again"));
        }
        Ok(())
    }

    /// Samples `first..first + count`.
    pub fn samples(&self, first: u64, count: u64) -> impl Iterator<Item = Sample> + '_ {
        let position = [0, 1, 2].map(|c| self.plane::<f32>("position", c));
        let flux = [0, 1, 2].map(|c| self.plane::<f32>("flux", c));
        let normal = [0, 1].map(|c| self.plane::<i16>("normal", c));
        let direction = [0, 1].map(|c| self.plane::<i16>("direction", c));
        (first as usize..(first + count) as usize).map(move |k| Sample {
            position: Vec3::from_array(position.map(|p| p[k])),
            normal: octahedral::decode(normal.map(|p| p[k])),
            direction: octahedral::decode(direction.map(|p| p[k])),
            flux: Vec3::from_array(flux.map(|p| p[k])),
        })
    }

    /// One component of a section, without its padding. The header was checked: the section is there and inside.
    fn plane<T: Pod>(&self, name: &str, component: u64) -> &[T] {
        let Some(s) = self.header.sections.iter().find(|s| s.name == name) else {
            return &[];
        };
        let start = s.offset + component * plane_bytes(s.kind, s.elements);
        let bytes = &self.map[start as usize..start as usize + s.elements as usize * size_of::<T>()];
        bytemuck::cast_slice(bytes)
    }
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
    for (name, kind, _) in SECTIONS {
        let section = header.section(name)?;
        if kind != Kind::U8 && section.elements != header.samples {
            return Err(format!("section `{name}` does not hold one element a sample; sample again"));
        }
    }
    let section = header.section("meta")?;
    layout::verify(file, section)?;
    let bytes = &file[section.offset as usize..section.end() as usize];
    let damaged = "the cloud's facts are damaged; sample again";
    let (Versioned::V1(meta), used) =
        bincode::serde::decode_from_slice(bytes, meta_config()).map_err(|_| damaged.to_owned())?;
    let mut next = 0u64;
    for m in &meta.materials {
        if m.first != next {
            return Err(damaged.into());
        }
        next = next.checked_add(m.count).ok_or(damaged)?;
    }
    let fits = used == bytes.len() && next == header.samples && meta.samples_drawn >= next && meta.samples_drawn > 0;
    if fits && meta.is_finite() { Ok(meta) } else { Err(damaged.into()) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::{collections::BTreeMap, fs};

    fn meta(count: u64) -> Meta {
        let options = Options {
            seed: 3,
            choice: "area".into(),
            pattern: "independent".into(),
            normals: "shading".into(),
            metres_per_unit: 1.0,
            light_unit: "radiometric".into(),
            environment: [0.0; 3],
        };
        Meta {
            content: [1; 32],
            geometry: [2; 32],
            lights: [3; 32],
            options,
            samples_drawn: 2 * count + 1,
            samples_dropped: BTreeMap::from([("shadowed".into(), count + 1)]),
            shadow_rays: 2 * count,
            surface_area_m2: 0.5,
            mean_flux_w: [1.0; 3],
            diagonal_m: 2.0,
            origin_m: [0.0, 1.0, 2.0],
            materials: vec![SampledMaterial { name: "Wax".into(), index: 0, first: 0, count, area_m2: 0.5 }],
        }
    }

    fn samples(count: usize) -> Samples {
        let mut samples = Samples::default();
        for k in 0..count {
            let x = k as f32;
            let position = Vec3::new(x, 2.0 * x, -x);
            samples.push(&Sample { position, normal: DVec3::Z, direction: DVec3::Y, flux: Vec3::splat(x) });
        }
        samples
    }

    fn written(count: usize) -> (tempfile::TempDir, std::path::PathBuf) {
        let folder = tempfile::tempdir().expect("folder");
        let path = folder.path().join("test.cloud");
        let mut output = Output::create(&path).expect("creates");
        write(&mut output, &path, &samples(count), &meta(count as u64)).expect("writes");
        output.commit().expect("commits");
        (folder, path)
    }

    #[test]
    fn what_is_written_is_read() {
        for count in [0, 1, 16, 37] {
            let (_folder, path) = written(count);
            let cloud = Cloud::open(&path).expect("opens");
            cloud.verify(&path).expect("is good");
            assert_eq!(cloud.meta(), &meta(count as u64));
            let read: Vec<Sample> = cloud.samples(0, count as u64).collect();
            assert_eq!(read.len(), count);
            if count == 37 {
                assert_eq!(read[36].position, Vec3::new(36.0, 72.0, -36.0));
                assert_eq!((read[36].normal, read[36].flux), (DVec3::Z, Vec3::splat(36.0)));
            }
        }
    }

    /// Every byte belongs to something that is checked, or is padding that nothing reads.
    #[test]
    fn every_flipped_byte_is_found_and_none_panics() {
        let (folder, path) = written(5);
        let good = fs::read(&path).expect("reads");
        let bad = folder.path().join("bad.cloud");
        let mut unseen = 0;
        for at in 0..good.len() {
            let mut bytes = good.clone();
            bytes[at] ^= 0x41;
            fs::write(&bad, &bytes).expect("writes");
            let accepted = Cloud::open(&bad).and_then(|c| c.verify(&bad)).is_ok();
            unseen += usize::from(accepted);
        }
        let (head, table) = (HEADER, 64 * SECTIONS.len());
        assert!(unseen < 4096 + 64 * SECTIONS.len(), "{unseen} of {} bytes unseen", good.len());
        assert!(good.len() - unseen > head + table);
    }

    #[test]
    fn every_truncation_is_found() {
        let (folder, path) = written(5);
        let good = fs::read(&path).expect("reads");
        let bad = folder.path().join("bad.cloud");
        for length in (0..good.len()).step_by(7) {
            fs::write(&bad, &good[..length]).expect("writes");
            assert!(Cloud::open(&bad).is_err(), "{length}");
        }
    }
}

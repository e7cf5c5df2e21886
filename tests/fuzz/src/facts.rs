//! The metadata of a cloud, which `bincode` decodes, in a cloud without samples and with correct checksums.

use crate::{cloud::seal, file::with_file};
use formats::{
    atomic::Output,
    cloud::{self, Cloud, Content},
};
use std::path::Path;

const HEADER: usize = 64;
const ENTRY: usize = 64;

/// Sections by name, element type and components, as in `formats::cloud`.
const SECTIONS: [(&str, u16, u16); 4] = [("meta", 5, 1), ("provenance", 5, 1), ("tile", 3, 128), ("node", 1, 8)];

/// Accepted metadata describes a cloud without samples, and is the same after it was written and read again.
pub fn facts(block: &[u8]) -> bool {
    with_file("a.cloud", &wrapped(block), look_at)
}

fn look_at(path: &Path) -> bool {
    let Ok(cloud) = Cloud::open(path) else { return false };
    let meta = cloud.meta();
    assert!(cloud.is_empty() && meta.materials.iter().all(|m| m.count() == 0 && m.area_m2 >= 0.0));
    assert_eq!(meta.drawn_by_half().iter().sum::<u64>(), meta.samples_drawn);
    cloud.verify(path).expect("its checksums are right");
    let again = path.with_file_name("b.cloud");
    let mut output = Output::create(&again).expect("a temporary file");
    cloud::write(&mut output, &again, &Content::default(), meta).expect("room");
    output.commit().expect("a temporary file");
    assert_eq!(Cloud::open(&again).expect("its own cloud").meta(), meta);
    true
}

/// A cloud file around the metadata; all other sections are empty.
fn wrapped(block: &[u8]) -> Vec<u8> {
    let start = HEADER + ENTRY * SECTIONS.len();
    let end = start + block.len();
    let mut file = [&[0x89], b"PCL\r\n\x1a\n".as_slice()].concat();
    file.resize(start, 0);
    file[32..36].copy_from_slice(&(SECTIONS.len() as u32).to_le_bytes());
    file[36..40].copy_from_slice(&(ENTRY as u32).to_le_bytes());
    for ((name, kind, components), entry) in SECTIONS.into_iter().zip(file[HEADER..].chunks_mut(ENTRY)) {
        let (offset, bytes) = if name == "meta" { (start, block.len()) } else { (end.next_multiple_of(64), 0) };
        entry[..name.len()].copy_from_slice(name.as_bytes());
        [kind, components, 1, 0]
            .iter()
            .zip(entry[16..].chunks_mut(2))
            .for_each(|(x, at)| at.copy_from_slice(&x.to_le_bytes()));
        let numbers = [offset, bytes, bytes, bytes].map(|x| x as u64);
        numbers.iter().zip(entry[24..].chunks_mut(8)).for_each(|(x, at)| at.copy_from_slice(&x.to_le_bytes()));
    }
    file.extend(block);
    file.resize(end.next_multiple_of(64), 0);
    seal(&mut file);
    file
}

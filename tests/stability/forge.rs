//! Cloud files changed byte by byte, with correct checksums: what a forger would do.

use std::ops::Range;
use xxhash_rust::xxh3::{Xxh3, xxh3_64};

/// Sizes of the header and of one entry of its table, bytes.
const HEADER: usize = 64;
const ENTRY: usize = 64;

/// The bytes of a cloud file.
#[derive(Clone)]
pub struct Forged(pub Vec<u8>);

impl Forged {
    fn word(&self, at: usize) -> u64 {
        u64::from_le_bytes(self.0[at..at + 8].try_into().expect("eight bytes"))
    }

    pub fn put(&mut self, at: usize, bytes: &[u8]) {
        self.0[at..at + bytes.len()].copy_from_slice(bytes);
    }

    /// Header and section table.
    pub fn head(&self) -> Range<usize> {
        0..HEADER + ENTRY * u32::from_le_bytes(self.0[32..36].try_into().expect("four bytes")) as usize
    }

    /// The range of a section, as the table states it.
    pub fn section(&self, name: &str) -> Range<usize> {
        let at = self.entry(name);
        let (offset, bytes) = (self.word(at + 24) as usize, self.word(at + 32) as usize);
        offset..offset + bytes
    }

    /// The range of a section's entry in the table.
    pub fn entry(&self, name: &str) -> usize {
        let entries = (HEADER..self.head().end).step_by(ENTRY);
        let named = |at: &usize| self.0[*at..].starts_with(name.as_bytes());
        entries.into_iter().find(named).expect("every cloud has this section")
    }

    /// Sets the checksums of the sections and the header.
    pub fn sealed(mut self) -> Forged {
        for name in ["meta", "provenance", "tile", "node"] {
            let sum = xxh3_64(&self.0[self.section(name)]);
            self.put(self.entry(name) + 56, &sum.to_le_bytes());
        }
        self.sealed_head()
    }

    /// Sets the checksum of the header as it is.
    pub fn sealed_head(mut self) -> Forged {
        let end = self.head().end.min(self.0.len());
        let mut hasher = Xxh3::new();
        hasher.update(&self.0[..56]);
        hasher.update(&self.0[HEADER.min(end)..end]);
        let sum = hasher.digest();
        self.put(56, &sum.to_le_bytes());
        self
    }
}

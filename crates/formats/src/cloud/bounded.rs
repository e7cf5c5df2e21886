//! Deserializers for the lists and texts of a cloud's facts that allocate nothing for a length that a file only claims.
//!
//! The decoder's limit bounds what it reads, but serde reserves memory for a list, and the decoder for a text, before
//! the first byte of it is read. Here a list grows with its elements, and a text is copied after all of it was read.

use serde::{Deserialize, Deserializer};
use std::collections::{BTreeMap, LinkedList};

pub(crate) fn text<'de, D: Deserializer<'de>>(from: D) -> Result<String, D::Error> {
    <&str>::deserialize(from).map(str::to_owned)
}

pub(crate) fn counts<'de, D: Deserializer<'de>>(from: D) -> Result<BTreeMap<String, u64>, D::Error> {
    let counts = BTreeMap::<&str, u64>::deserialize(from)?;
    Ok(counts.into_iter().map(|(name, count)| (name.to_owned(), count)).collect())
}

pub(crate) fn shares<'de, D: Deserializer<'de>>(from: D) -> Result<Vec<(String, f64)>, D::Error> {
    let shares: Vec<(&str, f64)> = list(from)?;
    Ok(shares.into_iter().map(|(name, share)| (name.to_owned(), share)).collect())
}

pub(crate) fn list<'de, D: Deserializer<'de>, T: Deserialize<'de>>(from: D) -> Result<Vec<T>, D::Error> {
    // Serde reserves no memory for a linked list.
    LinkedList::deserialize(from).map(Vec::from_iter)
}

#[cfg(test)]
mod tests {
    use super::super::{meta::Versioned, meta_config, tests::meta};
    use std::{
        alloc::{GlobalAlloc, Layout, System},
        cell::Cell,
    };

    thread_local! {
        /// The largest allocation of this thread, bytes.
        static LARGEST: Cell<usize> = const { Cell::new(0) };
    }

    struct Watched;

    // SAFETY: the system serves every request; recording its size allocates nothing.
    #[allow(unsafe_code)]
    unsafe impl GlobalAlloc for Watched {
        unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
            LARGEST.with(|largest| largest.set(largest.get().max(layout.size())));
            // SAFETY: the caller keeps the contract of the system's allocator.
            unsafe { System.alloc(layout) }
        }

        unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
            // SAFETY: as above; the pointer is the system's.
            unsafe { System.dealloc(pointer, layout) }
        }
    }

    #[global_allocator]
    static WATCHED: Watched = Watched;

    fn largest(block: &[u8]) -> usize {
        LARGEST.with(|largest| largest.set(0));
        bincode::serde::decode_from_slice::<Versioned, _>(block, meta_config()).ok();
        LARGEST.with(Cell::get)
    }

    /// Writes a large length at every offset of the facts.
    ///
    /// Seen to catch: serde's own list and the decoder's own text, which allocate a megabyte for 500 bytes.
    #[test]
    fn no_claim_of_a_length_allocates_more_than_a_few_times_the_block() {
        let mut facts = meta(3);
        facts.options.shares = vec![("Wax".into(), 0.5)];
        let block = bincode::serde::encode_to_vec(Versioned::V7(facts), meta_config()).expect("encodes");
        let room = 8 * block.len();
        assert!((1..room).contains(&largest(&block)));
        for at in 0..block.len() - 8 {
            for length in [5000, 1_000_000, 1 << 40, u64::MAX] {
                let mut claimed = block.clone();
                claimed[at..at + 8].copy_from_slice(&length.to_le_bytes());
                assert!(largest(&claimed) < room, "{length} at {at}: {} bytes", largest(&claimed));
            }
        }
    }
}

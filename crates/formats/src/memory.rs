//! Whether there is memory for what a file asks for.

use memmap2::MmapMut;

/// Whether the system would grant so many bytes now. It is asked itself: the allocator of a program may end the process
/// instead of saying no.
pub(crate) fn has_room(bytes: u64) -> bool {
    usize::try_from(bytes).is_ok_and(|bytes| MmapMut::map_anon(bytes.max(1)).is_ok())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_little_is_there_and_all_is_not() {
        assert!(has_room(0) && has_room(1 << 20));
        assert!(!has_room(u64::MAX) && !has_room(1 << 60));
    }
}

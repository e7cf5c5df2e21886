//! Checks that there is memory for the size that a file states.

use memmap2::MmapMut;

/// Whether the system would grant `bytes` of memory now. The system itself is asked, because a program's allocator may
/// end the process instead of returning an error.
pub(crate) fn has_room(bytes: u64) -> bool {
    usize::try_from(bytes).is_ok_and(|bytes| MmapMut::map_anon(bytes.max(1)).is_ok())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn little_memory_is_granted_and_all_is_not() {
        assert!(has_room(0) && has_room(1 << 20));
        assert!(!has_room(u64::MAX) && !has_room(1 << 60));
    }
}

//! Memory for the size that a file states.

use memmap2::MmapMut;

/// `count` zeros, if the system would grant the memory for them now. The system itself is asked, because a program's
/// allocator may end the process instead of returning an error.
pub(crate) fn zeros<T: Clone + Default>(count: usize) -> Option<Vec<T>> {
    let bytes = count.saturating_mul(size_of::<T>()).max(1);
    MmapMut::map_anon(bytes).is_ok().then(|| vec![T::default(); count])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn little_memory_is_granted_and_all_is_not() {
        assert!(zeros::<u8>(0).is_some() && zeros::<u8>(1 << 20).is_some());
        assert!(zeros::<u64>(usize::MAX).is_none() && zeros::<u8>(1 << 60).is_none());
    }
}

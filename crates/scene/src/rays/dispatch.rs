//! The choice of instructions when the program runs.

#[cfg(target_arch = "x86_64")]
use super::avx2::Avx2;
use super::vectors::{Plain, Query};

/// Runs a query with the widest vectors that the processor has.
#[inline(always)]
pub(super) fn run<Q: Query>(query: Q) -> Q::Found {
    #[cfg(target_arch = "x86_64")]
    if let Some(avx2) = Avx2::detect() {
        return avx2.run(query);
    }
    query.run(Plain)
}

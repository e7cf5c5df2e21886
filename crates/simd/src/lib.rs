//! One body, compiled for several instruction sets, chosen when the program runs.
//!
//! Fused multiply-adds are not used, and lanes and sums have a fixed order, so all versions give the same bits. On
//! other processors, and where a feature is missing, the plain body runs: it is the same code. (Fused, the models would
//! gain a tenth to a quarter; processors without the instruction would have to call a function for each.)
//!
//! What a body calls must be inlined into it, or it is compiled for the plainest processor: so no `map` of an array, whose
//! closures are not, and loops over lanes instead. `perf` shows what escaped.

/// Work that wants vector instructions. `run` must be `#[inline(always)]`, and so must all it calls.
pub trait Kernel {
    type Output;
    fn run(self) -> Self::Output;
}

/// The instruction sets that kernels are compiled for, narrowest first.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Level {
    /// What every processor of the target has.
    Plain,
    /// Eight float32 at a time.
    Avx2,
    /// Sixteen float32 at a time.
    Avx512,
}

impl Level {
    /// All levels, narrowest first.
    pub const ALL: [Level; 3] = [Level::Plain, Level::Avx2, Level::Avx512];

    /// True if this processor can run the level.
    pub fn is_available(self) -> bool {
        match self {
            Level::Plain => true,
            #[cfg(target_arch = "x86_64")]
            Level::Avx2 => is_x86_feature_detected!("avx2"),
            #[cfg(target_arch = "x86_64")]
            Level::Avx512 => has_avx512(),
            #[cfg(not(target_arch = "x86_64"))]
            Level::Avx2 | Level::Avx512 => false,
        }
    }

    /// The widest level that this processor can run.
    pub fn widest() -> Level {
        Level::ALL.into_iter().rev().find(|level| level.is_available()).unwrap_or(Level::Plain)
    }
}

/// Runs a kernel with the widest vectors that the processor has.
pub fn dispatch<K: Kernel>(kernel: K) -> K::Output {
    run_as(Level::widest(), kernel)
}

/// Runs a kernel as compiled for every processor of the target: what the others are tested against.
pub fn run_plain<K: Kernel>(kernel: K) -> K::Output {
    kernel.run()
}

/// Runs a kernel at one level, or plain where the processor lacks it: all give the same bits.
#[allow(unsafe_code)]
pub fn run_as<K: Kernel>(level: Level, kernel: K) -> K::Output {
    match level {
        #[cfg(target_arch = "x86_64")]
        // SAFETY: the processor has the features that the function is compiled for; checked in this line.
        Level::Avx512 if level.is_available() => unsafe { run_avx512(kernel) },
        #[cfg(target_arch = "x86_64")]
        // SAFETY: as above.
        Level::Avx2 if level.is_available() => unsafe { run_avx2(kernel) },
        _ => run_plain(kernel),
    }
}

/// Asks for the cache line at a place that will be read soon. A list of sums over scattered samples waits for memory a
/// quarter of its time without it.
#[inline(always)]
#[allow(unsafe_code)]
pub fn prefetch<T>(place: &T) {
    #[cfg(target_arch = "x86_64")]
    {
        use std::arch::x86_64::{_MM_HINT_T0, _mm_prefetch};
        // SAFETY: a prefetch reads nothing and never faults; the reference is valid besides.
        unsafe { _mm_prefetch::<_MM_HINT_T0>(std::ptr::from_ref(place).cast()) };
    }
    #[cfg(not(target_arch = "x86_64"))]
    let _ = place;
}

#[cfg(target_arch = "x86_64")]
fn has_avx512() -> bool {
    is_x86_feature_detected!("avx512f")
        && is_x86_feature_detected!("avx512vl")
        && is_x86_feature_detected!("avx512dq")
        && is_x86_feature_detected!("avx512bw")
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx512f,avx512vl,avx512dq,avx512bw")]
fn run_avx512<K: Kernel>(kernel: K) -> K::Output {
    kernel.run()
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2")]
fn run_avx2<K: Kernel>(kernel: K) -> K::Output {
    kernel.run()
}

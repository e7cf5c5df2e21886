//! One body of code, compiled for several instruction sets, of which the program chooses one when it runs.
//!
//! All versions give the same bits: fused multiply-adds are not used, and lanes and sums have a fixed order. The plain
//! version runs on other processors, and where a feature is missing. (With fused multiply-adds, the models would be a
//! tenth to a quarter faster; a processor without the instruction would have to call a function for each.)
//!
//! Whatever a kernel calls must be inlined into it: a function that is not is compiled for the plain instruction set.
//! So kernels have loops over lanes and no `map` of an array, whose closures are not inlined. `perf` shows what was
//! not.
//!
//! ```
//! struct Dot<'a>(&'a [f32; 16], &'a [f32; 16]);
//!
//! impl simd::Kernel for Dot<'_> {
//!     type Output = f32;
//!
//!     #[inline(always)]
//!     fn run(self) -> f32 {
//!         let mut sum = 0.0;
//!         for lane in 0..16 {
//!             sum += self.0[lane] * self.1[lane];
//!         }
//!         sum
//!     }
//! }
//!
//! let (a, b) = ([0.5; 16], [2.0; 16]);
//! assert_eq!(simd::dispatch(Dot(&a, &b)), 16.0);
//! assert!(simd::Level::ALL.iter().all(|level| simd::run_as(*level, Dot(&a, &b)) == 16.0));
//! ```

/// Work for vector instructions. `run` must be `#[inline(always)]`, and so must all that it calls.
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

/// Requests the cache line of a value that will be read soon. Without it, sums over scattered samples wait for memory a
/// quarter of their time.
#[inline(always)]
#[allow(unsafe_code)]
pub fn prefetch<T>(value: &T) {
    #[cfg(target_arch = "x86_64")]
    {
        use std::arch::x86_64::{_MM_HINT_T0, _mm_prefetch};
        // SAFETY: a prefetch reads nothing and never faults; the reference is valid besides.
        unsafe { _mm_prefetch::<_MM_HINT_T0>(std::ptr::from_ref(value).cast()) };
    }
    #[cfg(not(target_arch = "x86_64"))]
    let _ = value;
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

//! Fuzz targets: what must hold for any bytes that the programs are given as a file.
//!
//! Each target reads bytes with the function that the programs use, and checks the result. It returns whether the
//! bytes were accepted; a panic, an abort, high memory or an endless run is a failure. The programs of the fuzzer in
//! `fuzz/` and the ordinary test of this package call the same functions.
//!
//! ```
//! assert!(!fuzz_targets::view(b"{}"));
//! ```

mod calibration;
mod cloud;
mod comparison;
mod facts;
mod file;
mod image;
mod limits;
mod medium;
pub mod mutation;
mod pipeline;
mod scene;
mod view;

pub use calibration::calibration;
pub use cloud::cloud;
pub use facts::facts;
pub use image::image;
pub use limits::limits;
pub use medium::medium;
pub use scene::gltf;
pub use view::view;

/// Reads bytes and checks what was accepted; true if they were.
pub type Target = fn(&[u8]) -> bool;

/// All targets by name. The first two test `bincode`, which is no longer maintained.
pub const TARGETS: [(&str, Target); 8] = [
    ("facts", facts),
    ("calibration", calibration),
    ("cloud", cloud),
    ("gltf", gltf),
    ("image", image),
    ("limits", limits),
    ("medium", medium),
    ("view", view),
];

/// A target by its name.
pub fn target(name: &str) -> Option<Target> {
    TARGETS.iter().find(|(known, _)| *known == name).map(|(_, target)| *target)
}

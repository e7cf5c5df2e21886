//! Fuzz targets: what must hold of any bytes that are given to the programs as a file.
//!
//! Each target reads bytes through the door that the programs use, and looks at what was accepted as they do. It returns
//! whether the bytes were accepted; it panics, aborts, takes much memory or does not end where a promise is broken. The
//! fuzzer's programs in `fuzz/` and the ordinary test of this package call the same functions.

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

pub use cloud::cloud;
pub use facts::facts;
pub use image::image;
pub use limits::limits;
pub use medium::medium;
pub use scene::gltf;
pub use view::view;

/// Reads bytes and checks what was accepted; true if they were.
pub type Target = fn(&[u8]) -> bool;

/// All targets by name; first the one that a decoder stands behind which nobody maintains any more.
pub const TARGETS: [(&str, Target); 7] = [
    ("facts", facts),
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

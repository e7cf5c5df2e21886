//! The files that link the stages: point clouds, images, and how any file is written whole or not at all.
//!
//! Little-endian throughout. Readers treat every file as hostile: bytes as they are, then a checked type.

#[cfg(target_endian = "big")]
compile_error!("clouds are mapped little-endian; this target is big-endian");

pub mod atomic;
pub mod cloud;
mod error;
pub mod image;
mod memory;
pub mod octahedral;
mod panorama;
mod ply;

pub use error::Error;
pub use image::{Attribute, Channel, Image, ImageError, Window};
pub use panorama::{Panorama, PanoramaSize};
pub use ply::write_ply;

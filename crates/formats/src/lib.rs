//! The files that join the programs: point clouds, images and environment maps.
//!
//! [`cloud`] maps a point cloud into memory as it lies in its file. [`Image`] reads and writes OpenEXR, and
//! [`Panorama`] reads OpenEXR and Radiance HDR as light from all around. [`octahedral`] stores a unit vector in four
//! bytes. [`atomic`] writes a file whole or not at all. All numbers are little-endian. Readers trust no file: its bytes
//! become a checked type, and a size that a file only claims allocates no memory.
//!
//! ```
//! use formats::{Channel, Image};
//!
//! let luminance = Channel { name: "Y".into(), samples: vec![0.25, 4.0] };
//! let image = Image { width: 2, height: 1, channels: vec![luminance], ..Image::default() };
//! assert_eq!(Image::decode(&image.encode()?)?, image);
//! # Ok::<(), formats::ImageError>(())
//! ```

#[cfg(target_endian = "big")]
compile_error!("clouds are mapped little-endian; this target is big-endian");

pub mod atomic;
pub mod calibration;
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

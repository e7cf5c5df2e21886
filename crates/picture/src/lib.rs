//! Pictures for people, sRGB of eight bits: PNG files, and letters to put on them.

pub mod font;
mod picture;

pub use picture::{Picture, PictureError};

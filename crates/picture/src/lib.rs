//! Pictures for people: sRGB of eight bits, PNG files, and a font of dots for titles.
//!
//! ```
//! use picture::{Picture, font};
//!
//! let mut sheet = Picture::new(64, 32, [255; 3]);
//! sheet.draw(&Picture::new(300, 200, [40, 90, 160]).fit(24), 4, 4);
//! font::dots("wax", sheet.width).for_each(|(x, y)| sheet.dot(30 + x, 4 + y, [0; 3]));
//! let file = sheet.encode(png::Compression::Fast, &[("Software", "an example")])?;
//! assert!(file.starts_with(b"\x89PNG"));
//! # Ok::<(), png::EncodingError>(())
//! ```

pub mod font;
mod picture;

pub use picture::{Picture, PictureError};

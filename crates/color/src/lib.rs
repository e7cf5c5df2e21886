//! sRGB and tone curves: the numbers by which linear light becomes what a screen shows, and back.
//!
//! Linear red, green and blue have the primaries and the white of Rec. 709, which sRGB shares. [`srgb`] holds its
//! transfer functions, [`xyz`] the matrices to and from CIE X, Y, Z, [`oklab`] a space of equal steps, and [`tone`] a
//! curve that compresses bright light. Kernels that compute in lanes have the formulas in float32 and take the
//! constants from here.
//!
//! ```
//! // A middle gray of 18 % has the code 118.
//! assert_eq!(color::srgb::encode_byte(0.18), 118);
//! assert!((color::srgb::decode_byte(118) - 0.18).abs() < 0.002);
//! // White paper, 0.9, is white; three stops above it, so is the tone-mapped picture.
//! assert!(color::tone::aces(0.6 * 0.9) > 0.6 && color::tone::aces(0.6 * 7.2) > 0.95);
//! ```

pub mod oklab;
pub mod srgb;
pub mod tone;
pub mod xyz;

/// CIE x and y of red, green and blue (ITU-R BT.709, table 1).
pub const PRIMARIES: [[f64; 2]; 3] = [[0.64, 0.33], [0.30, 0.60], [0.15, 0.06]];

/// CIE x and y of white, D65 (ITU-R BT.709, table 1).
pub const WHITE: [f64; 2] = [0.3127, 0.3290];

/// Weights of linear red, green and blue in the luminance (IEC 61966-2-1).
pub const LUMINANCE: [f64; 3] = [0.2126, 0.7152, 0.0722];

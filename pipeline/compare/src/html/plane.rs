//! The encoding of samples as text.

use std::io::Write;

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use flate2::Compression;
use flate2::write::ZlibEncoder;

/// One channel of one image as text.
#[derive(Clone, Debug)]
pub(super) struct Plane {
    /// The number of its block in the page.
    pub id: usize,
    /// The deflated bytes in base64.
    pub text: String,
}

/// Encodes the first bytes of all little-endian float32, then all second, third and fourth bytes, deflated and in
/// base64.
///
/// Bytes of the same significance are similar, above all those of the exponents. Higher levels of compression gain 3 %
/// on renderings at many times the cost, because the low bits of noise do not compress.
pub(super) fn encode(samples: &[f32]) -> String {
    let bytes: Vec<u8> = (0..4).flat_map(|byte| samples.iter().map(move |s| s.to_le_bytes()[byte])).collect();
    let mut encoder = ZlibEncoder::new(Vec::new(), Compression::fast());
    // Writing to a vector cannot fail.
    let deflated = encoder.write_all(&bytes).and_then(|()| encoder.finish()).unwrap_or_default();
    STANDARD.encode(deflated)
}

/// Whether both planes have the same bits.
pub(super) fn same_bits(reference: &[f32], test: &[f32]) -> bool {
    reference.iter().map(|s| s.to_bits()).eq(test.iter().map(|s| s.to_bits()))
}

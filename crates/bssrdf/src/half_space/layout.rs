//! What the table holds: the places of its numbers, and the bytes of its file.

use super::boundary::critical_cosine;

/// The first bytes of the file; the digit is the version of its layout and of [`Images`](super::Images).
pub const MAGIC: &[u8; 8] = b"HALFSPC2";

/// Relative indices, inside over outside.
pub const ETAS: [f64; 19] =
    [0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 0.96, 1.0, 1.02, 1.06, 1.13, 1.22, 1.33, 1.42, 1.5, 1.65, 1.85, 2.15, 2.5];
/// The place of `η = 1`, where functions of the index have a kink.
pub const MATCHED: usize = 7;

/// `√(1 − α')`: the logarithm of the reflectance is nearly linear in it.
pub const STEPS: [f64; 17] =
    [0.0, 0.05, 0.075, 0.1, 0.15, 0.2, 0.25, 0.3, 0.35, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 0.95, 1.0];

/// Distances: rings, a quarter of an octave wide, from [`FIRST`] reduced mean free paths. Numbers belong to their middles.
pub const RINGS: usize = 72;
pub const FIRST: f64 = 1.0 / 2048.0;
pub const RINGS_PER_OCTAVE: f64 = 4.0;

/// The number of terms of a profile at each distance.
pub const TERMS: usize = 5;

/// The model knows `p` and `q` up to these; they are larger only where no light is left.
pub const LARGEST_POWER: f64 = 8.0;
pub const LARGEST_SQUARE: f64 = 4.0;

/// Numbers are stored as integers of 16 bits, in units of 1/1024.
pub const UNIT: f64 = 1.0 / 1024.0;

/// The numbers of one index and albedo: the terms at all distances, two that hold at any distance, and the mean cosine
/// of the light that leaves.
pub const RECORD: usize = TERMS * RINGS + 3;

/// The mean cosine is stored in finer units.
pub const COSINE_UNIT: f64 = 1.0 / 32768.0;

/// The bytes in front of the numbers: the magic and a checksum.
pub const HEADER: usize = 16;

/// The numbers of the profiles, after which those of [`forward`] follow.
pub const PROFILES: usize = ETAS.len() * STEPS.len() * RECORD;

/// The bytes of a file.
pub const BYTES: usize = HEADER + 2 * (PROFILES + forward::NUMBERS);

/// Where the reflectance of Henyey and Greenstein's phase function is tabulated, over that by similarity.
pub mod forward {
    /// Relative indices.
    pub const ETAS: [f64; 9] = [0.5, 0.75, 1.0, 1.1, 1.2, 1.33, 1.5, 1.8, 2.5];
    /// The place of `η = 1`.
    pub const MATCHED: usize = 2;
    /// Mean cosines of the phase function, without 0, whose ratio is 1.
    pub const ASYMMETRIES: [f64; 8] = [-0.8, -0.4, 0.3, 0.55, 0.75, 0.87, 0.94, 0.98];
    /// The place of 0 among them.
    pub const ISOTROPIC: usize = 2;
    /// `√(1 − α')`; at 0 the ratio is 1, which is not stored.
    pub const STEPS: [f64; 9] = [0.0, 0.1, 0.2, 0.3, 0.45, 0.6, 0.75, 0.9, 1.0];
    /// `m` of the angles.
    pub const PLACES: [f64; 3] = [0.1, 0.55, 1.0];
    /// The numbers, `log₂` of ratios: by index, asymmetry, albedo, angle.
    pub const NUMBERS: usize = ETAS.len() * ASYMMETRIES.len() * (STEPS.len() - 1) * PLACES.len();

    /// What functions of the asymmetry are smooth in.
    pub fn coordinate(asymmetry: f64) -> f64 {
        (1.0 - asymmetry).sqrt()
    }
}

/// `±√|1 − min(η, 1/η)²|`, the cosine of the critical angle on the denser side: functions of the index are smooth in it
/// on either side of 1.
pub fn eta_coordinate(eta: f64) -> f64 {
    if eta >= 1.0 { critical_cosine(eta) } else { -critical_cosine(1.0 / eta) }
}

/// FNV-1a of 64 bits (Fowler, Noll, Vo 1991).
pub fn checksum(bytes: &[u8]) -> u64 {
    bytes.iter().fold(0xCBF2_9CE4_8422_2325, |sum, byte| (sum ^ u64::from(*byte)).wrapping_mul(0x0100_0000_01B3))
}

/// The bytes of a file with these numbers.
pub fn encode(numbers: &[i16]) -> Vec<u8> {
    let payload: Vec<u8> = numbers.iter().flat_map(|n| n.to_le_bytes()).collect();
    [MAGIC.as_slice(), &checksum(&payload).to_le_bytes(), &payload].concat()
}

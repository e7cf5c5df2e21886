//! The file of `calibrate`: for each material of a cloud and its medium, a smooth factor on the surface.
//!
//! ```text
//! offset  bytes  field
//!      0      8  magic 89 'P' 'C' 'K' 0D 0A 1A 0A
//!      8      4  version
//!     12      4  zero
//!     16      8  bytes of the facts
//!     24      8  xxh3-64 of bytes 0..24 and the facts
//!     32         the facts, see [`Calibration`]
//! ```

use crate::{
    Error,
    cloud::bounded::{list, text},
};
use serde::{Deserialize, Serialize};
use std::path::Path;
use xxhash_rust::xxh3::Xxh3;

const MAGIC: [u8; 8] = [0x89, b'P', b'C', b'K', 0x0D, 0x0A, 0x1A, 0x0A];
const HEADER: usize = 32;

/// The version of the format. It is raised when a field changes its meaning, or the values of a calibration change.
pub fn version() -> u32 {
    include_str!("../calibration-version").trim().parse().unwrap_or(0)
}

/// Most bytes of a file.
const LIMIT: usize = 1 << 26;

/// Most levels of splits, see [`CalibratedSurface`].
const MAX_DEPTH: u32 = 12;

/// The largest logarithm of a factor in a file: its exponential is finite.
const MAX_LOG_FACTOR: f32 = 80.0;

/// The largest coefficient of an exit lobe, the smallest index, and the largest length, m.
const MAX_LOBE: f64 = 100.0;
const MIN_ETA: f64 = 0.1;
const MAX_LENGTH: f64 = 1e18;

/// The facts of a calibration. They hold no time, host or path, so that the same inputs give the same bytes.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Calibration {
    /// Digest of everything that the calibration depends on.
    pub content: [u8; 32],
    /// Identity of the cloud or clouds.
    pub cloud: [u8; 32],
    /// Name of the BSSRDF model that the factors belong to.
    #[serde(deserialize_with = "text")]
    pub model: String,
    /// Random walks of each channel, over all materials.
    pub walks: u64,
    pub seed: u64,
    /// The sampled materials of the cloud, in their order.
    #[serde(deserialize_with = "list")]
    pub materials: Vec<CalibratedMaterial>,
}

/// A material, its medium, and its factors.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct CalibratedMaterial {
    #[serde(deserialize_with = "text")]
    pub name: String,
    /// Index into the scene's materials.
    pub index: u16,
    pub medium: MediumFacts,
    /// Identity of the roughness of its surface; none if that is smooth.
    pub roughness: Option<[u8; 32]>,
    /// `a` and `b` of the exit lobe `a + b cosθ` of each channel.
    pub lobe: [[f64; 2]; 3],
    pub errors: [ChannelErrors; 3],
    pub surface: CalibratedSurface,
}

/// The coefficients of a medium, 1/m: red, green, blue.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct MediumFacts {
    #[serde(deserialize_with = "text")]
    pub name: String,
    #[serde(deserialize_with = "text")]
    pub source: String,
    pub sigma_a: [f64; 3],
    pub sigma_s: [f64; 3],
    pub g: [f64; 3],
    pub eta: f64,
}

/// Estimated errors of the light that leaves the surface, as relMSE: the mean of `(a − b)²/(b² + 0.01)`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct ChannelErrors {
    /// Of the model without the factor.
    pub before: f64,
    /// With the factor, and the standard error of that estimate.
    pub after: f64,
    pub uncertainty: f64,
    /// Share of the surface where too few walks leave to tell.
    pub unresolved: f64,
}

/// A surface in `2^depth` patches: a heap of splits of position and scaled normal, in which node `i` has the children
/// `2i + 1` and `2i + 2`, and the center, radius and factors of each patch.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct CalibratedSurface {
    /// The length that a unit normal counts as, m.
    pub normal_scale: f64,
    /// Points whose coordinate is below the value belong to the first child.
    #[serde(deserialize_with = "list")]
    pub splits: Vec<(u8, f64)>,
    #[serde(deserialize_with = "list")]
    pub patches: Vec<CalibratedPatch>,
}

/// A patch of the surface.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct CalibratedPatch {
    /// Mean position, m, and scaled normal, m.
    pub center: [f64; 6],
    /// Largest distance of its points from the center, in these six dimensions, m.
    pub radius: f64,
    /// Natural logarithm of the factor of each channel.
    pub log_factor: [f32; 3],
    /// Gradient of the logarithm of the light that leaves, along the surface, for each channel, 1/m.
    pub gradient: [[f32; 3]; 3],
}

fn config() -> impl bincode::config::Config {
    bincode::config::standard().with_little_endian().with_fixed_int_encoding().with_limit::<LIMIT>()
}

impl Calibration {
    /// The bytes of the file.
    pub fn encode(&self, path: &Path) -> Result<Vec<u8>, Error> {
        let facts = bincode::serde::encode_to_vec(self, config())
            .map_err(|e| Error::invalid(path, format!("the calibration does not fit a file: {e}")))?;
        Ok(seal(&facts))
    }

    /// Reads and checks a file.
    pub fn read(path: &Path) -> Result<Calibration, Error> {
        let kind = std::fs::metadata(path).map_err(|source| Error::read(path, source))?;
        if !kind.is_file() {
            return Err(Error::invalid(path, "not a file"));
        }
        if kind.len() > (HEADER + LIMIT) as u64 {
            return Err(Error::invalid(path, "too long for a calibration"));
        }
        let bytes = std::fs::read(path).map_err(|source| Error::read(path, source))?;
        decode(&bytes).map_err(|what| Error::invalid(path, what))
    }
}

/// A file around encoded facts.
pub fn seal(facts: &[u8]) -> Vec<u8> {
    let mut bytes = Vec::with_capacity(HEADER + facts.len());
    bytes.extend(MAGIC);
    bytes.extend(version().to_le_bytes());
    bytes.extend([0; 4]);
    bytes.extend((facts.len() as u64).to_le_bytes());
    let sum = checksum(&bytes, facts);
    bytes.extend(sum.to_le_bytes());
    bytes.extend(facts);
    bytes
}

fn checksum(head: &[u8], facts: &[u8]) -> u64 {
    let mut hasher = Xxh3::new();
    hasher.update(head);
    hasher.update(facts);
    hasher.digest()
}

fn decode(bytes: &[u8]) -> Result<Calibration, String> {
    if !bytes.starts_with(&MAGIC) {
        return Err("not a calibration; `calibrate` writes them".into());
    }
    let word = |at: usize| -> Result<[u8; 8], String> {
        bytes.get(at..at + 8).and_then(|b| b.try_into().ok()).ok_or_else(|| "the file is truncated".into())
    };
    let (found, expected) = (u64::from_le_bytes(word(8)?), version());
    if found != u64::from(expected) {
        return Err(format!("version {found} of calibrations; this program reads {expected}; calibrate again"));
    }
    let (length, sum) = (u64::from_le_bytes(word(16)?), u64::from_le_bytes(word(24)?));
    let facts = &bytes[HEADER..];
    if facts.len() as u64 != length {
        return Err(format!("{} bytes instead of {}; calibrate again", facts.len(), length));
    }
    if checksum(&bytes[..24], facts) != sum {
        return Err("the file is damaged; calibrate again".into());
    }
    let damaged = || "the calibration is damaged; calibrate again".to_owned();
    let (calibration, used): (Calibration, usize) =
        bincode::serde::decode_from_slice(facts, config()).map_err(|_| damaged())?;
    if used == facts.len() && calibration.is_sound() { Ok(calibration) } else { Err(damaged()) }
}

impl Calibration {
    /// True if all numbers are in range, so that every factor is finite, and the splits of each surface fit its patches.
    fn is_sound(&self) -> bool {
        self.materials.iter().all(|m| {
            let errors = m.errors.iter().flat_map(|e| [e.before, e.after, e.uncertainty, e.unresolved]);
            let sizes = m.medium.sigma_a.into_iter().chain(m.medium.sigma_s).chain([m.medium.eta]).chain(errors);
            sizes.into_iter().all(|x| x.is_finite() && x >= 0.0)
                && m.medium.eta >= MIN_ETA
                && m.medium.g.iter().all(|g| g.abs() < 1.0)
                && m.lobe.iter().flatten().all(|x| x.abs() <= MAX_LOBE)
                && m.surface.is_sound()
        })
    }
}

impl CalibratedSurface {
    fn is_sound(&self) -> bool {
        let count = self.patches.len();
        let fits = count.is_power_of_two() && count <= 1 << MAX_DEPTH && self.splits.len() == count - 1;
        let is_length = |x: &f64| x.abs() <= MAX_LENGTH;
        let patch = |p: &CalibratedPatch| {
            p.center.iter().chain([&p.radius]).all(is_length)
                && p.radius >= 0.0
                && p.log_factor.iter().all(|f| f.abs() <= MAX_LOG_FACTOR)
                && p.gradient.iter().flatten().all(|f| f.is_finite())
        };
        fits && is_length(&self.normal_scale)
            && self.normal_scale > 0.0
            && self.splits.iter().all(|(axis, value)| *axis < 6 && is_length(value))
            && self.patches.iter().all(patch)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn calibration() -> Calibration {
        let patch = CalibratedPatch {
            center: [0.5; 6],
            radius: 0.1,
            log_factor: [0.1, -0.2, 0.0],
            gradient: [[1.0, 2.0, 3.0]; 3],
        };
        let medium = MediumFacts {
            name: "milk".into(),
            source: "a cow".into(),
            sigma_a: [1.0; 3],
            sigma_s: [1000.0; 3],
            g: [0.0; 3],
            eta: 1.3,
        };
        let errors = ChannelErrors { before: 0.1, after: 1e-3, uncertainty: 1e-4, unresolved: 0.0 };
        let surface = CalibratedSurface { normal_scale: 1e-3, splits: vec![(4, 0.0)], patches: vec![patch; 2] };
        let material = CalibratedMaterial {
            name: "wax".into(),
            index: 3,
            medium,
            roughness: Some([9; 32]),
            lobe: [[1.0, 0.0]; 3],
            errors: [errors; 3],
            surface,
        };
        Calibration {
            content: [7; 32],
            cloud: [8; 32],
            model: "half-space".into(),
            walks: 1000,
            seed: 1,
            materials: vec![material],
        }
    }

    fn bytes(calibration: &Calibration) -> Vec<u8> {
        calibration.encode(Path::new("x")).expect("encodes")
    }

    #[test]
    fn what_is_written_is_read() {
        assert_eq!(decode(&bytes(&calibration())), Ok(calibration()));
    }

    /// Seen to catch: no checksum.
    #[test]
    fn damaged_truncated_and_foreign_files_are_refused() {
        let good = bytes(&calibration());
        for at in 0..good.len() {
            let mut bad = good.clone();
            bad[at] ^= 0x10;
            assert!(decode(&bad).is_err(), "byte {at}");
            assert!(decode(&good[..at]).is_err(), "{at} bytes");
        }
        assert!(decode(b"glTF").is_err_and(|e| e.contains("not a calibration")));
    }

    /// Seen to catch: splits not counted; an axis not checked.
    #[test]
    fn facts_that_do_not_fit_each_other_are_refused() {
        let changes: [fn(&mut Calibration); 5] = [
            |c| c.materials[0].surface.splits.clear(),
            |c| c.materials[0].surface.splits[0].0 = 6,
            |c| c.materials[0].surface.patches[1].log_factor[2] = f32::NAN,
            |c| c.materials[0].surface.normal_scale = 0.0,
            |c| c.materials[0].medium.eta = f64::INFINITY,
        ];
        for change in changes {
            let mut calibration = calibration();
            change(&mut calibration);
            assert!(decode(&bytes(&calibration)).is_err());
        }
    }
}

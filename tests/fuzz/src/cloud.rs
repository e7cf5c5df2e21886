//! Clouds. Checksums reject random damage, so the code behind them is reached only if the checksums are corrected.

use crate::file::with_file;
use bssrdf::{Model, built_in};
use formats::cloud::{Cloud, Record, Sample, TILE, version};
use gather::{
    estimator::{CutCorrection, Estimator, Scatterer, Scratch, Sum},
    samples::{Exit, LitSamples},
};
use std::{ops::Range, path::Path, sync::LazyLock};
use xxhash_rust::xxh3::{Xxh3, xxh3_64};

/// An accepted cloud has the groups that its facts name. In a verified cloud, samples have finite positions, unit
/// vectors and a flux that is not negative, and sums over them are finite unless their numbers are absurd. Sums over a
/// cloud that was not verified do no harm. The bytes are tried as they are, and with a version, length and checksums
/// that fit.
pub fn cloud(bytes: &[u8]) -> bool {
    let mut sealed = bytes.to_vec();
    seal(&mut sealed);
    with_file("a.cloud", bytes, look_at) | with_file("b.cloud", &sealed, look_at)
}

fn look_at(path: &Path) -> bool {
    let Ok(cloud) = Cloud::open(path) else { return false };
    let good = cloud.verify(path).is_ok();
    let mut samples = 0;
    // The models need not accept positions that no scene has.
    let inside = |record: &Record| record.position.iter().all(|x| x.abs() < FARTHEST);
    let sums = good || cloud.tiles().as_flattened().iter().all(inside);
    for material in &cloud.meta().materials {
        for half in &material.halves {
            let (tiles, nodes) = cloud.group(half);
            assert!(half.samples <= (tiles.len() * TILE) as u64 && (tiles.is_empty() == nodes.is_empty()));
        }
        for sample in cloud.samples(material) {
            if sums && samples % 1000 == 0 {
                check_sums(&cloud, &sample, good);
            }
            samples += 1;
            let unit = |length: f64| (length - 1.0).abs() < 1e-12;
            assert!(unit(sample.normal.length()) && unit(sample.direction.length()), "{sample:?}");
            let lit = sample.position.is_finite() && sample.flux.is_finite() && sample.flux.min_element() >= 0.0;
            assert!(lit || !good, "{sample:?}");
        }
    }
    assert_eq!(samples, cloud.len());
    assert!(cloud.meta().samples_drawn >= cloud.len());
    true
}

/// Sums of larger numbers may exceed float32.
const SANE: f32 = 1e12;
/// No scene has a larger coordinate, m.
const FARTHEST: f32 = 1e18;

/// Sums over all groups at a sample and at a point beside it; those of a `good` cloud must be finite.
fn check_sums(cloud: &Cloud, sample: &Sample, good: bool) {
    static MARBLE: LazyLock<Scatterer> = LazyLock::new(|| {
        let medium = built_in("marble").expect("it is built in");
        Scatterer::new(Model::DirectionalDipole, &medium, 0.1)
    });
    let (correction, scratch) = (&CutCorrection::default(), &mut Scratch::default());
    let small = |s: &Sample| s.position.abs().max(s.flux).max_element() < SANE;
    for group in cloud.meta().materials.iter().flat_map(|m| &m.halves) {
        let samples = &LitSamples::new(cloud, group, MARBLE.eta());
        if samples.is_empty() {
            continue;
        }
        for offset in [0.0, 1e-3] {
            let exit = &Exit::new(sample.position.as_dvec3() + offset, sample.normal, 7);
            let mut sum = |estimator: &Estimator| {
                let estimator = estimator.map_accuracy(|_| 0.1);
                estimator.sum(&MARBLE, correction, samples, exit, scratch)
            };
            let sums: Vec<Sum> = Estimator::ALL.iter().map(&mut sum).collect();
            if good && cloud.meta().materials.iter().flat_map(|m| cloud.samples(m)).all(|s| small(&s)) {
                assert!(sums.iter().all(|s| s.radiance.is_finite() && s.radiance.min_element() >= 0.0), "{sums:?}");
            }
        }
    }
}

const HEADER: usize = 64;
const ENTRY: usize = 64;

/// Corrects the version, the length and all checksums, as far as the file has them. The layout is that of
/// `formats::cloud`, in which each section of a small file is one block.
pub fn seal(file: &mut [u8]) -> Option<()> {
    let length = file.len() as u64;
    file.get_mut(8..10)?.copy_from_slice(&version().to_le_bytes());
    file.get_mut(16..24)?.copy_from_slice(&length.to_le_bytes());
    let count = u32::from_le_bytes(file.get(32..36)?.try_into().ok()?) as usize;
    let table = HEADER..count.checked_mul(ENTRY)?.checked_add(HEADER)?;
    file.get(table.clone())?;
    for entry in table.clone().step_by(ENTRY) {
        if let Some(range) = section(&file[entry..entry + ENTRY])
            && let Some(bytes) = file.get(range)
        {
            let sum = xxh3_64(bytes);
            file[entry + 56..entry + 64].copy_from_slice(&sum.to_le_bytes());
        }
    }
    let mut hasher = Xxh3::new();
    hasher.update(&file[..56]);
    hasher.update(&file[table]);
    file[56..64].copy_from_slice(&hasher.digest().to_le_bytes());
    Some(())
}

/// The bytes of a section, by its entry in the table.
fn section(entry: &[u8]) -> Option<Range<usize>> {
    let number = |at: usize| usize::try_from(u64::from_le_bytes(entry[at..at + 8].try_into().ok()?)).ok();
    let (start, length) = (number(24)?, number(32)?);
    Some(start..start.checked_add(length)?)
}

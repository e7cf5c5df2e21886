//! Clouds that are damaged, or forged with correct checksums, are refused or do no harm: no panic, no hang.

use crate::{forge::Forged, scenes::aimed_at};
use bssrdf::Model;
use formats::cloud::{Cloud, Meta};
use gather::{
    Input, Settings,
    estimator::{Estimator, Scatterer},
    samples::{Exit, LitSamples},
};
use glam::DVec3;
use scene::Camera;
use std::{
    fs,
    panic::{AssertUnwindSafe, catch_unwind},
    path::PathBuf,
    slice::from_ref,
    time::{Duration, Instant},
};
use test_support::{
    Bench,
    lit::{scatterer, sum},
    meshes::{Light, Part, World, quad, world},
    pipeline::{ESTIMATORS, gray, sampled, settings, stratified, write},
};

/// Stored samples: five tiles in each half, whose trees have room for eight, so that some nodes hold nothing.
const SAMPLES: u64 = 150;

/// Values that replace floats and words.
const FLOATS: [f32; 9] = [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, f32::MAX, f32::MIN, 1e30, -1.0, 0.0, 1e-45];

struct Lab {
    bench: Bench,
    world: World,
    camera: Camera,
    scatterer: Scatterer,
    good: Forged,
}

impl Lab {
    fn new() -> Lab {
        Lab::of(SAMPLES)
    }

    fn of(samples: u64) -> Lab {
        let sun = Light::Directional { towards: DVec3::Z, irradiance: DVec3::ONE };
        let world = world(&[Part::translucent(quad(5e-3, 0.0, 1))], &[sun], DVec3::ZERO);
        let bench = Bench::new();
        write(&sampled(&world, &stratified(samples, 1)), &bench.path("good.cloud"));
        let good = Forged(bench.read("good.cloud"));
        let camera = aimed_at(DVec3::ZERO, DVec3::new(0.3, 0.2, 1.0), 2e-3);
        let scatterer = scatterer(Model::StandardDipole, &gray(100.0, 1000.0, 0.0, 1.3));
        Lab { bench, world, camera, scatterer, good }
    }

    fn path(&self) -> PathBuf {
        self.bench.path("bad.cloud")
    }

    /// Does with a cloud what `gather` does, except for the comparison of its metadata with the scene; returns
    /// whether the cloud is accepted.
    fn takes(&self, forged: &Forged) -> bool {
        self.bench.write("bad.cloud", &forged.0);
        let Ok(cloud) = Cloud::open(&self.path()) else {
            return false;
        };
        if cloud.verify(&self.path()).is_err() {
            return false;
        }
        for half in cloud.meta().materials.iter().flat_map(|m| m.halves) {
            let samples = LitSamples::new(&cloud, &half, 1.3);
            for x in [0.0, 5e-3, 1.0] {
                let exit = Exit::new(DVec3::new(x, 0.0, 0.0), DVec3::Z, forged.0[20].into());
                for estimator in ESTIMATORS {
                    sum(&self.scatterer, &samples, &exit, estimator);
                }
            }
        }
        true
    }

    /// Renders one image of the cloud if it is accepted.
    fn renders(&self, forged: &Forged) {
        if self.takes(forged)
            && let Ok(cloud) = Cloud::open(&self.path())
            && cloud.meta().materials.iter().all(|m| m.index == 0)
        {
            let media = vec![gray(100.0, 1000.0, 0.0, 1.3); cloud.meta().materials.len()];
            let estimator = Estimator::Cut { accuracy: 0.01 };
            let settings = Settings { estimator, paths_per_pixel: 2, ..settings(Model::StandardDipole, 2, 2) };
            let (scene, rays) = (&self.world.scene, &self.world.rays);
            let input = Input {
                scene,
                rays,
                clouds: from_ref(&cloud),
                media: &media,
                tints: &[],
                calibration: None,
                camera: &self.camera,
            };
            gather::render(&input, &settings, |_| ());
        }
    }

    /// Fails if one of the forgeries does harm; returns how many were accepted.
    fn harmless(&self, forgeries: impl Iterator<Item = (String, Forged)>) -> usize {
        let (mut taken, mut harmful) = (0, Vec::new());
        for (what, forged) in forgeries {
            let start = Instant::now();
            match catch_unwind(AssertUnwindSafe(|| self.takes(&forged))) {
                Ok(takes) => taken += usize::from(takes),
                Err(_) => harmful.push(format!("{what}: a panic")),
            }
            if start.elapsed() > Duration::from_secs(20) {
                harmful.push(format!("{what}: hangs"));
            }
        }
        assert!(harmful.is_empty(), "{} forgeries do harm: {:#?}", harmful.len(), &harmful[..harmful.len().min(20)]);
        taken
    }

    /// All variants of a section in which one of its words is replaced by one of these.
    fn replaced<'a>(&'a self, section: &'a str, words: &'a [u32]) -> impl Iterator<Item = (String, Forged)> + 'a {
        let range = self.good.section(section);
        range.clone().step_by(4).flat_map(move |at| {
            words.iter().map(move |word| {
                let mut forged = self.good.clone();
                forged.put(at, &word.to_le_bytes());
                let index = (at - range.start) / 4;
                (format!("word {index} of {section} is {:e} ({word:x})", f32::from_bits(*word)), forged.sealed())
            })
        })
    }
}

#[test]
fn the_cloud_is_taken_as_it_is() {
    let lab = Lab::new();
    assert!(lab.takes(&lab.good) && lab.takes(&lab.good.clone().sealed()));
    assert_eq!(lab.good.0, lab.good.clone().sealed().0, "the checksums are those of the format");
}

/// Every byte of header and table, with and without the right checksum.
///
/// Seen to catch: a header whose checksum is not checked.
#[test]
fn headers() {
    let lab = Lab::new();
    let changed = |at: usize, by: u8| {
        let mut forged = lab.good.clone();
        forged.0[at] ^= by;
        forged
    };
    let all = || lab.good.head().flat_map(|at| [1, 0x80, 0xff].map(|by| (at, by)));
    let damaged = all().map(|(at, by)| (format!("byte {at} ^ {by}"), changed(at, by)));
    assert_eq!(lab.harmless(damaged), 0, "a damaged header is found");
    let sealable = |f: &Forged| f.head().end <= f.0.len();
    let forged = all().map(|(at, by)| (format!("byte {at} ^ {by}, sealed"), changed(at, by)));
    let forged = forged.filter(|(_, f)| sealable(f)).map(|(what, f)| (what, f.sealed_head()));
    let taken = lab.harmless(forged);
    assert!(taken < 3 * 64, "{taken} changed headers taken");
}

/// Every byte of the metadata, with correct checksums: numbers, lengths of lists, and texts.
#[test]
fn facts() {
    let lab = Lab::new();
    let changed = |(at, by): (usize, u8)| {
        let mut forged = lab.good.clone();
        forged.0[at] ^= by;
        (format!("byte {at} of the file ^ {by}"), forged.sealed())
    };
    let range = lab.good.section("meta");
    lab.harmless(range.clone().flat_map(|at| [1, 0x7f, 0x80, 0xff].map(|by| (at, by))).map(changed));
    let long = |at: usize| {
        let mut forged = lab.good.clone();
        forged.put(at, &u64::MAX.to_le_bytes());
        (format!("eight bytes at {at}"), forged.sealed())
    };
    lab.harmless((range.start..range.end - 8).map(long));
}

/// Counts and offsets of groups, and K, that do not fit into the file.
///
/// Seen to catch: groups that are not checked against the sections.
#[test]
fn groups() {
    let lab = Lab::new();
    let huge = [1, SAMPLES - 1, 1 << 36, 1 << 60, u64::MAX];
    type Change = fn(&mut Meta, u64);
    let changes: [(&str, Change); 8] = [
        ("samples of the first half", |m, n| m.materials[0].halves[0].samples = n),
        ("samples of the second half", |m, n| m.materials[0].halves[1].samples = n),
        ("first tile", |m, n| m.materials[0].halves[1].first_tile = n),
        ("first node", |m, n| m.materials[0].halves[1].first_node = n),
        ("first tile of the first half", |m, n| m.materials[0].halves[0].first_tile = n),
        ("K", |m, n| m.samples_drawn = n),
        ("no material", |m, _| m.materials.clear()),
        ("many materials", |m, n| m.materials = vec![m.materials[0].clone(); n as usize % 1000]),
    ];
    let cases = changes.iter().flat_map(|change| huge.map(|n| (change, n)));
    let mut taken = Vec::new();
    for ((what, change), n) in cases {
        let mut drawn = sampled(&lab.world, &stratified(SAMPLES, 1));
        change(&mut drawn.meta, n);
        write(&drawn, &lab.path());
        let forged = Forged(lab.bench.read("bad.cloud"));
        if lab.harmless(std::iter::once((format!("{what}: {n}"), forged.clone()))) > 0 {
            taken.push(*what);
        }
        lab.renders(&forged);
    }
    // A larger K is valid.
    assert!(taken.iter().all(|what| ["K", "many materials"].contains(what)), "{taken:?}");
}

/// Every number of every sample.
#[test]
fn tiles() {
    let lab = Lab::new();
    let words = [FLOATS.map(f32::to_bits).as_slice(), &[u32::MAX, 0x8000_8000]].concat();
    lab.harmless(lab.replaced("tile", &words));
}

/// Every number of every node, including nodes that have no tiles or lie outside the file.
///
/// Seen to catch: a pick from a node beyond the last sample; a negative flux, which opens leaves beyond the last tile.
#[test]
fn nodes() {
    for samples in [1, 2 * 37, SAMPLES] {
        let lab = Lab::of(samples);
        lab.harmless(lab.replaced("node", &FLOATS.map(f32::to_bits)));
    }
}

/// A file of a hundred million samples, nearly all of it a hole, opens in milliseconds, because opening reads no
/// samples.
///
/// Seen to catch: all checksums verified when the file is opened.
#[test]
fn opening_reads_no_samples() {
    let lab = Lab::new();
    let samples = 1u64 << 27;
    let mut drawn = sampled(&lab.world, &stratified(SAMPLES, 1));
    drawn.meta.samples_drawn = 2 * samples;
    drawn.meta.materials[0].halves[0].samples = samples;
    let group = drawn.meta.materials[0].halves[0];
    let second = &mut drawn.meta.materials[0].halves[1];
    (second.samples, second.first_tile, second.first_node) = (0, group.tiles(), group.nodes());
    write(&drawn, &lab.path());
    let mut forged = Forged(lab.bench.read("bad.cloud"));
    let tiles = forged.section("tile").start as u64;
    let nodes = tiles + group.tiles() * 512;
    let end = nodes + group.nodes() * 32;
    for (name, offset, bytes, elements) in
        [("tile", tiles, nodes - tiles, group.tiles()), ("node", nodes, end - nodes, group.nodes())]
    {
        let entry = forged.entry(name);
        [offset, bytes, bytes, elements]
            .iter()
            .enumerate()
            .for_each(|(k, n)| forged.put(entry + 24 + 8 * k, &n.to_le_bytes()));
    }
    forged.put(16, &end.to_le_bytes());
    forged.put(24, &samples.to_le_bytes());
    let forged = forged.sealed_head();
    lab.bench.write("bad.cloud", &forged.0);
    fs::OpenOptions::new().write(true).open(lab.path()).and_then(|f| f.set_len(end)).expect("files may have holes");
    let open = |_| {
        let start = Instant::now();
        let cloud = Cloud::open(&lab.path()).expect("the header fits the file");
        assert_eq!(cloud.len(), samples);
        start.elapsed()
    };
    let fastest = (0..10).map(open).min().expect("ten times");
    assert!(fastest < Duration::from_millis(5), "{fastest:?}");
}

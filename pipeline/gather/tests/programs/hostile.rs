//! Forged clouds with correct checksums are refused with one message, or rendered, in seconds and in little memory.

use formats::{
    atomic::Output,
    cloud::{self, Cloud, Content, Group, Meta, Node, TILE},
};
use std::{
    fs::OpenOptions,
    io::{Seek, SeekFrom, Write},
    time::{Duration, Instant},
};
use test_support::{Bench, Limits, data};

/// A cloud that can be changed.
#[derive(Clone)]
struct Parts {
    content: Content,
    meta: Meta,
}

impl Parts {
    fn read(bench: &Bench, name: &str) -> Parts {
        let cloud = Cloud::open(&bench.path(name)).expect("a cloud");
        let content = Content { samples: cloud.len(), tiles: cloud.tiles().to_vec(), nodes: cloud.nodes().to_vec() };
        Parts { content, meta: cloud.meta().clone() }
    }

    fn write(&self, bench: &Bench, name: &str) {
        let path = bench.path(name);
        let mut output = Output::create(&path).expect("a file");
        cloud::write(&mut output, &path, &self.content, &self.meta).expect("a cloud");
        output.commit().expect("a file");
    }
}

type Change = fn(&mut Parts);

/// Forgeries, and whether each must be refused.
const FORGERIES: [(&str, bool, Change); 21] = [
    ("as it is", false, |_| ()),
    ("more samples than there are", true, |p| p.meta.materials[0].halves[0].samples += 1 << 40),
    ("all samples there could be", true, |p| p.meta.materials[0].halves[0].samples = u64::MAX),
    ("a tile far away", true, |p| p.meta.materials[0].halves[1].first_tile = u64::MAX),
    ("a node far away", true, |p| p.meta.materials[0].halves[1].first_node = 1 << 62),
    ("fewer drawn than stored", true, |p| p.meta.samples_drawn = 1),
    ("none drawn", true, |p| p.meta.samples_drawn = 0),
    ("very many drawn", true, |p| p.meta.samples_drawn = u64::MAX),
    ("no material", true, |p| p.meta.materials.clear()),
    ("another material", true, |p| p.meta.materials[0].index = u16::MAX),
    ("a name without end", true, |p| p.meta.materials[0].name = "x".repeat(900_000)),
    ("negative area", true, |p| p.meta.materials[0].area_m2 = -1.0),
    ("a shard beyond the last", true, |p| p.meta.options.shard.index = 1),
    ("a negative share", true, |p| p.meta.options.shares = vec![("Slab".into(), -0.5)]),
    ("nodes that are not numbers", true, |p| p.content.nodes.iter_mut().for_each(|n| n.radius = f32::NAN)),
    ("negative flux", true, |p| p.content.nodes.iter_mut().for_each(|n| n.flux = -1.0)),
    ("flux of nodes without samples", false, |p| p.content.nodes.iter_mut().for_each(|n| n.flux = 1e30)),
    ("a negative size of nodes", true, |p| p.content.nodes.iter_mut().for_each(|n| n.spread = -1e-3)),
    ("nodes without end", true, |p| p.content.nodes.iter_mut().for_each(|n| (n.spread, n.radius) = (1e38, 1e38))),
    ("samples far away", true, |p| p.content.tiles.iter_mut().flatten().for_each(|r| r.position = [3e38; 3])),
    ("samples of infinite light", true, |p| {
        p.content.tiles.iter_mut().flatten().for_each(|r| r.flux[0] = f32::INFINITY)
    }),
];

/// A cloud with five tiles in each half, whose trees have room for eight, so that some nodes are empty.
fn with_room(bench: &Bench, scene: &str) -> Parts {
    let drawn = |samples: u64| {
        bench.succeed("sample-surface", &[scene, "-n", &samples.to_string(), "-o", "good.cloud", "--quiet"]);
        Parts::read(bench, "good.cloud")
    };
    let fits = |parts: &Parts| parts.meta.materials[0].halves.iter().all(|half| half.tiles() == 5);
    (10..60).map(|k| drawn(10 * k)).find(fits).expect("one of so many numbers of samples")
}

/// Seen to catch: a pick from a node beyond the last sample, which made the program panic.
#[test]
fn forged_clouds_do_no_harm() {
    let bench = Bench::new();
    let slab = data("scenes/slab.glb");
    let good = with_room(&bench, &slab);
    for (what, refused, change) in FORGERIES {
        let mut forged = good.clone();
        change(&mut forged);
        forged.write(&bench, "bad.cloud");
        let start = Instant::now();
        let arguments = ["bad.cloud", &slab, "--medium", "marble", "--width", "4", "-o", "out.exr", "--quiet"];
        let output = bench.run_within(Limits { kibibytes: 1 << 22, seconds: 60 }, "gather", &arguments);
        let message = output.stderr;
        let code = output.status.code();
        assert!(!message.contains("panicked"), "{what}: {message}");
        if refused {
            assert_eq!(code, Some(2), "{what}: {message}");
            assert!(message.contains("bad.cloud") && message.contains("sample"), "{what}: {message}");
        } else {
            // Exit code 3 is for numbers beyond float32.
            assert!([Some(0), Some(3)].contains(&code), "{what}: {code:?} {message}");
        }
        assert!(start.elapsed() < Duration::from_secs(20), "{what} takes {:?}", start.elapsed());
    }
}

/// The number of tiles in the first half of a large cloud: 64 MiB of tiles, and 8 MiB of nodes.
const MANY_TILES: u64 = 1 << 17;

/// A large cloud of the slab whose first half repeats one tile.
fn large(bench: &Bench, scene: &str, name: &str) {
    let mut parts = with_room(bench, scene);
    let (tile, node) = (parts.content.tiles[0], parts.content.nodes[1]);
    let halves = &mut parts.meta.materials[0].halves;
    (halves[0].samples, halves[1]) = (MANY_TILES * TILE as u64, Group::default());
    (halves[1].first_tile, halves[1].first_node) = (halves[0].tiles(), halves[0].nodes());
    parts.content.samples = halves[0].samples;
    parts.content.tiles = vec![tile; halves[0].tiles() as usize];
    parts.content.nodes = vec![node; halves[0].nodes() as usize];
    parts.meta.samples_drawn = 4 * parts.content.samples;
    parts.write(bench, name);
}

/// A damaged cloud is refused before the image, which would take hours. Seen to catch: clouds of 64 MiB and more
/// checked during the work, so that the damaged tile is reported after the image, which the limits do not allow, and
/// the negative flux makes the program panic.
#[test]
fn damage_in_a_large_cloud_is_said_before_the_picture_is_made() {
    let bench = Bench::new();
    let slab = data("scenes/slab.glb");
    large(&bench, &slab, "good.cloud");
    let nodes = 2 * MANY_TILES * size_of::<Node>() as u64;
    let length = std::fs::metadata(bench.path("good.cloud")).expect("is there").len();
    let flux: Vec<u8> = (1..64).flat_map(|_| [[0; 4], (-1f32).to_le_bytes(), [0; 4], [0; 4]].concat()).collect();
    let damages = [("tile", length - nodes - (20 << 20), vec![0x41]), ("node", length - nodes + 48, flux)];
    for (section, at, bytes) in damages {
        std::fs::copy(bench.path("good.cloud"), bench.path("bad.cloud")).expect("copies");
        let mut file = OpenOptions::new().write(true).open(bench.path("bad.cloud")).expect("opens");
        file.seek(SeekFrom::Start(at)).and_then(|_| file.write_all(&bytes)).expect("writes");
        let size = ["--width", "1024", "--spp", "1024", "-o", "out.exr"];
        let arguments = [&["bad.cloud", slab.as_str(), "--medium", "marble", "--quiet"][..], &size].concat();
        let output = bench.run_within(Limits { kibibytes: 1 << 22, seconds: 5 }, "gather", &arguments);
        let message = output.stderr;
        assert_eq!(output.status.code(), Some(2), "{section}: {:?} {message}", output.status);
        assert!(
            message.contains("bad.cloud") && message.contains(&format!("section `{section}` is damaged")),
            "{message}"
        );
        assert!(!bench.path("out.exr").exists() && message.lines().count() == 1, "{message}");
    }
}

/// The image is proportional to the sun as long as its values are in the range of float32, and its relative error is
/// the same. A variance beyond float32 is stored as the largest float32.
///
/// Seen to catch: exit code 3 because of the variance, from 1e20 on.
#[test]
fn a_sun_of_any_strength_makes_the_same_picture() {
    let bench = Bench::new();
    let rendered = |strength: f64| {
        let scene = bench.slab("sun.gltf", |root| {
            root["extensions"]["KHR_lights_punctual"]["lights"][0]["intensity"] = strength.into();
        });
        bench.succeed("sample-surface", &[&scene, "-n", "500", "-o", "sun.cloud", "--quiet"]);
        let size = ["--width", "6", "--spp", "4", "-o", "sun.exr", "--stats", "sun.json", "--preview", "sun.png"];
        bench.succeed("gather", &[&["sun.cloud", &scene, "--medium", "marble", "--quiet"][..], &size].concat());
        let error = bench.json("sun.json")["estimated_relative_error"].as_f64().expect("a number");
        (bench.image("sun.exr"), error)
    };
    let (image, error) = rendered(1.0);
    let channel = |image: &formats::Image, name: &str| image.channel(name).expect("a channel").to_vec();
    for strength in [1e20, 1e25, 1e30] {
        let (strong, same_error) = rendered(strength);
        assert!((same_error / error - 1.0).abs() < 1e-3, "{strength:e}: {same_error} is not {error}");
        for (a, b) in channel(&image, "G").into_iter().zip(channel(&strong, "G")) {
            let ratio = f64::from(b) / f64::from(a) / strength;
            assert!(a > 0.0 && (ratio - 1.0).abs() < 1e-4, "{strength:e}: {b:e} is not {a:e}");
        }
        for (a, b) in channel(&image, "variance.G").into_iter().zip(channel(&strong, "variance.G")) {
            let expected = (f64::from(a) * strength * strength).min(f64::from(f32::MAX));
            assert!((f64::from(b) / expected - 1.0).abs() < 0.05, "{strength:e}: {b:e} is not {expected:e}");
        }
    }
}

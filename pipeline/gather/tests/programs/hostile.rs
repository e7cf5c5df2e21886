//! Forged clouds, checksums right: refused with one message, or rendered, in seconds and in little memory.

use crate::support::{Bench, Limits, data};
use formats::{
    atomic::Output,
    cloud::{self, Cloud, Content, Meta},
};
use std::time::{Duration, Instant};

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

/// What a forger may write, and whether it must be refused.
const FORGERIES: [(&str, bool, Change); 18] = [
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
    ("negative area", false, |p| p.meta.materials[0].area_m2 = -1.0),
    ("nodes that are not numbers", true, |p| p.content.nodes.iter_mut().for_each(|n| n.radius = f32::NAN)),
    ("negative flux", true, |p| p.content.nodes.iter_mut().for_each(|n| n.flux = -1.0)),
    ("flux of nodes without samples", false, |p| p.content.nodes.iter_mut().for_each(|n| n.flux = 1e30)),
    ("nodes without end", false, |p| p.content.nodes.iter_mut().for_each(|n| (n.spread, n.radius) = (1e38, 1e38))),
    ("samples far away", true, |p| p.content.tiles.iter_mut().flatten().for_each(|r| r.position = [3e38; 3])),
    ("samples of infinite light", true, |p| {
        p.content.tiles.iter_mut().flatten().for_each(|r| r.flux[0] = f32::INFINITY)
    }),
];

/// A cloud with five tiles in each half: their trees have room for eight, and nodes that hold nothing.
fn with_room(bench: &Bench, scene: &str) -> Parts {
    let drawn = |samples: u64| {
        bench.succeed("sample-surface", &[scene, "-n", &samples.to_string(), "-o", "good.cloud", "--quiet"]);
        Parts::read(bench, "good.cloud")
    };
    let fits = |parts: &Parts| parts.meta.materials[0].halves.iter().all(|half| half.tiles() == 5);
    (10..60).map(|k| drawn(10 * k)).find(fits).expect("one of so many numbers of samples")
}

/// Seen to catch: a pick from a node beyond the last sample, which ends the program by a panic.
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
        let message = String::from_utf8_lossy(&output.stderr).into_owned();
        let code = output.status.code();
        assert!(!message.contains("panicked"), "{what}: {message}");
        if refused {
            assert_eq!(code, Some(2), "{what}: {message}");
            assert!(message.contains("bad.cloud") && message.contains("sample"), "{what}: {message}");
        } else {
            // 3: numbers beyond float32.
            assert!([Some(0), Some(3)].contains(&code), "{what}: {code:?} {message}");
        }
        assert!(start.elapsed() < Duration::from_secs(20), "{what} takes {:?}", start.elapsed());
    }
}

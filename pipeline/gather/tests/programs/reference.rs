//! `--reference`: random walks instead of a BSSRDF.

use serde_json::Value;
use test_support::{Bench, Limits, data, glb::Asset};

fn walk(bench: &Bench, scene: &str, how: &[&str], output: &str) -> Vec<u8> {
    let own = ["own.cloud", scene, "--medium", "skin1", "--reference", "--quiet", "--no-timings", "-o", output];
    let size = ["--width", "12", "--height", "12", "--stats", "stats.json"];
    bench.succeed("gather", &[&own[..], &size, how].concat());
    bench.read(output)
}

/// The same bytes for any number of threads and any cloud of the scene, and counts of what happened.
#[test]
fn an_image_of_random_walks() {
    let bench = Bench::new();
    let (scene, view) = (data("scenes/sphere.glb"), data("views/sphere/front.json"));
    bench.succeed("sample-surface", &[&scene, "-n", "2k", "-o", "own.cloud", "--quiet"]);
    let first = walk(&bench, &scene, &["--view", &view, "--spp", "4", "-j", "1"], "one.exr");
    assert!(first == walk(&bench, &scene, &["--view", &view, "--spp", "4", "-j", "2"], "two.exr"));
    let stats: Value = serde_json::from_slice(&bench.read("stats.json")).expect("JSON");
    let count = |key: &str| stats[key].as_u64().expect(key);
    assert!(count("walks") > 100 && count("collisions") > count("walks") && count("connections") > 0, "{stats}");
    assert_eq!((count("walks_escaped"), count("gathers"), count("bssrdf_evaluations")), (0, 0, 0));
    assert_eq!(stats["estimated_relative_error_covers"], "camera paths and their walks");
    let image = bench.image("two.exr");
    let arguments = format!("{:?}", image.attributes["pcsss/arguments"]);
    assert!(arguments.contains("--reference --spp 4") && !arguments.contains("--bssrdf"), "{arguments}");
    // The target needs more than the first four paths.
    walk(&bench, &scene, &["--view", &view, "--target-error", "0.5"], "target.exr");
    let stats: Value = serde_json::from_slice(&bench.read("stats.json")).expect("JSON");
    assert!(stats["estimated_relative_error"].as_f64().is_some_and(|error| error < 0.5), "{stats}");
}

#[test]
fn options_of_the_sum_are_refused() {
    let bench = Bench::new();
    let scene = data("scenes/sphere.glb");
    for option in [["--bssrdf", "better-dipole"], ["--estimator", "cut"], ["--accuracy", "0.1"], ["--roulette", "min"]]
    {
        let run = bench.run("gather", &[&["own.cloud", &scene, "--reference", "-o", "x.exr"], &option[..]].concat());
        assert_eq!(run.code(), Some(2), "{option:?}");
        assert!(run.stderr.contains("--reference") && run.stderr.contains(option[0]), "{}", run.stderr);
    }
}

/// A mesh without an inside: one triangle, and a plane.
#[test]
fn open_meshes_are_refused() {
    let bench = Bench::new();
    let mut asset = Asset::new();
    let position = asset.vectors(&[[-0.1, -0.1, 0.0], [0.1, -0.1, 0.0], [0.0, 0.1, 0.0]]);
    asset.push("materials", serde_json::json!({ "name": "skin" }));
    asset.mesh(serde_json::json!({ "attributes": { "POSITION": position }, "material": 0 }));
    asset.node(serde_json::json!({ "mesh": 0 }));
    asset.light(
        serde_json::json!({ "type": "directional", "intensity": 1.0 }),
        serde_json::json!({ "translation": [0.0, 0.0, 1.0] }),
    );
    bench.write("flat.glb", asset.glb());
    let camera = r#"{"eye":[0,0,1],"target":[0,0,0],"up":[0,1,0],"yfov":20}"#;
    bench.write("camera.json", camera);
    bench.succeed("sample-surface", &["flat.glb", "-n", "1k", "-o", "own.cloud", "--quiet"]);
    let own = ["own.cloud", "flat.glb", "--medium", "skin1", "--reference", "--spp", "2", "--view", "camera.json"];
    let run = bench.run("gather", &[&own[..], &["--width", "8", "--height", "8", "-o", "x.exr"]].concat());
    assert_eq!(run.code(), Some(2), "{}", run.stderr);
    assert!(run.stderr.contains("through holes of the surface"), "{}", run.stderr);
    assert!(!bench.path("x.exr").exists());
}

/// A slab of which a few triangles are missing is refused by its first walks, although its image would take hours.
///
/// Seen to catch: the walks counted at the end alone.
#[test]
fn an_open_mesh_is_refused_before_the_work() {
    let bench = Bench::new();
    let open = bench.slab("open.gltf", |root| {
        let indices = root["meshes"][0]["primitives"][0]["indices"].as_u64().expect("an index") as usize;
        let count = root["accessors"][indices]["count"].as_u64().expect("a count");
        root["accessors"][indices]["count"] = (count / 2 / 3 * 3).into();
    });
    bench.succeed("sample-surface", &[&open, "-n", "1k", "-o", "own.cloud", "--quiet"]);
    let limits = Limits { kibibytes: 4 << 20, seconds: 20 };
    for (size, paths) in [("1024", "4096"), ("4", "1000000")] {
        for how in [["--spp", paths], ["--target-error", "1e-4"]] {
            let own =
                ["own.cloud", &open, "--medium", "skin1", "--reference", "--width", size, "-o", "x.exr", "-j", "1"];
            let run = bench.run_within(limits, "gather", &[&own[..], &how].concat());
            assert_eq!(run.code(), Some(2), "{size} {how:?}: {}", run.stderr);
            assert!(run.stderr.contains("through holes of the surface"), "{}", run.stderr);
        }
    }
    assert!(!bench.path("x.exr").exists());
}

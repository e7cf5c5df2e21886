//! `--orbit`: the images of a turntable.

use test_support::{Bench, data};

const SIZE: [&str; 6] = ["--width", "24", "--height", "24", "--spp", "2"];

/// Step 0 has the bytes of the image without `--orbit`, and every other step shows the image of a view file with the
/// same camera. Seen to catch: a turn the other way, and a turn by one step too many.
#[test]
fn each_step_is_the_image_of_a_camera_that_stands_there() {
    let bench = Bench::new();
    let scene = data("scenes/figure.glb");
    bench.succeed("sample-surface", &[&scene, "-n", "5k", "-o", "figure.cloud", "--quiet"]);
    let view = |eye: &str| format!(r#"{{"eye":{eye},"target":[0.002,0.028,0.002],"yfov":25}}"#);
    // A quarter of a turn about the target, from the front to the right.
    bench.write("front.json", view("[0.002,0.08,0.178]"));
    bench.write("right.json", view("[0.178,0.08,0.002]"));
    let gather = |view: &str, more: &[&str]| {
        let arguments = ["figure.cloud", &scene, "--medium", "skin1", "--view", view, "--no-timings", "--quiet"];
        bench.succeed("gather", &[&arguments[..], &SIZE, more].concat());
    };
    gather("front.json", &["-o", "front.exr", "--stats", "front-stats.json", "--preview", "front.png"]);
    gather("right.json", &["-o", "right.exr"]);
    gather("front.json", &["-o", "turn.exr", "--stats", "turn.json", "--preview", "turn.png", "--orbit", "4"]);
    let bytes = |name: &str| bench.read(name);
    assert_eq!(bytes("turn.0000.exr"), bytes("front.exr"));
    assert_eq!(bytes("turn.0000.png"), bytes("front.png"));
    assert_eq!(bytes("turn.0000.json"), bytes("front-stats.json"));
    // The turned camera differs from that of the view by rounding, which may change a path.
    let planes =
        ["turn.0001.exr", "right.exr"].map(|name| bench.image(name).channel("subsurface.G").map(<[f32]>::to_vec));
    let [turned, there] = planes.map(|plane| plane.expect("a layer"));
    let differ = turned.iter().zip(&there).filter(|(a, b)| (*a - *b).abs() > 1e-3 * b.abs()).count();
    assert!(differ < 6, "{differ} of {} pixels differ", there.len());
    for step in ["0001", "0002", "0003"] {
        assert!(bench.path(&format!("turn.{step}.png")).exists());
        assert_eq!(bench.json(&format!("turn.{step}.json"))["paths"], 2 * 24 * 24);
    }
    assert!(!bench.path("turn.exr").exists() && !bench.path("turn.0004.exr").exists());
}

/// A camera of the scene turns about the middle of the translucent surfaces, which stays in the middle of the image.
/// Seen to catch: a turn about the world's origin.
#[test]
fn a_camera_of_the_scene_turns_about_what_is_translucent() {
    let bench = Bench::new();
    let slab = bench.slab("far.gltf", |root| {
        // The slab is away from the world's origin, and the camera half a metre in front of its middle.
        root["nodes"][0]["translation"] = serde_json::json!([0.0, 0.0, -3.0]);
        let camera = root["nodes"].as_array().expect("nodes").iter().position(|n| !n["camera"].is_null()).expect("one");
        root["nodes"][camera]["translation"] = serde_json::json!([0.0, -0.025, -2.5]);
        root["nodes"][camera]["rotation"] = serde_json::json!([0.0, 0.0, 0.0, 1.0]);
    });
    bench.succeed("sample-surface", &[&slab, "-n", "5k", "-o", "slab.cloud", "--quiet"]);
    let arguments = ["slab.cloud", &slab, "--medium", "marble", "-o", "turn.exr", "--orbit", "2", "--quiet"];
    bench.succeed("gather", &[&arguments[..], &SIZE].concat());
    // From the other side the slab is at the same distance.
    let nearest = ["turn.0000.exr", "turn.0001.exr"].map(|name| {
        let image = bench.image(name);
        let depths = image.channel("Z").expect("a layer");
        depths.iter().filter(|z| **z > 0.0).fold(f32::INFINITY, |least, z| least.min(*z))
    });
    assert!(nearest[0].is_finite() && (nearest[0] - nearest[1]).abs() < 0.01, "{nearest:?}");
}

#[test]
fn an_orbit_without_steps_is_refused() {
    let bench = Bench::new();
    for count in ["0", "10001", "x"] {
        bench.refuses("gather", &["a.cloud", "a.glb", "-o", "a.exr", "--orbit", count], &["--orbit"]);
    }
}

//! Scenes without camera and light: a camera is made, a studio lights them, and previews expose themselves.

use serde_json::{Value, json};
use test_support::{Bench, data, glb::Asset};

/// The seated bear alone: without its floor, cameras and lights.
fn bare(bench: &Bench) -> &'static str {
    let bytes = std::fs::read(data("scenes/figure.glb")).expect("reads");
    let mut figure = Asset::read(&bytes);
    let is_figure = |node: &Value| node["mesh"] == json!(0);
    let nodes = figure.json["nodes"].as_array().expect("nodes");
    let index = nodes.iter().position(is_figure).expect("the figure");
    figure.json["scenes"][0]["nodes"] = json!([index]);
    bench.write("bare.glb", figure.glb());
    "bare.glb"
}

fn sample(bench: &Bench, more: &[&str]) -> String {
    bench.says("sample-surface", &[&["bare.glb", "-n", "2k", "-o", "bare.cloud"][..], more].concat())
}

const OWN: [&str; 6] = ["bare.cloud", "bare.glb", "--medium", "marble", "--spp", "2"];

fn gather(bench: &Bench, more: &[&str]) -> String {
    bench.says("gather", &[&OWN[..], more].concat())
}

/// The text between two others.
fn between<'a>(text: &'a str, start: &str, end: &str) -> &'a str {
    let rest = text.split_once(start).unwrap_or_else(|| panic!("{start}: {text}")).1;
    rest.split_once(end).unwrap_or_else(|| panic!("{end}: {text}")).0
}

/// The view that is said gives the same image. Seen to fail when the camera was not rounded as it is said.
#[test]
fn the_camera_that_is_made_is_said_and_can_be_kept() {
    let bench = Bench::new();
    let scene = bare(&bench);
    let said = sample(&bench, &[]);
    assert_eq!(said.matches("it is lit by --environment studio (").count(), 1, "{said}");
    let table = bench.succeed("gather", &["--list-cameras", scene]);
    let rows: Vec<&str> = table.lines().collect();
    assert!(rows[1].starts_with("0") && rows[1].contains("front") && rows[1].ends_with("- (made)"), "{table}");
    assert!(rows[2].starts_with("1") && rows[2].contains("backlit") && rows[3].starts_with("translucent"), "{table}");
    let size = ["--width", "24", "--height", "16", "--quiet"];
    for camera in ["front", "backlit", "index:1"] {
        let said = gather(&bench, &["--camera", camera, "--width", "24", "--height", "16", "-o", "made.exr"]);
        bench.write("kept.json", between(&said, "echo '", "'"));
        gather(&bench, &["--view", "kept.json", "--quiet", "-o", "kept.exr"]);
        assert!(bench.image("made.exr").channels == bench.image("kept.exr").channels, "{camera}: {said}");
        assert!(!said.contains("studio"), "the first program has said it: {said}");
    }
    let said = gather(&bench, &["--orbit", "3", "--width", "16", "-o", "turn.exr"]);
    assert_eq!(said.matches("seen by --camera front").count(), 1, "{said}");
    assert!(["0000", "0001", "0002"].iter().all(|k| bench.path(&format!("turn.{k}.exr")).exists()));
    bench.refuses("gather", &[&OWN[..], &size, &["--camera", "top", "-o", "x.exr"]].concat(), &["top", "`front`"]);
}

/// Each environment by its word, in both programs; the backdrop is seen alone, and surfaces still mirror what is hidden.
#[test]
fn built_in_environments_and_the_backdrop() {
    let bench = Bench::new();
    bare(&bench);
    sample(&bench, &["--environment", "sky", "--quiet"]);
    let own = ["--width", "24", "--quiet", "--exposure-fixed", "-o", "a.exr"];
    bench.refuses("gather", &[&OWN[..], &own].concat(), &["--environment"]);
    let lit = [&own[..], &["--environment", "sky"]].concat();
    let plane = |name: &str| bench.image("a.exr").channel(name).expect("a layer").to_vec();
    gather(&bench, &lit);
    let (open, mirrored) = (plane("emission.B"), plane("specular.B"));
    gather(&bench, &[&lit[..], &["--backdrop"]].concat());
    assert!(plane("specular.B") == mirrored);
    let (hidden, depth) = (plane("emission.B"), plane("Z"));
    assert!(hidden[0] == 0.06 && open[0] != 0.06 && depth[0] == 0.0, "{} {}", hidden[0], open[0]);
}

/// `--size` is the largest extent, of all programs alike. Seen to fail when gather took the file's unit.
#[test]
fn a_size_is_that_of_the_translucent_surfaces() {
    let bench = Bench::new();
    let scene = bare(&bench);
    let sized = ["--size", "0.5"];
    let list = |more: &[&str]| bench.succeed("sample-surface", &[&["--list-materials", scene], more].concat());
    let extent = |table: &str| {
        let sizes = between(table, "translucent surfaces: ", " m around");
        sizes.split(" x ").map(|x| x.parse::<f64>().expect("a number")).fold(0.0, f64::max)
    };
    assert!((extent(&list(&[])) - 0.5).abs() > 0.1 && (extent(&list(&sized)) - 0.5).abs() < 1e-4);
    sample(&bench, &[&sized[..], &["--quiet"]].concat());
    let own = ["--width", "16", "-o", "a.exr"];
    let said = gather(&bench, &[&own[..], &sized].concat());
    assert!(!said.contains("warning"), "{said}");
    bench.refuses("gather", &[&OWN[..], &own].concat(), &["--metres-per-unit"]);
    bench.refuses("gather", &[&OWN[..], &own, &sized, &["--metres-per-unit", "2"]].concat(), &["--size"]);
    // Where the medium makes no sense, a size is said at which it does.
    sample(&bench, &["--size", "200", "--quiet"]);
    let said = gather(&bench, &[&own[..], &["--size", "200"]].concat());
    let size = between(&said, "it will look opaque; --size ", " ");
    sample(&bench, &["--size", size, "--quiet"]);
    let said = gather(&bench, &[&own[..], &["--size", size]].concat());
    assert!(!said.contains("warning"), "{said}");
}

/// All views have one exposure, which the option adds to. What is nearly black is exposed as a dark gray is, and stays
/// dark. Seen to fail when the image itself was measured, and without that gray, which is worth three stops here.
#[test]
fn previews_expose_themselves_alike() {
    let bench = Bench::new();
    bare(&bench);
    sample(&bench, &["--quiet"]);
    let stops = |more: &[&str]| {
        let own = ["--width", "16", "--quiet", "-o", "a.exr", "--preview", "a.png", "--stats", "a.json"];
        gather(&bench, &[&own[..], more].concat());
        bench.json("a.json")["preview_stops"].as_f64().expect("a number")
    };
    let front = stops(&[]);
    assert!(front != 0.0 && front.abs() < 3.0, "{front}");
    assert_eq!((front, front), (stops(&["--camera", "backlit"]), stops(&["-j", "1", "--bssrdf", "standard-dipole"])));
    assert!((stops(&["--exposure", "-1.5"]) - front + 1.5).abs() < 1e-12);
    assert_eq!(stops(&["--exposure-fixed", "--exposure", "2"]), 2.0);
    let black = json!({ "name": "black", "unit": "1/mm", "sigma_a": [9, 9, 9], "sigma_s": [0.01, 0.01, 0.01] });
    bench.write("black.json", black.to_string());
    let own = ["bare.cloud", "bare.glb", "--medium", "black.json", "--spp", "2", "--width", "16", "--quiet"];
    let files = ["-o", "a.exr", "--preview", "a.png", "--stats", "a.json"];
    bench.succeed("gather", &[&own[..], &files].concat());
    let black = bench.json("a.json")["preview_stops"].as_f64().expect("a number");
    assert!(black > front + 2.0 && black < front + 4.0, "{front} {black}");
    // The light is brighter by a factor of four.
    sample(&bench, &["--environment-scale", "4", "--quiet"]);
    assert!((stops(&["--environment-scale", "4"]) - front + 2.0).abs() < 0.02);
}

//! Warnings of cameras that see nothing translucent or are inside a medium; counts of negative pixels; recommended
//! numbers of samples.

use cli::parse_count;
use serde_json::json;
use test_support::{Bench, data};

const NOTHING: &str = "sees no translucent surface";
const WITHIN: &str = "sees translucent surfaces from within";

fn sample(bench: &Bench, scene: &str, samples: &str) {
    bench.succeed("sample-surface", &[scene, "-n", samples, "-o", "a.cloud", "--quiet"]);
}

/// The messages of an image with so many pixels on a side, whose statistics are `stats.json`.
fn gather(bench: &Bench, scene: &str, side: &str, more: &[&str]) -> String {
    let own = ["a.cloud", scene, "-o", "a.exr", "--stats", "stats.json", "--width", side, "--height", side];
    bench.says("gather", &[&own[..], more].concat())
}

/// Seen to fail without a warning of a black image, or of one from within a medium, which shows no scattered light.
#[test]
fn a_camera_that_shows_nothing_translucent_or_stands_in_it_is_said() {
    let bench = Bench::new();
    let sphere = data("scenes/sphere.glb");
    sample(&bench, &sphere, "1k");
    let view =
        |name: &str, eye: &str, target: &str| format!(r#"{{"name":"{name}","eye":{eye},"target":{target},"yfov":24}}"#);
    let front = view("front", "[0,0,0.12]", "[0,0,0]");
    let views = [&front, &view("away", "[0,0,0.12]", "[0,0,9]"), &view("in", "[0,0.005,0]", "[0.3,0,0]")];
    bench.write("views.json", format!("[{},{},{}]", views[0], views[1], views[2]));
    let own = ["--medium", "skin1", "--spp", "2"];
    let said = gather(&bench, &sphere, "16", &[&own[..], &["--view", "views.json"]].concat());
    for (warning, prefix) in [(NOTHING, "warning: view away: the camera"), (WITHIN, "warning: view in: the camera")] {
        let lines: Vec<&str> = said.lines().filter(|line| line.contains(warning)).collect();
        assert!(lines.len() == 1 && lines[0].starts_with(prefix), "{warning}: {said}");
    }
    assert!(said.contains("(100 % of its paths to them)"), "{said}");
    let counted = |view: &str| {
        let stats = bench.json(&format!("stats.{view}.json"));
        ["paths", "paths_from_outside", "paths_from_inside"].map(|key| stats[key].as_u64().expect("a count"))
    };
    assert_eq!((counted("away"), counted("in")), ([512, 0, 0], [512, 0, 512]));
    let [paths, outside, inside] = counted("front");
    assert!((paths / 4..paths).contains(&outside) && inside == 0, "{outside} of {paths}, {inside}");
    // One crop shows only the background, the other does not.
    bench.write("front.json", front);
    let crop =
        |crop: &str| gather(&bench, &sphere, "16", &[&own[..], &["--view", "front.json", "--crop", crop]].concat());
    assert!(crop("0,0,1,1").contains("warning: --crop 0,0,1,1 of the camera sees no"));
    let said = crop("7,7,2,2");
    assert!(!said.contains(NOTHING) && !said.contains(WITHIN), "{said}");
}

/// Seen to fail when no pixel was counted, and when pixels were counted that are not negative in the file.
#[test]
fn pixels_below_zero_are_counted() {
    let bench = Bench::new();
    let sphere = data("scenes/sphere.glb");
    sample(&bench, &sphere, "2k");
    gather(&bench, &sphere, "160", &["--medium", "ketchup", "--spp", "2", "--estimator", "roulette"]);
    let image = bench.image("a.exr");
    let planes = ["R", "G", "B"].map(|name| image.channel(name).expect("beauty"));
    let below = (0..image.width * image.height).filter(|k| planes.iter().any(|plane| plane[*k] < 0.0)).count();
    assert!(below > 0, "there is none");
    assert_eq!(bench.json("stats.json")["negative_pixels"].as_u64(), Some(below as u64));
}

/// A cloud of the recommended number of samples has enough samples. Seen to fail when the factor was recommended
/// instead of the number, `1.2e1` for 12 times the cloud, and when only samples that carry light were counted.
#[test]
fn a_recommended_number_of_samples_is_enough() {
    let bench = Bench::new();
    let slab = data("scenes/slab.glb");
    let medium = r#"{"name":"thin","unit":"1/mm","sigma_a":[0,0,0],"sigma_s":[0.2,0.2,0.2],"source":"made up"}"#;
    bench.write("thin.json", medium);
    let said = |samples: &str| {
        sample(&bench, &slab, samples);
        gather(&bench, &slab, "8", &["--medium", "thin.json", "--spp", "1", "--estimator", "exhaustive"])
    };
    let first = said("1k");
    let (before, _) = first.split_once(" samples would do").expect("too few samples");
    let word = before.rsplit(' ').next().expect("a word");
    let number = parse_count(word).expect("a count") as f64;
    // There is one sample on each square of 5 mm; a third of the surface, the upper side of the slab, is lit.
    let least = 0.12 / 0.005f64.powi(2) * 3.0;
    assert!((0.8 * least..1.3 * least).contains(&number), "{word}: {first}");
    assert!(word.ends_with('k') && !said(word).contains("expect grain"), "{word}");
}

/// Every printed count can be parsed again. Seen to fail with `1.807e4 BSSRDF evaluations` and `1000000 samples`.
#[test]
fn counts_are_printed_as_they_are_written() {
    let bench = Bench::new();
    let sphere = data("scenes/sphere.glb");
    let sampled = bench.says("sample-surface", &[&sphere, "-n", "20000", "-o", "a.cloud"]);
    assert!(sampled.contains("sampling: 20k samples") && sampled.contains(" of 20k samples carry light"), "{sampled}");
    let said = gather(&bench, &sphere, "16", &["--medium", "skin1", "--target-error", "0.001"]);
    let before = |text: &str, unit: &str| {
        let (before, _) = text.split_once(unit).unwrap_or_else(|| panic!("{unit}: {text}"));
        before.rsplit([' ', '\n']).next().expect("a word").to_owned()
    };
    let words = [before(&said, " gathers"), before(&said, " BSSRDF evaluations"), before(&said, " paths")];
    let needed = said.split_once("with --samples ").expect("the cloud is too small").1;
    for word in words.into_iter().chain(needed.lines().next().map(str::to_owned)) {
        assert!(parse_count(&word).is_ok_and(|n| n > 0) && !word.contains('e'), "{word}: {said}");
    }
}

/// Seen to fail when more samples were recommended for a surface that no light reaches.
#[test]
fn a_surface_without_light_wants_no_samples() {
    let bench = Bench::new();
    let scene = bench.slab("dark.gltf", |root| {
        let mut below = root["materials"][0].clone();
        below["name"] = json!("Below");
        root["materials"].as_array_mut().expect("a list").push(below);
        let mut mesh = root["meshes"][0].clone();
        mesh["primitives"][0]["material"] = json!(1);
        root["meshes"].as_array_mut().expect("a list").push(mesh);
        root["nodes"].as_array_mut().expect("a list").push(json!({ "mesh": 1, "translation": [0, -1, 0] }));
        root["scenes"][0]["nodes"] = json!([0, 1, 2, 3]);
        root["extensions"]["KHR_lights_punctual"]["lights"][0] = json!({ "type": "point", "intensity": 1 });
    });
    sample(&bench, &scene, "100");
    let said = gather(&bench, &scene, "8", &["--medium", "marble", "--spp", "1", "--estimator", "exhaustive"]);
    assert!(said.contains("`Slab`: samples lie") && !said.contains("`Below`: samples lie"), "{said}");
    assert!(said.contains("warning: `Below`: none of its samples carries light"), "{said}");
}

//! A word that may mean more than one camera or material of a scene is refused, with the indices to choose from.

use formats::{Attribute, cloud::Cloud};
use serde_json::{Value, json};
use std::{fs, path::Path, process::Command};
use test_support::{Bench, Run, program};

/// The slab under cameras of these names and nodes, which look down from 0.3 m, 0.5 m and so on.
fn under_cameras(bench: &Bench, cameras: &[[&str; 2]]) -> String {
    bench.slab("cameras.gltf", |root| {
        let (mut camera, node) = (root["cameras"][0].clone(), root["nodes"][2].clone());
        // make gives no size, which makes 512 x 8 pixels.
        camera["perspective"]["aspectRatio"] = json!(64);
        root["cameras"] = json!([]);
        root["nodes"].as_array_mut().expect("a list").truncate(2);
        for (k, [name, carrier]) in cameras.iter().enumerate() {
            let mut own = [camera.clone(), node.clone()];
            own[0]["name"] = json!(name);
            own[1]["name"] = json!(carrier);
            own[1]["camera"] = json!(k);
            own[1]["translation"] = json!([0, height(k), 0]);
            let [camera, node] = own;
            root["cameras"].as_array_mut().expect("a list").push(camera);
            root["nodes"].as_array_mut().expect("a list").push(node);
        }
        root["scenes"][0]["nodes"] = (0..2 + cameras.len()).collect();
    })
}

fn height(camera: usize) -> f64 {
    0.3 + 0.2 * camera as f64
}

fn sample(bench: &Bench, scene: &str) {
    bench.succeed("sample-surface", &[scene, "-n", "500", "-o", "slab.cloud", "--quiet"]);
}

/// The word for the camera that `more` chooses, as the header of the image has it, and the index of the camera at its
/// height.
fn seen(bench: &Bench, scene: &str, more: &[&str]) -> (String, Option<usize>) {
    let own = ["slab.cloud", scene, "--medium", "marble", "-o", "seen.exr", "--quiet", "--spp", "1"];
    bench.succeed("gather", &[&own[..], &["--width", "4", "--height", "4"], more].concat());
    let image = bench.image("seen.exr");
    let Some(Attribute::Text(arguments)) = image.attributes.get("pcsss/arguments") else {
        panic!("no arguments in the header")
    };
    let camera = arguments.split(" --width").next().expect("the first").to_owned();
    let depth = f64::from(image.channel("Z").expect("depths")[0]);
    (camera, (0..9).find(|k| (depth - height(*k)).abs() < 1e-3))
}

/// Seen to fail when names were looked up before indices and the first camera of a name was taken: both `1` and `Both`
/// were the first camera.
#[test]
fn a_word_for_more_than_one_camera_is_refused() {
    let bench = Bench::new();
    let scene = under_cameras(&bench, &[["1", "A"], ["2", "Both"], ["3", "C"], ["Both", "D"], ["E", "4"]]);
    sample(&bench, &scene);
    let refuses = |word: &str, words: &[&str]| {
        let own = ["slab.cloud", &scene, "--medium", "marble", "-o", "no.exr", "--camera", word];
        bench.refuses("gather", &own, &[&["--camera", word, "cameras.gltf"], words].concat());
    };
    refuses("1", &["index:0 (`1` of node `A` at 0.0000 0.3000 0.0000 m)", "index:1 (`2` of node `Both`"]);
    refuses("2", &["index:1 (`2`", "index:2 (`3`"]);
    refuses("3", &["index:2 (`3`", "index:3 (`Both`"]);
    refuses("Both", &["index:1 (`2` of node `Both` at 0.0000 0.5000", "index:3 (`Both` of node `D` at 0.0000 0.9000"]);
    refuses("5", &["has no `5`", "`Both`"]);
    refuses("index:5", &["has no `index:5`"]);
    for (word, camera, said) in [
        ("0", 0, "index:0"),
        ("4", 4, "E"),
        ("A", 0, "index:0"),
        ("D", 3, "index:3"),
        ("E", 4, "E"),
        ("index:1", 1, "index:1"),
        ("index:4", 4, "E"),
    ] {
        let expected = (format!("--camera {said}"), Some(camera));
        assert_eq!(seen(&bench, &scene, &["--camera", word]), expected, "{word}");
    }
    assert_eq!(seen(&bench, &scene, &[]), ("--camera index:0".into(), Some(0)));
    let table = bench.succeed("gather", &["--list-cameras", &scene]);
    assert!(table.lines().nth(2).is_some_and(|line| line.starts_with("1  ") && line.ends_with("  Both")), "{table}");
}

/// A camera on two nodes is two cameras. Seen to fail when the first was taken.
#[test]
fn a_camera_on_two_nodes_is_two_cameras() {
    let bench = Bench::new();
    let scene = under_cameras(&bench, &[["Camera", "Left"], ["Camera", "Right"]]);
    sample(&bench, &scene);
    let own = ["slab.cloud", &scene, "--medium", "marble", "-o", "no.exr", "--camera", "Camera"];
    bench.refuses("gather", &own, &["`Camera`", "index:0", "`Left`", "index:1", "`Right`"]);
    assert_eq!(seen(&bench, &scene, &["--camera", "Right"]), ("--camera index:1".into(), Some(1)));
}

/// Seen to fail when make gave the bare index: 1 and 2 were names of other cameras.
#[test]
fn make_renders_each_camera_by_its_index() {
    if Command::new("make").arg("--version").output().is_err() {
        println!("skipped: make is not installed");
        return;
    }
    let bench = Bench::new();
    let scene = under_cameras(&bench, &[["1", "A"], ["2", "B"], ["0", "C"]]);
    fs::create_dir_all(bench.path("crates/formats")).expect("makes");
    ["cloud", "calibration"].iter().for_each(|of| _ = bench.write(&format!("crates/formats/{of}-version"), "1"));
    let makefile = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../Makefile");
    let bin = format!("BIN={}", program("gather").parent().expect("a folder").display());
    let mut make = Command::new("make");
    make.current_dir(bench.folder()).arg("-f").arg(makefile).arg(bin).arg(format!("SCENE={scene}"));
    make.env_remove("MAKEFLAGS").env_remove("MAKELEVEL");
    let output = Run::of(make.args(["CARGO=true", "THREADS=1", "SAMPLES=500", "SPP=1", "WALKS=200", "MEDIUM=marble"]));
    assert!(output.status.success(), "{}", output.stderr);
    for camera in 0..3 {
        let image = bench.image(&format!("out/cameras/k500-s0/marble-half-space/camera{camera}.exr"));
        let middle = image.width * image.height / 2 + image.width / 2;
        let depth = f64::from(image.channel("Z").expect("depths")[middle]);
        assert!((depth - height(camera)).abs() < 1e-3, "camera {camera}: {depth}");
    }
}

/// The slab, and another of twice its size below it, whose materials have the same name.
fn two_of_one_name(root: &mut Value) {
    // With transmission the file would give both a medium, clear glass.
    root["materials"][0]["extensions"]["KHR_materials_transmission"] = json!({ "transmissionFactor": 0 });
    let material = root["materials"][0].clone();
    root["materials"].as_array_mut().expect("a list").push(material);
    let mut mesh = root["meshes"][0].clone();
    mesh["primitives"][0]["material"] = json!(1);
    root["meshes"].as_array_mut().expect("a list").push(mesh);
    let node = json!({ "mesh": 1, "translation": [0, -1, 0], "scale": [2, 2, 2] });
    root["nodes"].as_array_mut().expect("a list").push(node);
    root["scenes"][0]["nodes"] = json!([0, 1, 2, 3]);
}

fn with<'a>(own: &[&'a str], more: &[&'a str]) -> Vec<&'a str> {
    [own, more].concat()
}

/// Seen to fail when `--translucent` and `--medium` took both and `--share` the first.
#[test]
fn a_word_for_more_than_one_material_is_refused() {
    let bench = Bench::new();
    let scene = bench.slab("two.gltf", two_of_one_name);
    let cloud = [scene.as_str(), "-n", "2k", "-o", "two.cloud", "--quiet"];
    let words = ["`Slab`", "index:0 (`Slab`, 1.2000e-1 m2)", "index:1 (`Slab`, 4.8000e-1 m2)"];
    let refuses = |more: &[&str]| bench.refuses("sample-surface", &with(&cloud, more), &[&more[..1], &words].concat());
    refuses(&["--translucent", "Slab"]);
    refuses(&["--share", "Slab=0.5"]);
    let sampled = |more: &[&str]| {
        bench.succeed("sample-surface", &with(&cloud, more));
        let cloud = Cloud::open(&bench.path("two.cloud")).expect("a cloud");
        let samples = |m: &formats::cloud::SampledMaterial| m.halves.iter().map(|half| half.samples).sum();
        cloud.meta().materials.iter().map(|m| (m.index, samples(m))).collect::<Vec<(u16, u64)>>()
    };
    let only = sampled(&["--translucent", "index:1"]);
    assert!(only.len() == 1 && only[0].0 == 1, "{only:?}");
    // As many samples of each slab face the sun; by area the ratio would be one to four.
    let even = sampled(&["--share", "index:1=0.5"]);
    let ratio = even[1].1 as f64 / even[0].1 as f64;
    assert!(even.len() == 2 && (0.8..1.25).contains(&ratio), "{even:?}");

    let image = ["two.cloud", &scene, "-o", "two.exr", "--width", "4", "--height", "4", "--spp", "1"];
    bench.refuses("gather", &with(&image, &["--medium", "Slab=marble"]), &[&["--medium"], &words[..]].concat());
    bench.refuses("gather", &with(&image, &["--medium", "index:0=marble"]), &["--medium index:1=NAME"]);
    bench.refuses("gather", &with(&image, &["--medium", "index:0=marble", "--medium", "index:0=skin1"]), &["twice"]);
    bench.refuses("gather", &with(&image, &["--medium", "index:2=marble"]), &["`index:2`", "`Slab`"]);
    bench.succeed("gather", &with(&image, &["--medium", "index:1=skin1", "--medium", "index:0=marble"]));
    let Some(Attribute::Texts(media)) = bench.image("two.exr").attributes.get("pcsss/media").cloned() else {
        panic!("no media in the header")
    };
    assert!(media[0].starts_with("Slab=marble") && media[1].starts_with("Slab=skin1"), "{media:?}");
    bench.succeed("gather", &with(&image, &["--medium", "marble"]));
}

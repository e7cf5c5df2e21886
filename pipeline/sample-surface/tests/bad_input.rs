//! Bad input of every kind is refused with exit code 2 and one message that names the file, the field and the way out;
//! no file is written.

use serde_json::{Value, json};
use std::{fs, path::Path};
use test_support::{Bench, data, glb::Asset};

const PROGRAM: &str = "sample-surface";

/// The refusal of a scene, on one line.
#[track_caller]
fn refuses(bench: &Bench, scene: &str, words: &[&str]) {
    let message = bench.refuses(PROGRAM, &[scene, "-n", "1000", "-o", "out.cloud", "--quiet"], words);
    assert_eq!(message.lines().count(), 1, "{message}");
}

#[test]
fn files_that_are_no_scenes() {
    let bench = Bench::new();
    refuses(&bench, "missing.glb", &["missing.glb", "No such file"]);
    bench.write("text.glb", "hello");
    refuses(&bench, "text.glb", &["text.glb", "not a glTF file"]);
    bench.write("empty.gltf", "");
    refuses(&bench, "empty.gltf", &["empty.gltf", "not a glTF file"]);
    let whole = fs::read(data("scenes/slab.glb")).expect("reads");
    for length in [5, 11, 30, 1000, whole.len() - 1] {
        bench.write("cut.glb", &whole[..length]);
        refuses(&bench, "cut.glb", &["cut.glb", "trunc"]);
    }
    refuses(&bench, ".", &["."]);
}

#[test]
fn scenes_with_bad_accessors() {
    let bench = Bench::new();
    let scene = bench.slab("scene.glb", |root| root["accessors"][0]["count"] = json!(999_999_999));
    refuses(&bench, &scene, &["scene.glb", "fit"]);
    let scene =
        bench.slab("scene.glb", |root| root["meshes"][0]["primitives"][0]["attributes"]["POSITION"] = json!(77));
    refuses(&bench, &scene, &["scene.glb", "POSITION", "77"]);
    let scene = bench.slab("scene.glb", |root| root["meshes"][0]["primitives"][0]["indices"] = json!(77));
    refuses(&bench, &scene, &["scene.glb", "indices", "77"]);
    let scene = bench.slab("scene.glb", |root| root["nodes"][0]["children"] = json!([0]));
    refuses(&bench, &scene, &["scene.glb", "tree"]);
}

#[test]
fn a_position_that_is_not_a_number() {
    let bench = Bench::new();
    let mut slab = Asset::read(&fs::read(data("scenes/slab.glb")).expect("reads"));
    let accessor =
        slab.json["meshes"][0]["primitives"][0]["attributes"]["POSITION"].as_u64().expect("an index") as usize;
    let view = slab.json["accessors"][accessor]["bufferView"].as_u64().expect("an index") as usize;
    let offset = slab.json["bufferViews"][view]["byteOffset"].as_u64().unwrap_or(0) as usize;
    slab.binary[offset + 12..offset + 16].copy_from_slice(&f32::NAN.to_le_bytes());
    bench.write("nan.glb", slab.glb());
    refuses(&bench, "nan.glb", &["nan.glb", "POSITION", "not finite"]);
}

#[test]
fn scenes_without_what_is_needed() {
    let bench = Bench::new();
    let scene = bench.slab("scene.glb", |root| root["meshes"][0]["primitives"] = json!([]));
    refuses(&bench, &scene, &["scene.glb", "no triangles"]);
    let scene = bench.slab("scene.glb", |root| {
        for node in root["nodes"].as_array_mut().expect("nodes") {
            node.as_object_mut().expect("an object").remove("extensions");
        }
    });
    let dark = [&scene, "-n", "10", "-o", "out.cloud", "--environment", "0,0,0"];
    bench.refuses(PROGRAM, &dark, &["scene.glb", "no light", "--environment"]);
    let scene = bench.slab("scene.glb", |_| {});
    let named = [&scene, "-n", "10", "-o", "out.cloud", "--translucent", "Glass"];
    bench.refuses(PROGRAM, &named, &["--translucent", "`Glass`", "`Slab`"]);
    for (share, words) in [
        ("Glass=0.5", ["--share", "`Glass`", "there are `Slab`"]),
        ("Slab=0.5", ["--share", "0.5 in all", "1 is needed"]),
        ("Slab=0", ["--share", "between 0 and 1", "Slab=0"]),
        ("Slab=NaN", ["--share", "between 0 and 1", "Slab=NaN"]),
        ("Slab", ["--share", "MATERIAL=F", "Slab"]),
    ] {
        bench.refuses(PROGRAM, &[&scene, "-n", "10", "-o", "out.cloud", "--share", share], &words);
    }
    let scene = bench.slab("scene.glb", |root| {
        let first = root["materials"][0].clone();
        root["materials"].as_array_mut().expect("a list").push(first);
        root["materials"][1]["name"] = json!("Lid");
        let mut lid = root["meshes"][0]["primitives"][0].clone();
        lid["material"] = json!(1);
        root["meshes"][0]["primitives"].as_array_mut().expect("a list").push(lid);
    });
    let shares = |second: &str, words: &[&str]| {
        bench.refuses(PROGRAM, &[&scene, "-o", "out.cloud", "--share", "Slab=0.7", "--share", second], words);
    };
    shares("Slab=0.2", &["--share", "`Slab` has two"]);
    shares("Lid=0.7", &["--share", "1.4 in all", "1 is needed"]);
}

#[test]
fn features_that_are_not_supported_are_named() {
    let bench = Bench::new();
    for extension in ["KHR_node_visibility", "VENDOR_thing"] {
        let scene = bench.slab("scene.glb", |root| {
            root["extensionsRequired"] = json!([extension]);
            root["extensionsUsed"].as_array_mut().expect("a list").push(json!(extension));
        });
        refuses(&bench, &scene, &["scene.glb", extension, "export again"]);
    }
    let scene = bench.slab("scene.glb", |_| {});
    let posed = [&scene, "-n", "10", "-o", "out.cloud", "--animation", "Spin"];
    bench.refuses(PROGRAM, &posed, &["scene.glb", "no animation `Spin`", "has none", "--animation NAME", "--time"]);
    bench.refuses(PROGRAM, &[&scene, "-n", "10", "-o", "out.cloud", "--time=-1"], &["--time", "zero or more"]);
}

#[test]
fn usage_errors() {
    let bench = Bench::new();
    let scene = bench.slab("scene.glb", |_| {});
    bench.refuses(PROGRAM, &[&scene, "-o", "out.cloud", "-n", "0"], &["--samples", "at least one"]);
    bench.refuses(PROGRAM, &[&scene, "-o", "out.cloud", "-n", "many"], &["--samples", "250k"]);
    bench.refuses(PROGRAM, &[&scene, "-o", "out.cloud", "-n", "1e15"], &["--samples", "fewer"]);
    bench.refuses(PROGRAM, &[&scene, "-o", "out.cloud", "-n", "8e9"], &["--samples", "memory"]);
    bench.refuses(
        PROGRAM,
        &[&scene, "-o", "out.cloud", "--pattern", "random"],
        &["--pattern", "stratified", "independent"],
    );
    bench.refuses(PROGRAM, &[&scene, "-o", "out.cloud", "--sample-count", "3"], &["--sample-count"]);
    bench.refuses(PROGRAM, &[&scene], &["--output"]);
    bench.refuses(PROGRAM, &[&scene, "-o", "out.cloud", "--environment", "1,-1,1"], &["--environment"]);
    bench.refuses(
        PROGRAM,
        &[&scene, "-o", "out.cloud", "--environment", "sky.exr"],
        &["--environment", "sky.exr", "cannot read"],
    );
    bench.refuses(PROGRAM, &[&scene, "-o", "out.cloud", "--metres-per-unit", "0"], &["--metres-per-unit"]);
    let huge = ["too large for float32 coordinates", "set --metres-per-unit"];
    bench.refuses(PROGRAM, &[&scene, "-o", "out.cloud", "--metres-per-unit", "1e20"], &huge);
    bench.refuses(PROGRAM, &[&scene, "-o", "out.cloud", "-j", "0"], &["--threads"]);
}

#[test]
fn outputs_that_cannot_be_written() {
    let bench = Bench::new();
    let scene = bench.slab("scene.glb", |_| {});
    bench.refuses(PROGRAM, &[&scene, "-n", "10", "-o", "no/such/folder/out.cloud"], &["no/such/folder/out.cloud"]);
    bench.refuses(PROGRAM, &[&scene, "-n", "10", "-o", "."], &["cannot write", "folder"]);
    if Path::new("/dev/full").exists() {
        bench.refuses(PROGRAM, &[&scene, "-n", "1000", "-o", "/dev/full", "--quiet"], &["/dev/full", "No space left"]);
    }
}

#[test]
fn an_up_to_date_cloud_is_kept_and_a_damaged_one_is_made_again() {
    let bench = Bench::new();
    let scene = bench.slab("scene.glb", |_| {});
    let arguments = [&scene, "-n", "1000", "-o", "out.cloud", "--stats", "stats.json"];
    let kept = |bench: &Bench| {
        bench.succeed(PROGRAM, &arguments);
        let stats = bench.json("stats.json");
        stats["kept"].as_bool().expect("a flag")
    };
    assert!(!kept(&bench));
    let first = bench.read("out.cloud");
    assert!(kept(&bench));
    let mut damaged = first.clone();
    let middle = damaged.len() / 2;
    damaged[middle] ^= 1;
    bench.write("out.cloud", damaged);
    assert!(!kept(&bench));
    assert_eq!(bench.read("out.cloud"), first, "the same bytes again");
    bench.succeed(PROGRAM, &[&scene, "-n", "1000", "-o", "out.cloud", "--seed", "1"]);
    assert_ne!(bench.read("out.cloud"), first, "another seed, another cloud");
}

#[test]
fn the_cloud_is_the_same_for_any_number_of_threads_and_the_ply_holds_all_of_it() {
    let bench = Bench::new();
    let scene = bench.slab("scene.glb", |_| {});
    for (threads, name) in [("1", "one.cloud"), ("2", "two.cloud")] {
        bench.succeed(PROGRAM, &[&scene, "-n", "40k", "-o", name, "-j", threads, "--ply", "cloud.ply"]);
    }
    let read = |name: &str| bench.read(name);
    assert_eq!(read("one.cloud"), read("two.cloud"));
    let ply = read("cloud.ply");
    let end = ply.windows(11).position(|w| w == b"end_header\n").expect("a header") + 11;
    let header = String::from_utf8_lossy(&ply[..end]).into_owned();
    let count: usize =
        header.lines().find_map(|l| l.strip_prefix("element vertex ")).expect("a count").parse().expect("a number");
    assert!(count > 1000);
    assert_eq!(ply.len() - end, count * 12 * 4);
}

/// Adds a plate with a material that is no volume: the mesh of the slab, beside it.
fn add_plate(root: &mut Value) {
    let mut mesh = root["meshes"][0].clone();
    mesh["primitives"][0]["material"] = json!(1);
    for (list, item) in [("materials", json!({ "name": "Plate" })), ("meshes", mesh)] {
        root[list].as_array_mut().expect("a list").push(item);
    }
    root["nodes"].as_array_mut().expect("a list").push(json!({ "mesh": 1, "translation": [1, 0, 0] }));
    let node = root["nodes"].as_array().map_or(0, Vec::len) - 1;
    root["scenes"][0]["nodes"].as_array_mut().expect("a list").push(json!(node));
}

/// The only surface that is marked as a volume is scaled to nothing. No other surface becomes translucent instead
/// unless it is named, and the list of materials agrees. Details: `import_volumes`.
///
/// Seen to fail: a cloud of the plate.
#[test]
fn marked_surfaces_that_are_lost_are_an_error() {
    let bench = Bench::new();
    let scene = bench.slab("scene.glb", |root| {
        add_plate(root);
        root["nodes"][0]["scale"] = json!([0, 0, 0]);
    });
    refuses(&bench, &scene, &["scene.glb", "`Slab`", "no area", "--translucent"]);
    let table = bench.succeed(PROGRAM, &[&scene, "--list-materials"]);
    let row = |name: &str| table.lines().find(|line| line.contains(name)).expect("a row").to_owned();
    assert!(row("Slab").contains("translucent, no triangle left") && row("Plate").contains("opaque"), "{table}");
    bench.succeed(PROGRAM, &[&scene, "-n", "1000", "-o", "out.cloud", "--translucent", "Plate"]);
}

/// A duplicated mesh is sampled once; `--strict` refuses it nevertheless. Details: `copies`.
///
/// Seen to fail: a cloud of twice the area.
#[test]
fn a_mesh_that_is_there_twice_takes_in_its_light_once() {
    let bench = Bench::new();
    let flux = |scene: &str, words: &[&str]| {
        let said = bench.says(PROGRAM, &[scene, "-n", "1000", "-o", "out.cloud", "--stats", "stats.json"]);
        assert!(words.iter().all(|word| said.contains(word)), "{said}");
        let stats = bench.json("stats.json");
        [stats["surface_area_m2"].clone(), stats["mean_flux_w"].clone()]
    };
    let once = flux(&bench.slab("scene.glb", |_| {}), &[]);
    assert!(once.iter().all(|value| !value.is_null()));
    let twice = bench.slab("scene.glb", |root| {
        let again = root["meshes"][0]["primitives"][0].clone();
        root["meshes"][0]["primitives"].as_array_mut().expect("a list").push(again);
    });
    assert_eq!(flux(&twice, &["6144 triangles lie exactly on others", "6144 duplicate triangles"]), once);
    bench.refuses(
        PROGRAM,
        &[&twice, "-n", "1000", "-o", "no.cloud", "--strict"],
        &["6144 duplicate triangles", "--strict"],
    );
}

/// The program names in one line what a file asks for and it does not do. Details: `unhonoured`.
#[test]
fn what_is_not_honoured_is_said_once() {
    let bench = Bench::new();
    let scene = bench.slab("scene.glb", |root| {
        root["materials"][0]["occlusionTexture"] = json!({ "index": 0 });
        root["materials"][0]["pbrMetallicRoughness"]["metallicFactor"] = json!(0.5);
        root["fog"] = json!(1);
    });
    let said = bench.says(PROGRAM, &[&scene, "-n", "1000", "-o", "out.cloud"]);
    let lines: Vec<&str> = said.lines().filter(|line| line.contains("warning")).collect();
    let [line] = lines[..] else { panic!("{said}") };
    for word in
        ["scene.glb: not honoured: ", "materials[].occlusionTexture (`Slab`)", "taken as 0", "fog; docs/scenes.md"]
    {
        assert!(line.contains(word), "{word}: {line}");
    }
}

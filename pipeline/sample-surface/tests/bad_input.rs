//! Bad input of every kind: one message that names file, field and way out, exit 2, nothing written.

use serde_json::{Value, json};
use std::{
    fs,
    path::{Path, PathBuf},
    process::{Command, Output},
};

/// A folder to work in, and the program.
struct Bench {
    folder: tempfile::TempDir,
}

impl Bench {
    fn new() -> Bench {
        Bench { folder: tempfile::tempdir().expect("a temporary folder") }
    }

    fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    fn run(&self, arguments: &[&str]) -> Output {
        let mut command = Command::new(env!("CARGO_BIN_EXE_sample-surface"));
        command.current_dir(self.folder.path()).args(arguments).output().expect("the program starts")
    }

    /// The generated slab with its JSON changed.
    fn scene(&self, change: impl FnOnce(&mut Value)) -> String {
        let slab = fs::read(slab()).expect("data/scenes/slab.glb");
        let size = u32::from_le_bytes(slab[12..16].try_into().expect("four bytes")) as usize;
        let mut root: Value = serde_json::from_slice(&slab[20..20 + size]).expect("JSON");
        change(&mut root);
        let mut text = root.to_string().into_bytes();
        text.resize(text.len().next_multiple_of(4), b' ');
        let mut glb = b"glTF\x02\0\0\0".to_vec();
        glb.extend((slab.len() - size + text.len()).to_le_bytes()[..4].iter());
        glb.extend((text.len() as u32).to_le_bytes());
        glb.extend(b"JSON");
        glb.extend(&text);
        glb.extend(&slab[20 + size..]);
        fs::write(self.path("scene.glb"), glb).expect("writes");
        "scene.glb".into()
    }

    /// Runs on a scene and demands a refusal that says all of `words`.
    fn refuses(&self, arguments: &[&str], words: &[&str]) {
        let before = self.files();
        let output = self.run(arguments);
        let message = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(2), "{arguments:?}: {message}");
        assert!(output.stdout.is_empty(), "{arguments:?} wrote to stdout");
        for word in words {
            assert!(message.contains(word), "{arguments:?}: `{word}` is not in: {message}");
        }
        assert!(!message.contains("panicked"), "{message}");
        assert_eq!(self.files(), before, "{arguments:?} left files behind");
    }

    /// As [`Bench::refuses`], for a scene of one line's message.
    fn refuses_scene(&self, scene: &str, words: &[&str]) {
        self.refuses(&[scene, "-n", "1000", "-o", "out.cloud", "--quiet"], words);
        let output = self.run(&[scene, "-n", "1000", "-o", "out.cloud", "--quiet"]);
        assert_eq!(String::from_utf8_lossy(&output.stderr).lines().count(), 1, "one message");
    }

    fn files(&self) -> Vec<PathBuf> {
        let entries = fs::read_dir(self.folder.path()).expect("lists");
        let mut files: Vec<PathBuf> = entries.map(|e| e.expect("an entry").path()).collect();
        files.sort();
        files
    }
}

fn slab() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../data/scenes/slab.glb")
}

#[test]
fn files_that_are_no_scenes() {
    let bench = Bench::new();
    bench.refuses_scene("missing.glb", &["missing.glb", "No such file"]);
    fs::write(bench.path("text.glb"), "hello").expect("writes");
    bench.refuses_scene("text.glb", &["text.glb", "not a glTF file"]);
    fs::write(bench.path("empty.gltf"), "").expect("writes");
    bench.refuses_scene("empty.gltf", &["empty.gltf", "not a glTF file"]);
    let whole = fs::read(slab()).expect("reads");
    for length in [5, 11, 30, 1000, whole.len() - 1] {
        fs::write(bench.path("cut.glb"), &whole[..length]).expect("writes");
        bench.refuses_scene("cut.glb", &["cut.glb", "trunc"]);
    }
    bench.refuses_scene(".", &["."]);
}

#[test]
fn scenes_with_bad_accessors() {
    let bench = Bench::new();
    let scene = bench.scene(|root| root["accessors"][0]["count"] = json!(999_999_999));
    bench.refuses_scene(&scene, &["scene.glb", "fit"]);
    let scene = bench.scene(|root| root["meshes"][0]["primitives"][0]["attributes"]["POSITION"] = json!(77));
    bench.refuses_scene(&scene, &["scene.glb", "POSITION", "77"]);
    let scene = bench.scene(|root| root["meshes"][0]["primitives"][0]["indices"] = json!(77));
    bench.refuses_scene(&scene, &["scene.glb", "indices", "77"]);
    let scene = bench.scene(|root| root["nodes"][0]["children"] = json!([0]));
    bench.refuses_scene(&scene, &["scene.glb", "tree"]);
}

#[test]
fn a_position_that_is_not_a_number() {
    let bench = Bench::new();
    let mut bytes = fs::read(slab()).expect("reads");
    let size = u32::from_le_bytes(bytes[12..16].try_into().expect("four bytes")) as usize;
    let root: Value = serde_json::from_slice(&bytes[20..20 + size]).expect("JSON");
    let accessor = root["meshes"][0]["primitives"][0]["attributes"]["POSITION"].as_u64().expect("an index") as usize;
    let view = root["accessors"][accessor]["bufferView"].as_u64().expect("an index") as usize;
    let offset = root["bufferViews"][view]["byteOffset"].as_u64().unwrap_or(0) as usize;
    let at = 20 + size + 8 + offset + 12;
    bytes[at..at + 4].copy_from_slice(&f32::NAN.to_le_bytes());
    fs::write(bench.path("nan.glb"), bytes).expect("writes");
    bench.refuses_scene("nan.glb", &["nan.glb", "POSITION", "not finite"]);
}

#[test]
fn scenes_without_what_is_needed() {
    let bench = Bench::new();
    let scene = bench.scene(|root| root["meshes"][0]["primitives"] = json!([]));
    bench.refuses_scene(&scene, &["scene.glb", "no triangles"]);
    let scene = bench.scene(|root| {
        for node in root["nodes"].as_array_mut().expect("nodes") {
            node.as_object_mut().expect("an object").remove("extensions");
        }
    });
    bench.refuses_scene(&scene, &["scene.glb", "no light", "--environment"]);
    let scene = bench.scene(|_| {});
    let named = [&scene, "-n", "10", "-o", "out.cloud", "--translucent", "Glass"];
    bench.refuses(&named, &["--translucent", "`Glass`", "`Slab`"]);
    for (share, words) in [
        ("Glass=0.5", ["--share", "`Glass`", "there are `Slab`"]),
        ("Slab=0.5", ["--share", "0.5 in all", "1 is needed"]),
        ("Slab=0", ["--share", "between 0 and 1", "Slab=0"]),
        ("Slab=NaN", ["--share", "between 0 and 1", "Slab=NaN"]),
        ("Slab", ["--share", "MATERIAL=F", "Slab"]),
    ] {
        bench.refuses(&[&scene, "-n", "10", "-o", "out.cloud", "--share", share], &words);
    }
    let scene = bench.scene(|root| {
        let first = root["materials"][0].clone();
        root["materials"].as_array_mut().expect("a list").push(first);
        root["materials"][1]["name"] = json!("Lid");
        let mut lid = root["meshes"][0]["primitives"][0].clone();
        lid["material"] = json!(1);
        root["meshes"][0]["primitives"].as_array_mut().expect("a list").push(lid);
    });
    let shares = |second: &str, words: &[&str]| {
        bench.refuses(&[&scene, "-o", "out.cloud", "--share", "Slab=0.7", "--share", second], words);
    };
    shares("Slab=0.2", &["--share", "`Slab` has two"]);
    shares("Lid=0.7", &["--share", "1.4 in all", "1 is needed"]);
}

#[test]
fn features_that_are_not_supported_are_named() {
    let bench = Bench::new();
    for extension in
        ["KHR_draco_mesh_compression", "EXT_meshopt_compression", "EXT_mesh_gpu_instancing", "VENDOR_thing"]
    {
        let scene = bench.scene(|root| {
            root["extensionsRequired"] = json!([extension]);
            root["extensionsUsed"].as_array_mut().expect("a list").push(json!(extension));
        });
        bench.refuses_scene(&scene, &["scene.glb", extension, "export again"]);
    }
    let mesh_node = |root: &Value| {
        root["nodes"].as_array().expect("nodes").iter().position(|n| n.get("mesh").is_some()).expect("a mesh node")
    };
    let scene = bench.scene(|root| {
        let node = mesh_node(root);
        root["skins"] = json!([{ "joints": [node] }]);
        root["nodes"][node]["skin"] = json!(0);
    });
    bench.refuses_scene(&scene, &["scene.glb", "node `", "skinned"]);
    let scene = bench.scene(|root| root["meshes"][0]["primitives"][0]["targets"] = json!([{ "POSITION": 0 }]));
    bench.refuses_scene(&scene, &["scene.glb", "node `", "morph"]);
    let scene = bench.scene(|root| {
        let target = json!({ "node": mesh_node(root), "path": "rotation" });
        let sampler = json!({ "input": 0, "output": 0 });
        root["animations"] =
            json!([{ "name": "Spin", "channels": [{ "sampler": 0, "target": target }], "samplers": [sampler] }]);
    });
    bench.refuses_scene(&scene, &["scene.glb", "`Spin`", "not supported"]);
}

#[test]
fn usage_errors() {
    let bench = Bench::new();
    let scene = bench.scene(|_| {});
    bench.refuses(&[&scene, "-o", "out.cloud", "-n", "0"], &["--samples", "at least one"]);
    bench.refuses(&[&scene, "-o", "out.cloud", "-n", "many"], &["--samples", "250k"]);
    bench.refuses(&[&scene, "-o", "out.cloud", "-n", "1e15"], &["--samples", "fewer"]);
    bench.refuses(&[&scene, "-o", "out.cloud", "-n", "8e9"], &["--samples", "memory"]);
    bench.refuses(&[&scene, "-o", "out.cloud", "--pattern", "random"], &["--pattern", "stratified", "independent"]);
    bench.refuses(&[&scene, "-o", "out.cloud", "--sample-count", "3"], &["--sample-count"]);
    bench.refuses(&[&scene], &["--output"]);
    bench.refuses(&[&scene, "-o", "out.cloud", "--environment", "1,-1,1"], &["--environment"]);
    bench.refuses(
        &[&scene, "-o", "out.cloud", "--environment", "sky.exr"],
        &["--environment", "sky.exr", "cannot read"],
    );
    bench.refuses(&[&scene, "-o", "out.cloud", "--metres-per-unit", "0"], &["--metres-per-unit"]);
    let huge = ["too large for float32 coordinates", "set --metres-per-unit"];
    bench.refuses(&[&scene, "-o", "out.cloud", "--metres-per-unit", "1e20"], &huge);
    bench.refuses(&[&scene, "-o", "out.cloud", "-j", "0"], &["--threads"]);
}

#[test]
fn outputs_that_cannot_be_written() {
    let bench = Bench::new();
    let scene = bench.scene(|_| {});
    bench.refuses(&[&scene, "-n", "10", "-o", "no/such/folder/out.cloud"], &["no/such/folder/out.cloud"]);
    bench.refuses(&[&scene, "-n", "10", "-o", "."], &["cannot write", "folder"]);
    if Path::new("/dev/full").exists() {
        bench.refuses(&[&scene, "-n", "1000", "-o", "/dev/full", "--quiet"], &["/dev/full", "No space left"]);
    }
}

#[test]
fn an_up_to_date_cloud_is_kept_and_a_damaged_one_is_made_again() {
    let bench = Bench::new();
    let scene = bench.scene(|_| {});
    let arguments = [&scene, "-n", "1000", "-o", "out.cloud", "--stats", "stats.json"];
    let kept = |bench: &Bench| {
        let output = bench.run(&arguments);
        assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
        let stats: Value = serde_json::from_slice(&fs::read(bench.path("stats.json")).expect("reads")).expect("JSON");
        stats["kept"].as_bool().expect("a flag")
    };
    assert!(!kept(&bench));
    let first = fs::read(bench.path("out.cloud")).expect("reads");
    assert!(kept(&bench));
    let mut damaged = first.clone();
    let middle = damaged.len() / 2;
    damaged[middle] ^= 1;
    fs::write(bench.path("out.cloud"), damaged).expect("writes");
    assert!(!kept(&bench));
    assert_eq!(fs::read(bench.path("out.cloud")).expect("reads"), first, "the same bytes again");
    let seed = bench.run(&[&scene, "-n", "1000", "-o", "out.cloud", "--seed", "1"]);
    assert_eq!(seed.status.code(), Some(0));
    assert_ne!(fs::read(bench.path("out.cloud")).expect("reads"), first, "another seed, another cloud");
}

#[test]
fn the_cloud_is_the_same_for_any_number_of_threads_and_the_ply_holds_all_of_it() {
    let bench = Bench::new();
    let scene = bench.scene(|_| {});
    for (threads, name) in [("1", "one.cloud"), ("2", "two.cloud")] {
        let output = bench.run(&[&scene, "-n", "40k", "-o", name, "-j", threads, "--ply", "cloud.ply"]);
        assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
    }
    let read = |name: &str| fs::read(bench.path(name)).expect("reads");
    assert_eq!(read("one.cloud"), read("two.cloud"));
    let ply = read("cloud.ply");
    let end = ply.windows(11).position(|w| w == b"end_header\n").expect("a header") + 11;
    let header = String::from_utf8_lossy(&ply[..end]).into_owned();
    let count: usize =
        header.lines().find_map(|l| l.strip_prefix("element vertex ")).expect("a count").parse().expect("a number");
    assert!(count > 1000);
    assert_eq!(ply.len() - end, count * 12 * 4);
}

/// Adds a plate of a material that is no volume, the slab's own mesh beside it.
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

/// The one surface that is marked as a volume is scaled to nothing: nothing else becomes translucent, unless it is named.
/// The list of materials says the same. `import_volumes`.
///
/// Seen to fail: a cloud of the plate.
#[test]
fn marked_surfaces_that_are_lost_are_an_error() {
    let bench = Bench::new();
    let scene = bench.scene(|root| {
        add_plate(root);
        root["nodes"][0]["scale"] = json!([0, 0, 0]);
    });
    bench.refuses_scene(&scene, &["scene.glb", "`Slab`", "no area", "--translucent"]);
    let table = String::from_utf8(bench.run(&[&scene, "--list-materials"]).stdout).expect("text");
    let row = |name: &str| table.lines().find(|line| line.contains(name)).expect("a row").to_owned();
    assert!(row("Slab").contains("translucent, no triangle left") && row("Plate").contains("opaque"), "{table}");
    let named = bench.run(&[&scene, "-n", "1000", "-o", "out.cloud", "--translucent", "Plate"]);
    assert_eq!(named.status.code(), Some(0), "{}", String::from_utf8_lossy(&named.stderr));
}

/// A mesh that is there twice is sampled once; `--strict` refuses it all the same. `copies`.
///
/// Seen to fail: a cloud of twice the area.
#[test]
fn a_mesh_that_is_there_twice_takes_in_its_light_once() {
    let bench = Bench::new();
    let flux = |scene: &str, words: &[&str]| {
        let output = bench.run(&[scene, "-n", "1000", "-o", "out.cloud", "--stats", "stats.json"]);
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(output.status.code() == Some(0) && words.iter().all(|word| said.contains(word)), "{said}");
        let stats: Value = serde_json::from_slice(&fs::read(bench.path("stats.json")).expect("reads")).expect("JSON");
        [stats["surface_area_m2"].clone(), stats["mean_flux_w"].clone()]
    };
    let once = flux(&bench.scene(|_| {}), &[]);
    assert!(once.iter().all(|value| !value.is_null()));
    let twice = bench.scene(|root| {
        let again = root["meshes"][0]["primitives"][0].clone();
        root["meshes"][0]["primitives"].as_array_mut().expect("a list").push(again);
    });
    assert_eq!(flux(&twice, &["6144 triangles lie exactly on others", "6144 duplicate triangles"]), once);
    bench.refuses(&[&twice, "-n", "1000", "-o", "no.cloud", "--strict"], &["6144 duplicate triangles", "--strict"]);
}

/// What a file asks for and is not done is said by the program, in one line. `unhonoured`.
#[test]
fn what_is_not_honoured_is_said_once() {
    let bench = Bench::new();
    let scene = bench.scene(|root| {
        root["materials"][0]["normalTexture"] = json!({ "index": 0 });
        root["materials"][0]["pbrMetallicRoughness"]["roughnessFactor"] = json!(0.5);
        root["fog"] = json!(1);
    });
    let said = String::from_utf8(bench.run(&[&scene, "-n", "1000", "-o", "out.cloud"]).stderr).expect("text");
    let lines: Vec<&str> = said.lines().filter(|line| line.contains("warning")).collect();
    let [line] = lines[..] else { panic!("{said}") };
    for word in ["scene.glb: not honoured: ", "materials[].normalTexture (`Slab`)", "taken as 0", "fog; docs/scenes.md"]
    {
        assert!(line.contains(word), "{word}: {line}");
    }
}

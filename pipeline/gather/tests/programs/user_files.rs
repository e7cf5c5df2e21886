//! Files of users, with a test for each kind of input. Where other tests cover the details, the comment names them:
//! they are in `crates/scene/tests/scene` and in this folder.

use formats::Attribute;
use serde_json::{Value, json};
use test_support::{Bench, data};

/// Makes a small cloud of `scene` as `user.cloud`; returns the messages.
pub fn sample(bench: &Bench, scene: &str, more: &[&str]) -> String {
    bench.says("sample-surface", &[&[scene, "-n", "500", "-o", "user.cloud", "--progress", "none"], more].concat())
}

/// Makes a small image of that cloud as `user.exr`; returns the messages.
pub fn gather(bench: &Bench, scene: &str, more: &[&str]) -> String {
    let size = ["--width", "8", "--height", "8", "--spp", "1", "--progress", "none", "-o", "user.exr"];
    bench.says("gather", &[&["user.cloud", scene], &size[..], more].concat())
}

pub fn text_attribute(bench: &Bench, name: &str) -> String {
    match bench.image("user.exr").attributes.get(name) {
        Some(Attribute::Text(text)) => text.clone(),
        Some(Attribute::Texts(lines)) => lines.join("\n"),
        other => panic!("{name}: {other:?}"),
    }
}

/// Light numbers are taken as they are or as lumens; the cloud records which, and both programs must agree. Details:
/// `import_lights`.
#[test]
fn light_units() {
    let bench = Bench::new();
    let slab = data("scenes/slab.glb");
    let flux = |unit: &str| {
        sample(&bench, &slab, &["--light-unit", unit, "--stats", "stats.json"]);
        bench.json("stats.json")["mean_flux_w"][0].as_f64().expect("a number")
    };
    let (watts, lumens) = (flux("radiometric"), flux("photometric"));
    assert!((watts / lumens - 683.0).abs() < 1e-6 * 683.0, "{watts} {lumens}");
    gather(&bench, &slab, &["--medium", "marble", "--light-unit", "photometric"]);
    assert_eq!(text_attribute(&bench, "pcsss/lightUnit"), "photometric");
    // What is left open is that of the cloud.
    gather(&bench, &slab, &["--medium", "marble"]);
    assert_eq!(text_attribute(&bench, "pcsss/lightUnit"), "photometric");
    let wrong = ["user.cloud", &slab, "--medium", "marble", "--light-unit", "radiometric", "-o", "wrong.exr"];
    bench.refuses("gather", &wrong, &["--light-unit is radiometric"]);
}

/// Emission has its own unit, by default that of the lights; clouds with other units are refused.
#[test]
fn emission_units() {
    let bench = Bench::new();
    let slab = bench.slab("slab.gltf", |root| {
        root["materials"][0]["emissiveFactor"] = json!([1, 1, 1]);
        root["extensions"]["KHR_lights_punctual"]["lights"][0]["intensity"] = json!(683);
    });
    let most = |units: &[&str]| {
        sample(&bench, &slab, units);
        gather(&bench, &slab, &[&["--medium", "marble"], units].concat());
        let image = bench.image("user.exr");
        let emitted = &image.channels.iter().find(|c| c.name == "emission.R").expect("a channel").samples;
        emitted.iter().fold(0.0f32, |most, x| most.max(*x))
    };
    let near = |found: f32, expected: f32| assert!((found / expected - 1.0).abs() < 1e-5, "{found} {expected}");
    let lumens = most(&["--light-unit", "photometric"]);
    assert_eq!(text_attribute(&bench, "pcsss/emissionUnit"), "photometric");
    // Some of the light stays below the interface.
    near(most(&["--light-unit", "photometric", "--emission-unit", "radiometric"]), 683.0 * lumens);
    assert_eq!(text_attribute(&bench, "pcsss/emissionUnit"), "radiometric");
    let wrong = ["user.cloud", &slab, "--medium", "marble", "--light-unit", "photometric", "-o", "wrong.exr"];
    bench.refuses("gather", &wrong, &["--emission-unit is photometric, the cloud's radiometric"]);
}

/// In float32, positions on an object of 0.2 m at 1000 km from the origin have only 3 different values; relative to the
/// origin that the header states, they have as many as elsewhere. Near the origin they are positions in the world.
#[test]
fn positions_far_from_the_origin() {
    const FAR: f64 = 1e6;
    let at = |shift: f64| {
        let bench = Bench::new();
        let scene = bench.slab("far.gltf", |root| {
            for node in root["nodes"].as_array_mut().expect("a list") {
                let x = node["translation"][0].as_f64().unwrap_or(0.0);
                let [y, z] = [1, 2].map(|k| node["translation"][k].as_f64().unwrap_or(0.0));
                node["translation"] = json!([x + shift, y, z]);
            }
        });
        sample(&bench, &scene, &["--ply", "far.ply"]);
        let size = ["--width", "24", "--height", "24", "--spp", "1", "--quiet", "-o", "user.exr"];
        bench.says("gather", &[&["user.cloud", &scene, "--medium", "marble"], &size[..]].concat());
        let image = bench.image("user.exr");
        let Some(Attribute::Vector(origin)) = image.attributes.get("pcsss/originM") else { panic!("no origin") };
        let plane = |name: &str| image.channels.iter().find(|c| c.name == name).expect("a channel").samples.clone();
        let hit = plane("Z").into_iter().zip(plane("P.X")).filter(|(z, _)| *z > 0.0).map(|(_, x)| x).collect();
        (*origin, hit, bench.read("far.ply"))
    };
    let x_of_ply = |bytes: &[u8]| -> (String, Vec<f32>) {
        let end = bytes.windows(11).position(|w| w == b"end_header\n").expect("a header") + 11;
        let rows = bytes[end..].chunks_exact(48);
        let x = rows.map(|row| f32::from_le_bytes([row[0], row[1], row[2], row[3]])).collect();
        (String::from_utf8_lossy(&bytes[..end]).into_owned(), x)
    };
    let (origin, near, ply): ([f32; 3], Vec<f32>, Vec<u8>) = at(0.0);
    assert_eq!(origin, [0.0; 3]);
    let (header, near_points) = x_of_ply(&ply);
    assert!(!header.contains("comment") && header.contains("property float x\n"), "{header}");
    let (origin, far, ply) = at(FAR);
    assert!((f64::from(origin[0]) - FAR).abs() < 1.0, "{origin:?}");
    let (header, far_points) = x_of_ply(&ply);
    let [x, y, z] = origin;
    assert!(header.contains(&format!("comment x y z are relative to originM {x} {y} {z}\n")), "{header}");
    for (near, far) in [(near, far), (near_points, far_points)] {
        assert!(near.len() == far.len() && near.len() > 200, "{} {}", near.len(), far.len());
        for (near, far) in near.iter().zip(&far) {
            let far = f64::from(*far) + f64::from(origin[0]) - FAR;
            assert!((far - f64::from(*near)).abs() < 1e-6, "{far} {near}");
        }
    }
}

/// Red, green and blue lights on nested and scaled nodes are white together. Cones and ranges: `import_lights`.
#[test]
fn light_color_and_cone() {
    let bench = Bench::new();
    let flux = |colors: &[Value]| {
        let scene = bench.slab("lights.gltf", |root| {
            let sun = |color: &Value| json!({ "type": "directional", "color": color, "intensity": 2 });
            root["extensions"]["KHR_lights_punctual"]["lights"] = colors.iter().map(sun).collect();
            let light = |k: usize| json!({ "extensions": { "KHR_lights_punctual": { "light": k } } });
            let first = 3;
            root["nodes"][1] = json!({
                "rotation": root["nodes"][1]["rotation"], "scale": [3, 3, 3],
                "children": (first..first + colors.len()).collect::<Vec<_>>(),
            });
            root["nodes"].as_array_mut().expect("a list").extend((0..colors.len()).map(light));
        });
        sample(&bench, &scene, &["--stats", "stats.json"]);
        bench.json("stats.json")["mean_flux_w"].clone()
    };
    let primaries = flux(&[json!([1, 0, 0]), json!([0, 1, 0]), json!([0, 0, 1])]);
    let white = flux(&[json!([1, 1, 1])]);
    for c in 0..3 {
        let [sum, white] = [&primaries, &white].map(|f| f[c].as_f64().expect("a number"));
        // One of the three is picked for each sample; the share may differ by five standard errors.
        assert!((sum / white - 1.0).abs() < 5.0 * (2.0f64 / 500.0).sqrt(), "{sum} for {white}");
    }
}

/// Emitting triangles light the scene; a scene without light is refused if it shall have none. Details: `lights`, `import_lights`.
#[test]
fn area_lights_and_scenes_without_light() {
    let bench = Bench::new();
    let dark = |root: &mut Value| root["nodes"][1]["extensions"] = json!({});
    let scene = bench.slab("dark.gltf", dark);
    let arguments = [&scene, "-n", "500", "-o", "user.cloud", "--environment", "0,0,0"];
    bench.refuses("sample-surface", &arguments, &["dark.gltf", "no light", "--environment"]);
    let scene = bench.slab("lit.gltf", |root| {
        dark(root);
        let strength = json!({ "KHR_materials_emissive_strength": { "emissiveStrength": 5 } });
        let lamp = json!({ "name": "Lamp", "emissiveFactor": [1, 1, 1], "extensions": strength, "doubleSided": true });
        root["materials"].as_array_mut().expect("a list").push(lamp);
        let mut mesh = root["meshes"][0].clone();
        mesh["primitives"][0]["material"] = json!(1);
        root["meshes"].as_array_mut().expect("a list").push(mesh);
        root["nodes"][1]["mesh"] = json!(1);
    });
    assert!(sample(&bench, &scene, &[]).contains("carry light"));
}

/// Both kinds of cameras are chosen by name and index, under a scaled parent and with another aspect than the image.
/// Details: `import_lights`.
#[test]
fn cameras() {
    let bench = Bench::new();
    let scene = bench.slab("cameras.gltf", |root| {
        let flat = json!({ "xmag": 0.1, "ymag": 0.05, "znear": 0, "zfar": 9 });
        let flat = json!({ "name": "Flat \u{e9}", "type": "orthographic", "orthographic": flat });
        root["cameras"].as_array_mut().expect("a list").push(flat);
        let mut node = root["nodes"][2].clone();
        node["camera"] = json!(1);
        node["scale"] = json!([7, 7, 7]);
        root["nodes"].as_array_mut().expect("a list").push(node);
        root["scenes"][0]["nodes"].as_array_mut().expect("a list").push(json!(3));
    });
    let table = bench.succeed("gather", &["--list-cameras", &scene]);
    let lines: Vec<&str> = table.lines().collect();
    assert!(lines[1].starts_with("0") && lines[1].contains("Top") && lines[1].contains("yfov 2.30 degrees"), "{table}");
    assert!(lines[2].starts_with("1") && lines[2].contains("orthographic"), "{table}");
    assert!(lines[2].contains("height 1.0000e-1 m") && lines[2].contains("2.000"), "{table}");
    sample(&bench, &scene, &[]);
    for camera in ["1", "Flat \u{e9}"] {
        let said = gather(&bench, &scene, &["--medium", "marble", "--camera", camera]);
        assert!(said.contains("aspect is 2.000, the image's 1.000"), "{said}");
        // The camera looks straight down from half a metre; scaled or not, all of the image shows the slab.
        let image = bench.image("user.exr");
        let depth = image.channel("Z").expect("depths");
        assert!(depth.iter().all(|z| (z - 0.5).abs() < 1e-6), "{depth:?}");
    }
}

/// A mirrored slab is still wound outwards. Details: `import`; the image: `tests/invariance/mirror.rs`.
#[test]
fn negative_scale() {
    let bench = Bench::new();
    let scene = bench.slab("mirrored.gltf", |root| root["nodes"][0]["scale"] = json!([-1, 1, 1]));
    let said = sample(&bench, &scene, &["--strict", "--stats", "stats.json"]);
    assert!(!said.contains("warning"), "{said}");
    assert_eq!(bench.json("stats.json")["mesh"]["inward_parts"], 0);
}

/// Without normals in the file, those of the triangles are used. Details:
/// `import::lists_strips_and_fans_without_indices`.
#[test]
fn no_normals() {
    let bench = Bench::new();
    let slab = data("scenes/slab.glb");
    sample(&bench, &slab, &[]);
    gather(&bench, &slab, &["--medium", "marble"]);
    let image = bench.image("user.exr");
    let [x, y, z] = ["N.X", "N.Y", "N.Z"].map(|name| image.channel(name).expect("normals").to_vec());
    assert!((0..x.len()).all(|p| (x[p], y[p], z[p]) == (0.0, 1.0, 0.0)));
}

/// Points are left out with a warning. Strips, fans, missing indices, interleaved and sparse accessors: `import`.
#[test]
fn strips_points_and_many_primitives() {
    let bench = Bench::new();
    let scene = bench.slab("points.gltf", |root| {
        let more = [
            json!({ "attributes": { "POSITION": 0 }, "mode": 0 }),
            json!({ "attributes": { "POSITION": 0 }, "mode": 1 }),
        ];
        root["meshes"][0]["primitives"].as_array_mut().expect("a list").extend(more);
    });
    let said = sample(&bench, &scene, &[]);
    assert_eq!(said.matches("points and lines are left out").count(), 2, "{said}");
    gather(&bench, &scene, &["--medium", "marble"]);
    assert_eq!(text_attribute(&bench, "pcsss/warnings").matches("points and lines are left out").count(), 2);
}

/// Open, turned, doubled: warned of with counts once, kept in the statistics, refused by `--strict`. `defects`.
#[test]
fn an_open_mesh_with_a_volume() {
    let bench = Bench::new();
    let scene = bench.slab("open.gltf", |root| root["accessors"][1]["count"] = json!(18432 - 3));
    let said = sample(&bench, &scene, &["--stats", "stats.json"]);
    assert!(said.contains("warning: open.gltf: the translucent surfaces have 3 open edges"), "{said}");
    assert_eq!(bench.json("stats.json")["mesh"]["open_edges"], 3);
    let said = gather(&bench, &scene, &["--medium", "marble", "--stats", "stats.json"]);
    assert!(!said.contains("3 open edges"), "{said}");
    let said = gather(&bench, &scene, &["--medium", "marble", "--stats", "stats.json", "--verbose"]);
    assert!(said.contains("3 open edges"), "{said}");
    assert_eq!(bench.json("stats.json")["mesh"]["open_edges"], 3);
    let words = ["open.gltf", "3 open edges", "--strict"];
    bench.refuses("sample-surface", &[&scene, "-o", "no.cloud", "--strict"], &words);
    bench.refuses("gather", &["user.cloud", &scene, "--medium", "marble", "-o", "no.exr", "--strict"], &words);
    let twice = bench.slab("twice.gltf", |root| {
        let again = root["meshes"][0]["primitives"][0].clone();
        root["meshes"][0]["primitives"].as_array_mut().expect("a list").push(again);
    });
    let said = sample(&bench, &twice, &[]);
    assert!(said.contains("6144 duplicate triangles"), "{said}");
}

/// A speck two kilometres from what it stands beside: float32 has lost what the medium resolves.
#[test]
fn a_scene_too_wide_for_its_medium() {
    let bench = Bench::new();
    let wide = |distance: f64| {
        let scene = bench.slab("wide.gltf", |root| {
            root["materials"].as_array_mut().expect("a list").push(json!({ "name": "Far" }));
            let mut mesh = root["meshes"][0].clone();
            mesh["primitives"][0]["material"] = json!(1);
            root["meshes"].as_array_mut().expect("a list").push(mesh);
            root["nodes"].as_array_mut().expect("a list").push(json!({ "mesh": 1, "translation": [distance, 0, 0] }));
            root["scenes"][0]["nodes"].as_array_mut().expect("a list").push(json!(3));
        });
        sample(&bench, &scene, &[]);
        gather(&bench, &scene, &["--medium", "marble"])
    };
    let said = wide(2000.0);
    assert!(said.contains("rounded by up to 59") && said.contains("too wide"), "{said}");
    assert!(!wide(20.0).contains("rounded"));
}

/// A cloud of one pose serves no other: at rest, and at another time of the animation, its scene is refused, though the
/// animation moves only a camera; the message names the options. `import_poses`.
///
/// Seen to catch: a pose that only the geometry's digest knows.
#[test]
fn a_cloud_knows_its_pose() {
    let bench = Bench::new();
    let keys: Vec<u8> = [0.0f32, 2.0, 0.0, 0.0, 0.0, 0.0, 0.2, 0.0].iter().flat_map(|x| x.to_le_bytes()).collect();
    let scene = bench.slab("moving.gltf", |root| {
        let accessors = root["accessors"].as_array().expect("a list").len();
        let views = root["bufferViews"].as_array().expect("a list").len();
        let buffers = root["buffers"].as_array().expect("a list").len();
        let mut push = |list: &str, value: Value| root[list].as_array_mut().expect("a list").push(value);
        push("buffers", json!({ "uri": "keys.bin", "byteLength": 32 }));
        push("bufferViews", json!({ "buffer": buffers, "byteLength": 32 }));
        let accessor = |offset: usize, kind: &str| {
            json!({ "bufferView": views, "byteOffset": offset, "componentType": 5126, "type": kind, "count": 2 })
        };
        push("accessors", accessor(0, "SCALAR"));
        push("accessors", accessor(8, "VEC3"));
        let sampler = json!({ "input": accessors, "output": accessors + 1 });
        let channel = json!({ "sampler": 0, "target": { "node": 2, "path": "translation" } });
        root["animations"] = json!([{ "name": "fly by", "channels": [channel], "samplers": [sampler] }]);
    });
    bench.write("keys.bin", keys);
    assert!(sample(&bench, &scene, &[]).contains("everything is at rest; the file has animations: `fly by`"));
    let posed = ["--animation", "fly by", "--time", "0.5"];
    sample(&bench, &scene, &posed);
    let own = ["user.cloud", &scene, "--medium", "marble", "-o", "no.exr"];
    let words = ["user.cloud", "at rest", "fly by at 0.5 s", "--animation, --time", "sample the scene again"];
    bench.refuses("gather", &own, &words);
    bench.refuses("gather", &[&own[..], &["--time", "0.75"]].concat(), &["fly by at 0.75 s", "fly by at 0.5 s"]);
    gather(&bench, &scene, &[&["--medium", "marble"][..], &posed].concat());
}

/// Quantized geometry is read. `import_quantized`; `import_compressed` has what is compressed.
#[test]
fn quantized_meshes() {
    let bench = Bench::new();
    let scene = bench.slab("small.gltf", |root| root["extensionsRequired"] = json!(["KHR_mesh_quantization"]));
    sample(&bench, &scene, &["--strict"]);
}

/// Spaces, percent escapes and Unicode in the names of files, cameras and materials; a missing buffer in full.
/// `import_files`.
#[test]
fn names_and_uris() {
    let bench = Bench::new();
    let scene = bench.slab("my \u{91d1} slab.gltf", |root| {
        root["buffers"][0]["uri"] = json!("the%20slab%20%E9%87%91.bin");
        root["cameras"][0]["name"] = json!("T\u{f6}p view");
        root["materials"][0]["name"] = json!("blue = \u{9752}");
    });
    std::fs::rename(bench.path("slab.bin"), bench.path("the slab \u{91d1}.bin")).expect("a new name");
    sample(&bench, &scene, &["--translucent", "blue = \u{9752}"]);
    gather(&bench, &scene, &["--medium", "marble", "--camera", "T\u{f6}p view"]);
    assert!(text_attribute(&bench, "pcsss/media").starts_with("blue = \u{9752}=marble"));
    std::fs::remove_file(bench.path("the slab \u{91d1}.bin")).expect("gone");
    let words = ["my \u{91d1} slab.gltf", "the slab \u{91d1}.bin", "buffers[0].uri", "beside it"];
    bench.refuses("sample-surface", &[&scene, "-o", "no.cloud"], &words);
}

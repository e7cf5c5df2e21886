//! Media of users' files, of the command line, and of both together.

use crate::opaque::picture;
use crate::user_files::{gather, sample, text_attribute};
use serde_json::{Value, json};
use test_support::Bench;

/// Gives the first material a medium of the older draft.
pub fn with_medium(root: &mut Value) {
    let extensions = &mut root["materials"][0]["extensions"];
    extensions["KHR_materials_volume"] =
        json!({ "thicknessFactor": 1, "attenuationDistance": 0.002, "attenuationColor": [0.5, 0.5, 0.25] });
    extensions["KHR_materials_volume_scatter"] =
        json!({ "multiscatterColorFactor": [0.5, 0.5, 0.5], "scatterAnisotropy": 0.25 });
}

/// Coefficients of the file are taken, printed and stored; those of the command line beat them. The details:
/// `import_volumes`, and `the_albedo_of_the_gltf_drafts`.
#[test]
fn subsurface_parameters() {
    let bench = Bench::new();
    let scene = bench.slab("medium.gltf", with_medium);
    sample(&bench, &scene, &[]);
    let said = gather(&bench, &scene, &["--verbose"]);
    // ln 2 / 2 mm, of which the albedo 0.9117 scatters; the index 1.3 is the file's.
    for words in
        ["KHR_materials_volume_scatter (eta 1.3)", "sigma_a, 1/m     3.0599e1", "sigma_s, 1/m     3.1597e2", "g 0.25"]
    {
        assert!(said.contains(words), "{words}: {said}");
    }
    for words in ["mean free path   2.885 mm 2.885 mm 1.443 mm", "1/sigma_tr", "object diagonal"] {
        assert!(said.contains(words), "{words}: {said}");
    }
    let stored = text_attribute(&bench, "pcsss/media");
    assert!(stored.starts_with("Slab=KHR_materials_volume_scatter: sigma_a 30.599"), "{stored}");
    let table = bench.succeed("gather", &["--list-materials", &scene]);
    assert!(table.contains("(KHR_materials_volume_scatter)") && table.contains("3.0599e1"), "{table}");
    let said = gather(&bench, &scene, &["--medium", "marble"]);
    assert!(said.contains("`Slab`: marble") && !said.contains("`Slab`: KHR"), "{said}");
    assert!(text_attribute(&bench, "pcsss/media").starts_with("Slab=marble"));
    // Neither file nor command line; and an index that no model knows, unless it is not asked for.
    let closed = bench.slab("closed.gltf", |root| {
        root["materials"][0]["extensions"]["KHR_materials_transmission"] = json!({ "transmissionFactor": 0 });
    });
    sample(&bench, &closed, &[]);
    bench.refuses("gather", &["user.cloud", &closed, "-o", "no.exr"], &["--medium", "SCENE gives no medium"]);
    let legacy = bench.slab("legacy.gltf", |root| {
        with_medium(root);
        root["materials"][0]["extensions"]["KHR_materials_ior"]["ior"] = json!(0);
    });
    sample(&bench, &legacy, &[]);
    bench.refuses(
        "gather",
        &["user.cloud", &legacy, "-o", "no.exr"],
        &["`Slab`", "KHR_materials_ior", "eta", "--medium Slab="],
    );
    gather(&bench, &legacy, &["--medium", "marble"]);
}

/// Each of two materials takes its medium from where there is one.
#[test]
fn media_of_file_and_command_line_together() {
    let bench = Bench::new();
    let scene = bench.slab("two.gltf", |root| {
        with_medium(root);
        let plain = json!({ "name": "Plain", "extensions": { "KHR_materials_volume": { "thicknessFactor": 1 } } });
        root["materials"].as_array_mut().expect("a list").push(plain);
        let mut mesh = root["meshes"][0].clone();
        mesh["primitives"][0]["material"] = json!(1);
        root["meshes"].as_array_mut().expect("a list").push(mesh);
        root["nodes"].as_array_mut().expect("a list").push(json!({ "mesh": 1, "translation": [0, -1, 0] }));
        root["scenes"][0]["nodes"].as_array_mut().expect("a list").push(json!(3));
    });
    sample(&bench, &scene, &[]);
    bench.refuses("gather", &["user.cloud", &scene, "-o", "no.exr"], &["`Plain`", "--medium Plain=NAME"]);
    let said = gather(&bench, &scene, &["--medium", "Plain=marble"]);
    assert!(said.contains("`Slab`: KHR_materials_volume_scatter") && said.contains("`Plain`: marble"), "{said}");
}

/// Two codes of sRGB in linear light (IEC 61966-2-1).
const LINEAR: [(u8, f64); 2] = [(188, 0.502_886_458), (230, 0.791_297_940)];

/// A medium of this color whose mean free path is a tenth of a millimetre.
fn with_color(root: &mut Value, color: f64) {
    with_medium(root);
    let extensions = &mut root["materials"][0]["extensions"];
    extensions["KHR_materials_volume"]["attenuationDistance"] = json!(7e-5);
    extensions["KHR_materials_volume_scatter"]["multiscatterColorFactor"] = json!([color, color, color]);
}

/// The same of `tones.png` along x, which is in the middle of the picture where the slab is: the second set of coordinates
/// is x and y in metres.
fn with_tones(root: &mut Value) {
    with_color(root, 1.0);
    let mut push = |list: &str, item: Value| {
        let items = root.as_object_mut().expect("an object").entry(list).or_insert_with(|| json!([]));
        let items = items.as_array_mut().expect("a list");
        items.push(item);
        items.len() - 1
    };
    let positions = json!({ "buffer": 0, "byteLength": 36888, "byteStride": 12 });
    let view = push("bufferViews", positions);
    let plane = push("accessors", json!({ "bufferView": view, "componentType": 5126, "type": "VEC2", "count": 3074 }));
    push("images", json!({ "uri": "tones.png" }));
    push("samplers", json!({ "magFilter": 9728, "wrapS": 33071, "wrapT": 33071 }));
    push("textures", json!({ "source": 0, "sampler": 0 }));
    root["meshes"][0]["primitives"][0]["attributes"]["TEXCOORD_1"] = json!(plane);
    let middle = json!({ "scale": [5, 5], "offset": [0.5, 0.5] });
    root["materials"][0]["extensions"]["KHR_materials_volume_scatter"]["multiscatterColorTexture"] =
        json!({ "index": 0, "texCoord": 1, "extensions": { "KHR_texture_transform": middle } });
}

/// How light below the slab is known.
#[derive(Clone, Copy, Debug)]
enum Known {
    Model,
    Calibrated,
    Walked,
}

/// An image of the slab from above, 2 cm wide and eight pixels high.
fn seen(bench: &Bench, scene: &str, known: Known) -> Vec<f32> {
    bench.says("sample-surface", &[scene, "-n", "20k", "-o", "user.cloud", "--progress", "none"]);
    let more: &[&str] = match known {
        Known::Model => &["--calibration", "none"],
        Known::Calibrated => {
            let calibrate = ["user.cloud", scene, "--walks", "2k", "-o", "user.calibration", "--quiet"];
            bench.succeed("calibrate", &calibrate);
            &["--calibration", "user.calibration"]
        }
        Known::Walked => &["--reference"],
    };
    let size = ["--width", "8", "--height", "8", "--spp", "16", "--progress", "none", "-o", "user.exr"];
    bench.says("gather", &[&["user.cloud", scene], &size[..], more].concat());
    bench.image("user.exr").channel("subsurface.G").expect("a channel").to_vec()
}

/// A texture of the color after multiple scattering is the color of its places: one color is that of the factor, for the
/// model, for a calibration and for random walks, and each half of a picture of two is as that color, all over it.
///
/// Seen to catch: the medium of the factor alone; places that reflect by their colors, and not as media of these colors do.
#[test]
fn a_texture_of_scattered_light_is_its_color() {
    let bench = Bench::new();
    let plain = LINEAR.map(|(code, color)| bench.slab(&format!("{code}.gltf"), |root| with_color(root, color)));
    let tones = bench.slab("tones.gltf", with_tones);
    let codes = LINEAR.map(|(code, _)| [code, code, code, 255]);
    bench.write("tones.png", picture(&[codes[0]; 2]));
    for known in [Known::Model, Known::Calibrated, Known::Walked] {
        let [own, expected] = [&tones, &plain[0]].map(|scene| seen(&bench, scene, known));
        assert!(expected.iter().any(|light| *light > 0.0));
        for (own, expected) in own.iter().zip(&expected) {
            assert!((own - expected).abs() <= 1e-4 * expected, "{known:?}: {own}, not {expected}");
        }
    }
    bench.write("tones.png", picture(&codes));
    let (own, expected) = (seen(&bench, &tones, Known::Model), plain.map(|scene| seen(&bench, &scene, Known::Model)));
    for (half, expected) in expected.iter().enumerate() {
        // Of eight columns the edge lies in the middle.
        let mean = |light: &[f32]| {
            let columns = if half == 0 { 0..3 } else { 5..8 };
            (0..8).flat_map(|row| columns.clone().map(move |k| f64::from(light[8 * row + k]))).sum::<f64>() / 24.0
        };
        let (own, expected) = (mean(&own), mean(expected));
        println!("half {half}: {own}, {expected} of the color alone");
        assert!((own / expected - 1.0).abs() < 0.03, "half {half}: {own}, not {expected}");
    }
    // The picture is a part of the scene, which a calibration is of, and the medium that of its mean.
    seen(&bench, &tones, Known::Calibrated);
    bench.write("tones.png", picture(&[codes[1]; 2]));
    bench.succeed("sample-surface", &[&tones, "-n", "500", "-o", "user.cloud", "--quiet"]);
    let stale = ["user.cloud", &tones, "--calibration", "user.calibration", "-o", "no.exr"];
    bench.refuses("gather", &stale, &["user.calibration"]);
}

/// Without its picture the medium would be another.
#[test]
fn a_texture_of_scattered_light_that_is_not_there() {
    let bench = Bench::new();
    let scene = bench.slab("tones.gltf", with_tones);
    let words = ["tones.gltf", "`Slab`", "multiscatterColorTexture", "images[0] `tones.png`", "beside it"];
    let said = bench.refuses("sample-surface", &[&scene, "-o", "no.cloud"], &words);
    assert_eq!(said.lines().count(), 1, "{said}");
}

//! Media of users' files, of the command line, and of both together.

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

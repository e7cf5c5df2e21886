//! Import of the medium below a surface: both drafts, both spellings, every default.

use scene::{DVec3, ImportOptions, Material, Scatter, ScatterExtension, StatedMedium, Volume};
use serde_json::{Value, json};
use test_support::glb::{Asset, OPTIONS, fault, import_bytes, tetrahedron};

/// The tetrahedron's material with these extensions, and the warnings.
fn material(extensions: Value) -> (Material, Vec<String>) {
    let mut asset = tetrahedron();
    asset.set("/materials/0/extensions", extensions);
    asset.set("/materials/0/pbrMetallicRoughness", json!({ "baseColorFactor": [1, 1, 1, 1] }));
    let scene = asset.import().expect("a good file");
    (scene.materials[0].clone(), scene.warnings)
}

/// A number of a file as the import rounds it to float32.
fn assert_close(a: DVec3, b: DVec3) {
    assert!(a.distance(b) <= 1e-6 * b.length(), "{a} for {b}");
}

/// A volume that transmits `0.5, 0.25, 1` over two units.
pub fn volume() -> Value {
    json!({ "thicknessFactor": 1, "attenuationDistance": 2, "attenuationColor": [0.5, 0.25, 1] })
}

const EXTINCTION: DVec3 = DVec3::new(0.5 * std::f64::consts::LN_2, std::f64::consts::LN_2, 0.0);

/// The scattering by these extensions, and the warnings.
fn scatter_of(draft: ScatterExtension, scatter: Value) -> (Option<Scatter>, Vec<String>) {
    let extensions = json!({
        "KHR_materials_volume": volume(),
        "KHR_materials_transmission": { "transmissionFactor": 1 },
        draft.extension(): scatter,
    });
    let (material, warnings) = material(extensions);
    let medium = material.medium.expect("a medium");
    assert_close(medium.extinction, EXTINCTION);
    assert_eq!((material.volume, medium.ior), (true, 1.5));
    (medium.scatter, warnings)
}

/// Seen to catch: the older draft's default color for the newer.
#[test]
fn both_drafts_with_their_defaults_and_spellings() {
    let both = [ScatterExtension::VolumeScatter, ScatterExtension::Scatter];
    for draft in both {
        let asked = Scatter { draft, color: DVec3::new(0.25, 0.5, 1.0), asymmetry: 0.0 };
        for spelling in ["multiscatterColorFactor", "multiscatterColor"] {
            let fields = json!({ spelling: [0.25, 0.5, 1], "scatterStrengthFactor": 1 });
            assert_eq!(scatter_of(draft, fields), (Some(asked.clone()), vec![]), "{spelling}");
        }
        let fields = json!({ "multiscatterColorFactor": [1, 1, 1], "multiscatterColor": [0, 0, 0],
            "scatterAnisotropy": -0.75, "scatterStrengthFactor": 0.5 });
        let (found, warnings) = scatter_of(draft, fields);
        // Only the newer draft has a strength.
        let share = if draft == ScatterExtension::Scatter { 0.5 } else { 1.0 };
        assert_eq!(found, Some(Scatter { draft, color: DVec3::splat(share), asymmetry: -0.75 }));
        assert!(warnings.is_empty(), "{warnings:?}");
    }
    // The defaults: black, or white with strength 0.
    let [(older, said), (newer, too)] = both.map(|draft| scatter_of(draft, json!({})));
    assert_eq!((older, newer), (None, None));
    assert!(said[0].contains("multiscatterColorFactor is 0") && too[0].contains("scatterStrengthFactor is 0"));
    let (white, _) = scatter_of(ScatterExtension::Scatter, json!({ "scatterStrengthFactor": 1 }));
    assert_eq!(white.map(|s| s.color), Some(DVec3::ONE));
}

/// What light enters without a volume, or in one that absorbs nothing.
const CLEAR: Volume = Volume { extinction: DVec3::ZERO, ior: 1.5, scatter: None };

/// Each of these marks a material as translucent; light enters all of them. Glass is clear where nothing absorbs.
///
/// Seen to catch: diffuse transmission, or transmission without a volume, taken as opaque beside a marked one.
#[test]
fn what_marks_a_material_as_translucent() {
    let transmission = |factor: f64| json!({ "KHR_materials_transmission": { "transmissionFactor": factor } });
    let diffuse = |fields: Value| json!({ "KHR_materials_diffuse_transmission": fields });
    let mut ball = transmission(1.0);
    ball["KHR_materials_volume"] = json!({ "thicknessFactor": 0.1 });
    let cases = [
        (transmission(1.0), true, Some(CLEAR)),
        (transmission(0.1), true, Some(CLEAR)),
        (transmission(0.0), false, None),
        (ball, true, Some(CLEAR)),
        (diffuse(json!({ "diffuseTransmissionFactor": 0.5 })), true, None),
        (diffuse(json!({ "diffuseTransmissionFactor": 0, "diffuseTransmissionColorFactor": [1, 0, 0] })), false, None),
        (diffuse(json!({})), false, None),
        (json!({ "KHR_materials_volume": { "thicknessFactor": 1 } }), true, None),
        (json!({ "KHR_materials_volume": {} }), false, None),
        (json!({ "KHR_materials_scatter": {} }), true, None),
        (json!({ "KHR_materials_volume_scatter": {} }), true, None),
    ];
    for (extensions, marked, medium) in cases {
        let (material, _) = material(extensions.clone());
        assert_eq!((material.volume, material.medium), (marked, medium), "{extensions}");
    }
}

/// A medium in the extras, as Blender exports custom properties; anything else there has no effect, or is named.
///
/// Seen to catch: a text of JSON taken as a name.
#[test]
fn extras_state_a_medium() {
    let stated = |extras: Value| {
        let mut asset = tetrahedron();
        asset.set("/materials/0/extras", extras);
        let scene = asset.import().expect("a good file");
        (scene.materials[0].stated.clone(), scene.materials[0].volume, scene.warnings.join("; "))
    };
    let marble = Some(StatedMedium::Name("marble".into()));
    assert_eq!(stated(json!({ "medium": " marble", "other": [1] })), (marble, true, String::new()));
    let own = r#"{"name":"own"}"#;
    let object = serde_json::from_str::<Value>(own).expect("JSON");
    for medium in [json!(own), object] {
        assert_eq!(stated(json!({ "medium": medium })), (Some(StatedMedium::Json(own.into())), true, String::new()));
    }
    for nothing in [json!({}), json!([1]), json!("medium"), json!({ "medium": null }), json!({ "Medium": "marble" })] {
        assert_eq!(stated(nothing), (None, false, String::new()));
    }
    for wrong in [json!(3), json!(["marble"]), json!("  "), json!("x".repeat(1 << 17))] {
        let (none, volume, warning) = stated(json!({ "medium": wrong }));
        assert!(none.is_none() && !volume && warning.contains("`wax`: extras.medium is neither"), "{warning}");
        assert!(warning.len() < 300, "{warning}");
    }
}

/// A second medium in the extras needs the first and a texture that can be read, and is one.
///
/// Seen to catch: a blend without a texture.
#[test]
fn extras_blend_two_media() {
    let with = |extras: Value, texture: Value| {
        let mut asset = tetrahedron();
        asset.set("/materials/0/extras", extras);
        asset.set("/materials/0/pbrMetallicRoughness", json!({ "baseColorTexture": texture }));
        asset
    };
    let two = json!({ "medium": "skin1", "medium_blend": "marble" });
    let mut untextured = tetrahedron();
    untextured.set("/materials/0/extras", two.clone());
    let cases = [
        (untextured, "needs a base color texture"),
        (with(json!({ "medium_blend": "marble" }), json!({ "index": 0 })), "needs a first medium"),
        (
            with(json!({ "medium": "skin1", "medium_blend": ["marble", "jade"] }), json!({ "index": 0 })),
            "two media at most",
        ),
        (with(two, json!({ "index": 7 })), "baseColorTexture"),
    ];
    for (asset, part) in cases {
        let message = fault(&asset);
        assert!(message.contains("`wax`") && message.contains(part), "{message}");
        assert!(message.contains("extras.medium_blend"), "{message}");
    }
}

/// Absorption alone is a medium if light enters.
#[test]
fn transmission_lets_light_in() {
    let transmission = json!({ "transmissionFactor": 1 });
    let ior = json!({ "ior": 1.25 });
    let all = json!({
        "KHR_materials_volume": volume(), "KHR_materials_transmission": transmission, "KHR_materials_ior": ior,
    });
    let (glass, warnings) = material(all);
    let Some(Volume { extinction, ior, scatter }) = glass.medium else { panic!("a medium") };
    assert_close(extinction, EXTINCTION);
    assert_eq!((ior, scatter, warnings.len()), (1.25, None, 0));
    assert_eq!(material(json!({ "KHR_materials_volume": volume() })).0.medium, None);
    // A thin-walled surface.
    let thin = json!({ "attenuationDistance": 2, "attenuationColor": [0.5, 0.25, 1] });
    let walls = json!({ "KHR_materials_volume": thin, "KHR_materials_transmission": transmission });
    let (walls, _) = material(walls);
    assert_eq!((walls.medium, walls.volume), (Some(CLEAR), true));
    // The newer draft needs transmission, the older does not.
    for (draft, has_medium) in [(ScatterExtension::Scatter, false), (ScatterExtension::VolumeScatter, true)] {
        let scatter = json!({ "multiscatterColorFactor": [1, 1, 1], "scatterStrengthFactor": 1 });
        let (m, warnings) = material(json!({ "KHR_materials_volume": volume(), draft.extension(): scatter }));
        assert_eq!((m.medium.is_some(), m.volume), (has_medium, true));
        assert_eq!(warnings.iter().any(|w| w.contains("without KHR_materials_transmission")), !has_medium);
    }
}

#[test]
fn what_is_missing_or_taken_otherwise_is_said() {
    let said = |base: Value, volume: Value, transmission: f64, extension: &str, scatter: Value| {
        let mut asset = tetrahedron();
        let transmission = json!({ "transmissionFactor": transmission });
        let extensions =
            json!({ "KHR_materials_volume": volume, "KHR_materials_transmission": transmission, extension: scatter });
        asset.set("/materials/0/extensions", extensions);
        asset.set("/materials/0/pbrMetallicRoughness", json!({ "baseColorFactor": base }));
        let mut scene = asset.import().expect("a good file");
        scene.warn_of_unhonoured(|_| true);
        (scene.materials[0].medium.clone(), scene.warnings.join("; "))
    };
    let (white, older) = (json!([1, 1, 1, 1]), "KHR_materials_volume_scatter");
    let color = || json!({ "multiscatterColorFactor": [1, 1, 1] });
    let (endless, text) = said(white.clone(), json!({ "thicknessFactor": 1 }), 1.0, older, color());
    assert!(endless.is_none() && text.contains("`wax`") && text.contains("gives no medium"), "{text}");
    let thin = json!({ "attenuationDistance": 2, "attenuationColor": [0.5, 0, 1] });
    let (medium, text) = said(json!([1, 0.5, 1, 1]), thin, 0.5, older, color());
    assert_eq!(medium.map(|m| (m.extinction.y * 2.0 * 1e6).round()), Some(9_210_340.0), "-ln(1e-4)");
    for word in
        ["raised to 0.0001", "thicknessFactor is 0", "transmissionFactor taken as 1", "baseColorFactor taken as 1"]
    {
        assert!(text.contains(word), "{word}: {text}");
    }
    let textured = json!({ "scatterStrengthFactor": 1, "scatterStrengthTexture": { "index": 0 } });
    assert!(said(white, volume(), 1.0, "KHR_materials_scatter", textured).1.contains("scatterStrengthTexture"));
    let (none, text) = material(json!({ older: color() }));
    assert!(none.medium.is_none() && text[0].contains("without KHR_materials_volume:"), "{text:?}");
    let (newer, text) = material(json!({
        "KHR_materials_volume": volume(),
        "KHR_materials_transmission": { "transmissionFactor": 1 },
        older: color(),
        "KHR_materials_scatter": { "scatterStrengthFactor": 1 },
    }));
    assert_eq!(newer.medium.and_then(|m| m.scatter).map(|s| s.draft), Some(ScatterExtension::Scatter));
    assert!(text[0].contains("KHR_materials_volume_scatter is not used"), "{text:?}");
}

/// The distance is in units of the world, which nodes do not scale.
#[test]
fn attenuation_is_in_units_of_the_world() {
    let mut asset = tetrahedron();
    let transmission = json!({ "transmissionFactor": 1 });
    let extensions = json!({ "KHR_materials_volume": volume(), "KHR_materials_transmission": transmission });
    asset.set("/materials/0/extensions", extensions);
    asset.set("/nodes/0/scale", json!([10, 10, 10]));
    let options = ImportOptions { metres_per_unit: 0.001, ..OPTIONS };
    let scene = import_bytes("small.glb", &asset.glb(), &options).expect("a good file");
    let medium = scene.materials[0].medium.clone().expect("a medium");
    assert_close(medium.extinction, 1000.0 * EXTINCTION);
}

#[test]
fn numbers_out_of_range_are_faults() {
    let message = |volume: Value, scatter: Value| {
        let mut asset = tetrahedron();
        let extensions = json!({ "KHR_materials_volume": volume, "KHR_materials_volume_scatter": scatter });
        asset.set("/materials/0/extensions", extensions);
        fault(&asset)
    };
    let with = |key: &str, value: Value| {
        let mut volume = volume();
        volume[key] = value;
        message(volume, json!({}))
    };
    for (text, word) in [
        (with("attenuationDistance", json!(0)), "attenuationDistance 0"),
        (with("attenuationDistance", json!(-1)), "attenuationDistance -1"),
        (with("attenuationColor", json!([2, 0, 0])), "attenuationColor"),
        (message(volume(), json!({ "multiscatterColor": [0, 1.5, 0] })), "multiscatterColorFactor"),
        (message(volume(), json!({ "multiscatterColor": [0, 1] })), "KHR_materials_volume_scatter"),
        (message(volume(), json!({ "scatterAnisotropy": 1 })), "scatterAnisotropy 1"),
    ] {
        assert!(text.contains("`wax`") && text.contains(word), "{word}: {text}");
    }
}

/// A body of a tenth of a millimetre that is marked as a volume, and a floor that is not, on nodes of their own.
fn marked_body_and_floor() -> Asset {
    let mut asset = tetrahedron();
    asset.set("/materials/0/extensions", json!({ "KHR_materials_volume": { "thicknessFactor": 1 } }));
    asset.set("/nodes/0/scale", json!([1e-4, 1e-4, 1e-4]));
    let floor = asset.push("materials", json!({ "name": "floor" }));
    let mesh = asset.mesh(json!({ "attributes": { "POSITION": 0 }, "indices": 2, "material": floor }));
    asset.node(json!({ "name": "ground", "mesh": mesh }));
    asset
}

/// The file marks what is translucent. Where the marked surfaces are lost, no other becomes translucent.
///
/// Seen to fail: the floor as the translucent surface of each of these files.
#[test]
fn marked_surfaces_that_are_lost_make_no_other_translucent() {
    let whole = marked_body_and_floor().import().expect("a good file");
    assert_eq!((whole.translucent(), whole.lost_volumes()), (Ok((vec![0], false)), vec![]));
    let message = |pointer: &str, value: Value| {
        let mut asset = marked_body_and_floor();
        asset.set(pointer, value);
        let scene = asset.import().expect("a good file");
        assert_eq!(scene.lost_volumes(), [0], "{pointer}");
        let message = scene.translucent().expect_err("it is a fault").to_string();
        assert!(message.contains("`wax`"), "{message}");
        message
    };
    let far = message("/nodes/3/translation", json!([1e4, 1e4, 1e4]));
    assert!(far.contains("4 of 4 triangles") && far.contains("rounded to float32"), "{far}");
    let flat = message("/nodes/0/scale", json!([0, 0, 0]));
    assert!(flat.contains("all 4 triangles have no area"), "{flat}");
    for (field, value) in [("mode", json!(0)), ("mode", json!(3))] {
        let none = message(&format!("/meshes/0/primitives/0/{field}"), value);
        assert!(none.contains("no triangles"), "{none}");
    }
}

/// Marked materials outside the scene do not count, and one marked surface that is left suffices.
#[test]
fn other_marked_surfaces_are_left_as_they_are() {
    let mut unplaced = marked_body_and_floor();
    unplaced.set("/scenes/0/nodes", json!([1, 3]));
    let scene = unplaced.import().expect("a good file");
    assert_eq!((scene.translucent(), scene.lost_volumes()), (Ok((vec![1], true)), vec![]));
    let mut two = marked_body_and_floor();
    two.set("/materials/1/extensions", json!({ "KHR_materials_volume": { "thicknessFactor": 1 } }));
    two.set("/nodes/0/scale", json!([0, 0, 0]));
    let scene = two.import().expect("a good file");
    assert_eq!((scene.translucent(), scene.lost_volumes()), (Ok((vec![1], false)), vec![0]));
    assert!(scene.warnings.iter().any(|w| w.ends_with("left out, all of `wax`")), "{:?}", scene.warnings);
}

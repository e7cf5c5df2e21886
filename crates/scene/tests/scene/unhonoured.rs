//! Properties of a file that the picture does not show are named once, in one line.

use scene::Scene;
use serde_json::{Value, json};
use std::path::Path;
use test_support::glb::{Asset, OPTIONS, TETRAHEDRON, tetrahedron};

/// The warnings of a file; all materials whose name begins with `wax` are translucent.
fn warnings(asset: &Asset) -> Vec<String> {
    let mut scene = asset.import().expect("a good file");
    let names: Vec<String> = scene.materials.iter().map(|m| m.name.clone()).collect();
    scene.warn_of_unhonoured(|k| names[usize::from(k)].starts_with("wax"));
    scene.warnings
}

/// The one line that names what is not honoured; empty if there is none.
fn line(asset: &Asset) -> String {
    let mut lines = warnings(asset);
    lines.retain(|w| w.starts_with("not honoured: "));
    assert!(lines.len() < 2, "{lines:?}");
    lines.pop().unwrap_or_default()
}

/// A translucent body, an opaque floor, a lamp and a camera, and a material on nothing; a texture for all.
fn asset() -> Asset {
    let mut asset = tetrahedron();
    let floor = asset.push("materials", json!({ "name": "floor", "pbrMetallicRoughness": {} }));
    let positions = asset.vectors(&TETRAHEDRON.map(|[x, y, z]| [4.0 * x, y - 3.0, 4.0 * z]));
    let attributes = json!({ "POSITION": positions, "TEXCOORD_0": 0, "TANGENT": 1, "_ID": 0 });
    let mesh = asset.mesh(json!({ "attributes": attributes, "indices": 2, "material": floor }));
    asset.node(json!({ "name": "ground", "mesh": mesh, "extras": { "id": 7 } }));
    asset.push("materials", json!({ "name": "nothing" }));
    asset.push("textures", json!({ "source": 0 }));
    asset.push("images", json!({ "uri": "unread.png" }));
    asset
}

fn with(pointer: &str, value: Value) -> String {
    let mut asset = asset();
    asset.set(pointer, value);
    line(&asset)
}

fn material(name: &str, fields: Value) -> String {
    let mut fields = fields;
    fields["name"] = json!(name);
    with(if name == "floor" { "/materials/1" } else { "/materials/0" }, fields)
}

/// Seen to fail: nothing said of any of these.
#[test]
fn known_properties_are_named_with_what_has_them() {
    let texture = || json!({ "index": 0 });
    let pbr = |field: &str, value: Value| json!({ "pbrMetallicRoughness": { field: value } });
    let extension = |name: &str, field: &str, value: Value| json!({ "extensions": { name: { field: value } } });
    let transmission = |x: f64| extension("KHR_materials_transmission", "transmissionFactor", json!(x));
    for (name, fields, words) in [
        ("floor", json!({ "occlusionTexture": texture() }), "materials[].occlusionTexture (`floor`);"),
        ("wax", json!({ "occlusionTexture": texture() }), "materials[].occlusionTexture (`wax`);"),
        ("wax", json!({ "occlusionTexture": texture() }), "materials[].occlusionTexture (`wax`);"),
        ("wax", pbr("metallicFactor", json!(1)), "pbrMetallicRoughness.metallicFactor taken as 0 (`wax`);"),
        ("wax", pbr("baseColorFactor", json!([1, 1, 0.5, 1])), "baseColorFactor taken as 1 (`wax`);"),
        ("floor", transmission(1.0), "extensions.KHR_materials_transmission.transmissionFactor (`floor`);"),
        ("wax", transmission(0.5), "transmissionFactor taken as 1 (`wax`);"),
        ("floor", extension("KHR_materials_clearcoat", "clearcoatFactor", json!(1)), "clearcoatFactor (`floor`);"),
        (
            "wax",
            extension("KHR_materials_specular", "specularColorFactor", json!([1, 0, 1])),
            "specularColorFactor (`wax`);",
        ),
    ] {
        let said = material(name, fields.clone());
        assert!(said.contains(words) && said.matches('`').count() == 2, "{fields}: {said}");
        assert!(said.ends_with("docs/scenes.md says what is"), "{said}");
    }
}

/// Unknown properties are named with their location, whatever their name.
///
/// Seen to fail: only the names in `extensionsUsed` were said, whether or not anything in the scene had them.
#[test]
fn unknown_properties_are_named_wherever_they_are() {
    for (pointer, name) in [
        ("/physics", "physics;"),
        ("/extensions/EXT_lights_image_based", "extensions.EXT_lights_image_based;"),
        ("/extensions/KHR_lights_punctual/lights/0/profile", "KHR_lights_punctual.lights[].profile (0);"),
        ("/scenes/0/fog", "scenes[].fog (0);"),
        ("/nodes/3/extensions", "nodes[].extensions.ACME_wings (`ground`);"),
        ("/nodes/3/layer", "nodes[].layer (`ground`);"),
        ("/meshes/1/primitives/0/extensions", "meshes[].primitives[].extensions.ACME_wings (1);"),
        ("/meshes/1/primitives/0/attributes/ROTATION", "meshes[].primitives[].attributes.ROTATION (1);"),
        ("/materials/1/extensions", "materials[].extensions.ACME_wings (`floor`);"),
        ("/materials/1/pbrMetallicRoughness/extensions", "pbrMetallicRoughness.extensions.ACME_wings (`floor`);"),
        ("/materials/1/pbrMetallicRoughness/sheenFactor", "materials[].pbrMetallicRoughness.sheenFactor (`floor`);"),
        ("/cameras/0/perspective/shutter", "cameras[].perspective.shutter (`eye`);"),
        ("/cameras/0/extensions", "cameras[].extensions.ACME_wings (`eye`);"),
        ("/accessors/0/unit", "accessors[].unit (0);"),
        ("/bufferViews/1/padding", "bufferViews[].padding (1);"),
    ] {
        let value = if name.contains("ACME") { json!({ "ACME_wings": { "span": 2 } }) } else { json!(0) };
        let said = with(pointer, value);
        assert_eq!(said.strip_prefix("not honoured: ").map(|s| s.contains(name)), Some(true), "{pointer}: {said}");
        assert_eq!(said.matches(", ").count(), 0, "{said}");
    }
}

/// Defaults, what is honoured, and what means nothing. A metal is one that its file says is one, not one that leaves
/// the word out.
#[test]
fn what_changes_no_picture_is_not_named() {
    assert_eq!(warnings(&asset()), Vec::<String>::new());
    let plain = json!({ "metallicFactor": 0, "roughnessFactor": 1, "baseColorFactor": [0.2, 0.4, 0.5, 1] });
    let coat = json!({ "clearcoatFactor": 0, "clearcoatTexture": { "index": 0 } });
    let extensions = json!({ "KHR_materials_clearcoat": coat, "KHR_materials_ior": { "ior": 1.5 },
        "KHR_materials_transmission": { "transmissionFactor": 0 }, "KHR_xmp_json_ld": { "packet": 0 } });
    let floor = json!({ "pbrMetallicRoughness": plain, "doubleSided": true, "extras": [1], "extensions": extensions,
        "occlusionTexture": null });
    assert_eq!(material("floor", floor), "");
    let smooth = json!({ "metallicFactor": 0, "roughnessFactor": 0, "baseColorFactor": [1, 1, 1, 1] });
    let extensions = json!({ "KHR_materials_ior": { "ior": 1.3 },
        "KHR_materials_transmission": { "transmissionFactor": 1 },
        "KHR_materials_volume": { "thicknessFactor": 1, "attenuationDistance": 2, "attenuationColor": [1, 0.5, 1] } });
    assert_eq!(material("wax", json!({ "pbrMetallicRoughness": smooth, "extensions": extensions })), "");
    assert_eq!(with("/asset", json!({ "version": "2.0", "generator": "a", "copyright": "b", "extras": 0 })), "");
}

/// Unused materials, nodes outside the scene, and unused textures cause no warning.
#[test]
fn what_is_not_drawn_is_not_named() {
    let mut asset = asset();
    asset.set("/materials/2/occlusionTexture", json!({ "index": 0 }));
    asset.set("/textures/0/extensions", json!({ "ACME_texture": { "source": 0 } }));
    asset.set("/extensionsUsed", json!(["ACME_texture", "ACME_wings"]));
    asset.push("nodes", json!({ "mesh": 2, "camera": 1, "extensions": { "ACME_wings": {} } }));
    asset.push("cameras", json!({ "type": "perspective", "perspective": { "yfov": 1, "znear": 1, "shutter": 1 } }));
    asset.mesh(json!({ "attributes": { "POSITION": 0 }, "material": 2, "extensions": { "ACME_wings": {} } }));
    assert_eq!(warnings(&asset), Vec::<String>::new());
    // The effect of this extension is unknown.
    asset.set(
        "/extensionsUsed",
        json!(["ACME_wings", "ACME_tail", "ACME_tail", "KHR_materials_ior", "KHR_xmp_json_ld"]),
    );
    assert_eq!(line(&asset), "not honoured: extensionsUsed[] (`ACME_tail`); docs/scenes.md says what is");
}

/// Extensions that change the geometry are refused where they occur, declared or not.
#[test]
fn geometry_is_refused_undeclared() {
    let mut asset = asset();
    asset.set("/nodes/0/extensions", json!({ "KHR_node_visibility": { "visible": false } }));
    assert!(test_support::glb::fault(&asset).contains("KHR_node_visibility is not supported"));
}

/// The camera stands at the origin and looks along -Z: the body is behind it until it turns.
#[test]
fn planes_of_cameras_are_named_where_they_would_cut() {
    let seen = |from: Value, perspective: Value| {
        let mut asset = asset();
        asset.set("/cameras/0/perspective", perspective);
        asset.set("/nodes/2/translation", from);
        line(&asset)
    };
    let planes = |near: f64, far: Option<f64>| json!({ "yfov": 0.5, "znear": near, "zfar": far, "aspectRatio": 1 });
    // The body lies 4 to 5 m before the camera; the floor below it is out of the frame.
    let here = || json!([0.2, 0.2, 5]);
    assert_eq!(seen(here(), planes(3.9, Some(5.1))), "");
    assert_eq!(seen(here(), planes(3.9, None)), "");
    assert!(seen(here(), planes(4.5, Some(5.1))).contains("not honoured: cameras[].perspective.znear (`eye`);"));
    assert!(seen(here(), planes(3.9, Some(4.9))).contains("not honoured: cameras[].perspective.zfar (`eye`);"));
    let both = seen(here(), planes(4.5, Some(4.9)));
    assert!(both.contains(".zfar (`eye`)") && both.contains(".znear (`eye`)"), "{both}");
    assert_eq!(seen(json!([0.2, 0.2, -1]), planes(3.0, Some(4.0))), "", "behind it");
    assert_eq!(seen(json!([40, 0, 5]), planes(4.5, Some(4.9))), "", "beside it");
    let mut flat = asset();
    let orthographic = |near: f64| json!({ "xmag": 1, "ymag": 1, "znear": near, "zfar": 6 });
    for (near, named) in [(3.0, false), (4.5, true)] {
        flat.set("/cameras/0", json!({ "type": "orthographic", "orthographic": orthographic(near) }));
        flat.set("/nodes/2/translation", here());
        assert_eq!(line(&flat).contains("orthographic.znear"), named);
    }
}

/// Names without end, and names without number.
///
/// Seen to catch: a line of megabytes.
#[test]
fn the_line_is_short() {
    let mut asset = asset();
    let long = "long ".repeat(1 << 16);
    for k in 0..20_000 {
        asset.json["materials"][1][format!("x{k}")] = json!(k);
    }
    asset.json["materials"][0][long.as_str()] = json!(0);
    asset.set("/materials/1/name", json!(long));
    for _ in 0..2000 {
        asset.push("materials", json!({ "occlusionTexture": { "index": 0 } }));
        let primitive = json!({ "attributes": { "POSITION": 0 }, "indices": 2 });
        let material = asset.json["materials"].as_array().map_or(0, Vec::len) - 1;
        let mesh = asset.mesh(primitive);
        asset.set(&format!("/meshes/{mesh}/primitives/0/material"), json!(material));
        asset.node(json!({ "mesh": mesh }));
    }
    let said = line(&asset);
    assert!(said.len() < 3000, "{} bytes: {said:.300}", said.len());
    assert!(said.contains("and 19990 more;"), "{said}");
}

/// The scenes of the repository ask for nothing that is not done.
#[test]
fn our_own_scenes_are_honoured() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../data/scenes");
    let files = std::fs::read_dir(folder).expect("the scenes").map(|entry| entry.expect("a file").path());
    for path in files.filter(|path| path.extension().is_some_and(|e| e == "glb")) {
        let mut scene = Scene::import(&path, &OPTIONS).expect("a good file");
        let (translucent, _) = scene.translucent().expect("there is some");
        scene.warn_of_unhonoured(|k| translucent.contains(&k));
        assert_eq!((scene.warnings, scene.duplicate_triangles.len()), (vec![], 0), "{}", path.display());
    }
}

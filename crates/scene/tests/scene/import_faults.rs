//! Every fault of a glTF file is an error that names the file, the field and, where there is one, the way out.

use scene::Scene;
use serde_json::{Value, json};
use test_support::{
    Bench,
    glb::{Asset, FLOAT, OPTIONS, UNSIGNED_INT, UNSIGNED_SHORT, container, fault, import_bytes, tetrahedron},
};

/// Sets one value of a good file at a time. A row is a JSON pointer, the value, and words of the message.
fn assert_faults(base: impl Fn() -> Asset, cases: &[(&str, Value, &str)]) {
    for (pointer, value, words) in cases {
        let mut asset = base();
        asset.set(pointer, value.clone());
        let message = match asset.import() {
            Ok(_) => panic!("{pointer} = {:.80} was accepted", value.to_string()),
            Err(message) => message,
        };
        for word in words.split('&').chain(["tiny.glb"]) {
            assert!(message.contains(word), "{pointer} = {value}: no `{word}` in: {message}");
        }
    }
}

#[test]
fn types_of_accessors() {
    const PRIMITIVE: &str = "/meshes/0/primitives/0";
    let attribute = |name: &str| format!("{PRIMITIVE}/attributes/{name}");
    assert_faults(
        tetrahedron,
        &[
            (&attribute("POSITION"), json!(99), "POSITION&out of range"),
            (&attribute("NORMAL"), json!(99), "NORMAL&out of range"),
            (&format!("{PRIMITIVE}/indices"), json!(99), "indices&out of range"),
            (&format!("{PRIMITIVE}/material"), json!(1), "material&out of range"),
            (&format!("{PRIMITIVE}/attributes"), json!({}), "no POSITION"),
            (&format!("{PRIMITIVE}/mode"), json!(7), "unknown mode"),
            (&format!("{PRIMITIVE}/indices"), json!(0), "indices&unsigned"),
            (&attribute("POSITION"), json!(2), "POSITION&VEC3"),
            ("/accessors/0/componentType", json!(UNSIGNED_INT), "16-bit integers"),
            ("/accessors/0/componentType", json!(5130), "32-bit float"),
            ("/accessors/0/type", json!("VEC2"), "VEC3"),
            ("/accessors/0/normalized", json!(true), "POSITION&32-bit float"),
            ("/accessors/1/normalized", json!(true), "NORMAL&32-bit float"),
            ("/accessors/2/normalized", json!(true), "indices&normalized"),
            ("/accessors/2/componentType", json!(FLOAT), "indices&unsigned"),
            ("/accessors/2/componentType", json!(5122), "indices&unsigned"),
            ("/accessors/2/type", json!("VEC2"), "SCALAR"),
        ],
    );
}

#[test]
fn ranges_of_accessors_and_views() {
    let huge = json!(u64::MAX);
    assert_faults(
        tetrahedron,
        &[
            ("/accessors/0/count", json!(5), "POSITION&5 elements&do not fit"),
            ("/accessors/0/count", huge.clone(), "do not fit"),
            ("/accessors/0/count", json!(u64::MAX / 12 + 2), "do not fit"),
            ("/accessors/0/count", json!(-1), "tiny.glb"),
            ("/accessors/0/count", json!(3), "NORMAL has 4&POSITION 3"),
            ("/accessors/1/count", json!(3), "NORMAL has 3&POSITION 4"),
            ("/accessors/0/byteOffset", json!(1), "do not fit"),
            ("/accessors/0/byteOffset", huge.clone(), "do not fit"),
            ("/accessors/0/bufferView", json!(99), "bufferView&out of range"),
            ("/accessors/0/bufferView", Value::Null, "no bufferView&compression"),
            ("/bufferViews/0/buffer", json!(1), "bufferView.buffer 1"),
            ("/bufferViews/0/byteLength", json!(47), "do not fit"),
            ("/bufferViews/0/byteLength", huge.clone(), "exceeds its buffer"),
            ("/bufferViews/0/byteOffset", huge.clone(), "exceeds its buffer"),
            ("/bufferViews/0/byteOffset", json!(1 << 20), "exceeds its buffer"),
            ("/bufferViews/0/byteStride", json!(0), "byteStride 0"),
            ("/bufferViews/0/byteStride", json!(8), "byteStride 8"),
            ("/bufferViews/0/byteStride", json!(13), "byteStride 13"),
            ("/bufferViews/0/byteStride", json!(16), "do not fit"),
            ("/bufferViews/0/byteStride", huge, "byteStride"),
        ],
    );
}

#[test]
fn sparse_accessors() {
    let sparse = || {
        let mut asset = tetrahedron();
        let (indices, values) = (asset.indices(&[3]), asset.vectors(&[[0.0, 0.0, 5.0]]));
        let indices = json!({ "bufferView": indices, "componentType": UNSIGNED_SHORT });
        let values = json!({ "bufferView": values });
        asset.set("/accessors/0/sparse", json!({ "count": 1, "indices": indices, "values": values }));
        assert!(asset.import().is_ok());
        asset
    };
    assert_faults(
        sparse,
        &[
            ("/accessors/0/sparse/count", json!(2), "POSITION: sparse&do not fit"),
            ("/accessors/0/sparse/count", json!(u64::MAX), "exceeds the 4 elements"),
            ("/accessors/0/sparse/indices/bufferView", json!(99), "out of range"),
            ("/accessors/0/sparse/indices/componentType", json!(FLOAT), "unsigned"),
            ("/accessors/0/sparse/values/bufferView", json!(99), "out of range"),
            ("/accessors/0/sparse/indices/byteOffset", json!(u64::MAX), "do not fit"),
        ],
    );
    let of_zeros = || {
        let mut asset = sparse();
        asset.set("/accessors/0/bufferView", Value::Null);
        asset
    };
    // Seen to catch: a limit that does not depend on the length of the file.
    for count in [1u64 << 10, 1 << 40] {
        assert_faults(of_zeros, &[("/accessors/0/count", json!(count), "POSITION&without a bufferView&at most")]);
    }
    let mut asset = sparse();
    let at = asset.json["bufferViews"][3]["byteOffset"].as_u64().expect("a number") as usize;
    asset.binary[at] = 4;
    assert!(fault(&asset).contains("the sparse index at 0"));
}

#[test]
fn nodes() {
    let matrix = |k: usize, value: f64| {
        let mut m = [1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0];
        m[k] = value;
        json!(m)
    };
    let both = json!({ "mesh": 0, "matrix": matrix(0, 1.0), "scale": [1, 1, 1] });
    assert_faults(
        tetrahedron,
        &[
            ("/nodes/0/mesh", json!(1), "node.mesh&out of range"),
            ("/nodes/2/camera", json!(1), "node.camera&out of range&`eye`"),
            ("/nodes/0/children", json!([9]), "node index 9"),
            ("/nodes/0/children", json!([0]), "`body`&tree"),
            ("/nodes/0/children", json!([1]), "`lamp`&tree"),
            ("/scenes/0/nodes", json!([0, 0]), "`body`&tree"),
            ("/scenes/0/nodes", json!([9]), "node index 9"),
            ("/scene", json!(1), "scene: index 1"),
            ("/nodes/0", both, "`node0`&excludes"),
            ("/nodes/0/matrix", matrix(15, 0.0), "`body`&last row"),
            ("/nodes/0/matrix", matrix(3, 0.5), "last row"),
            ("/nodes/0/matrix", json!([1, 2, 3]), "tiny.glb"),
            ("/nodes/0/rotation", json!([0, 0, 0, 0]), "`body`&quaternion"),
            ("/nodes/0/rotation", json!([1e200, 0, 0, 1e200]), "quaternion"),
            ("/nodes/0/scale", json!([1e308, 1e308, 1e308]), "too large for float32"),
            ("/nodes/0/scale", json!([2e18, 1, 1]), "too large for float32"),
            ("/nodes/0/translation", json!([1e308, 0, 0]), "too far&move it"),
            ("/nodes/0/translation", json!([1e10, 0, 0]), "too far"),
            ("/nodes/0/scale", json!([0, 0, 0]), "no area"),
            ("/nodes/0/scale", json!([0, 1, 0]), "no area"),
            ("/nodes/0", json!({}), "no triangles"),
            ("/nodes/0/skin", json!(0), "node.skin&out of range"),
            ("/meshes/0/primitives/0/targets", json!([{ "POSITION": 9 }]), "targets[0].POSITION&out of range"),
            ("/meshes/0/primitives", json!([]), "no triangles"),
        ],
    );
}

#[test]
fn lights() {
    const LIGHT: &str = "/extensions/KHR_lights_punctual/lights/0";
    let light = |key: &str| format!("{LIGHT}/{key}");
    let cone = |inner: f64, outer: f64| json!({ "innerConeAngle": inner, "outerConeAngle": outer });
    assert_faults(
        tetrahedron,
        &[
            (&light("type"), json!("disco"), "`lamp`&type"),
            (&light("spot"), Value::Null, "`lamp`&spot"),
            (&light("spot"), cone(0.6, 0.5), "`lamp`&innerConeAngle"),
            (&light("spot"), cone(-0.1, 0.5), "innerConeAngle"),
            (&light("spot"), cone(0.0, 2.0), "outerConeAngle"),
            (&light("spot"), cone(0.0, 0.0), "outerConeAngle"),
            (&light("spot"), cone(1.0, 0.785), "innerConeAngle"),
            (&light("range"), json!(0), "`lamp`&range"),
            (&light("range"), json!(-1), "range"),
            (&light("range"), json!(1e39), "range"),
            (&light("intensity"), json!(-1), "`lamp`&intensity"),
            (&light("intensity"), json!(1e39), "finite"),
            (&light("color"), json!([1, -1, 1]), "color"),
            (&light("color"), json!([1, 1]), "tiny.glb"),
            ("/nodes/1/extensions/KHR_lights_punctual/light", json!(1), "`lamp`&out of range"),
            ("/extensions", json!({}), "`lamp`&lights"),
            ("/nodes/1/scale", json!([0, 0, 0]), "`lamp`&scale 0"),
        ],
    );
}

#[test]
fn cameras() {
    assert_faults(
        tetrahedron,
        &[
            ("/nodes/2/scale", json!([0, 0, 0]), "`eye`&scale 0"),
            ("/cameras/0/perspective/yfov", json!(0), "`eye`&yfov"),
            ("/cameras/0/perspective/yfov", json!(-1), "yfov"),
            ("/cameras/0/perspective/yfov", json!(3.2), "yfov"),
            ("/cameras/0/perspective/yfov", json!(7), "yfov"),
            ("/cameras/0/perspective/yfov", json!(1e39), "yfov"),
            ("/cameras/0/perspective/yfov", Value::Null, "tiny.glb"),
            ("/cameras/0/perspective/aspectRatio", json!(0), "aspect ratio"),
            ("/cameras/0/type", json!("fisheye"), "`eye`&neither"),
            ("/cameras/0/type", json!("orthographic"), "neither"),
            ("/cameras/0/perspective", Value::Null, "neither"),
        ],
    );
    let orthographic = |xmag: f64, ymag: f64| {
        let mut asset = tetrahedron();
        let orthographic = json!({ "xmag": xmag, "ymag": ymag, "znear": 0, "zfar": 1 });
        asset.set("/cameras/0", json!({ "type": "orthographic", "orthographic": orthographic }));
        fault(&asset)
    };
    assert!(orthographic(1.0, 0.0).contains("ymag") && orthographic(1.0, -1.0).contains("ymag"));
    assert!(orthographic(0.0, 1.0).contains("aspect ratio"));
}

#[test]
fn materials_and_extensions() {
    let strength = |s: f64| json!({ "KHR_materials_emissive_strength": { "emissiveStrength": s } });
    let glowing = |s| json!({ "name": "lava", "emissiveFactor": [1, 1, 1], "extensions": strength(s) });
    assert_faults(
        tetrahedron,
        &[
            ("/materials/0", glowing(-1.0), "`lava`&emissive"),
            ("/materials/0", glowing(1e39), "emissive"),
            ("/materials/0/emissiveFactor", json!([-1, 0, 0]), "`wax`&emissive"),
            ("/materials/0/pbrMetallicRoughness", json!({ "baseColorFactor": [-1, 0, 0, 1] }), "baseColorFactor"),
            ("/materials", json!(vec![json!({}); 65536]), "materials: 65536"),
            ("/extensionsUsed", json!(["KHR_node_visibility"]), "KHR_node_visibility&hidden"),
            ("/extensionsRequired", json!(["ACME_wings"]), "ACME_wings&without it"),
        ],
    );
}

#[test]
fn numbers_in_the_buffer() {
    let with = |view: usize, element: usize, bytes: &[u8]| {
        let mut asset = tetrahedron();
        let at = asset.json["bufferViews"][view]["byteOffset"].as_u64().expect("a number") as usize;
        asset.binary[at + element * bytes.len()..][..bytes.len()].copy_from_slice(bytes);
        fault(&asset)
    };
    for bad in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
        let message = with(0, 4, &bad.to_le_bytes());
        assert!(message.contains("POSITION: element 1") && message.contains("repair"), "{message}");
        assert!(with(1, 11, &bad.to_le_bytes()).contains("NORMAL: element 3"));
    }
    let message = with(2, 7, &4u16.to_le_bytes());
    assert!(message.contains("the index at 7") && message.contains("4 vertices"), "{message}");
    assert!(with(2, 0, &u16::MAX.to_le_bytes()).contains("the index at 0"));
}

/// A buffer view must end within the buffer's `byteLength`, even if there are more bytes.
#[test]
fn bytes_beyond_the_buffer_do_not_belong_to_it() {
    let asset = tetrahedron();
    let mut document = asset.json.clone();
    document["buffers"] = json!([{ "byteLength": asset.binary.len() - 1 }]);
    let bytes = container(&[(b"JSON", document.to_string().as_bytes()), (b"BIN\0", &asset.binary)]);
    let message = import_bytes("tiny.glb", &bytes, &OPTIONS).err().expect("too short");
    assert!(message.contains("exceeds its buffer"), "{message}");
}

/// A small file with many instances of a large mesh is refused before memory is allocated.
#[test]
fn instances_are_counted_before_they_are_made() {
    let mut asset = tetrahedron();
    let indices = asset.indices(&[0, 1, 2].repeat(20_000));
    asset.set("/meshes/0/primitives/0/indices", json!(indices));
    let nodes: Vec<Value> = (0..4000).map(|_| json!({ "mesh": 0 })).collect();
    asset.set("/scenes/0/nodes", json!((0..4000).collect::<Vec<_>>()));
    asset.set("/nodes", json!(nodes));
    let start = std::time::Instant::now();
    let message = fault(&asset);
    assert!(message.contains("80000000 triangles") && message.contains("fewer instances"), "{message}");
    // Primitives without triangles take as long.
    let primitive = asset.json["meshes"][0]["primitives"][0].clone();
    let lines = json!({ "attributes": primitive["attributes"], "mode": 1 });
    let empty = asset.indices(&[]);
    let nothing = json!({ "attributes": primitive["attributes"], "indices": empty });
    asset.set("/meshes/0/primitives", json!(vec![nothing; 2000]));
    assert!(fault(&asset).contains("8000000 primitives"), "{}", fault(&asset));
    asset.set("/meshes/0/primitives", json!([vec![lines; 2000], vec![primitive]].concat()));
    let bench = Bench::new();
    let imported = Scene::import(&bench.write("lines.glb", asset.glb()), &OPTIONS);
    assert!(imported.is_err(), "the triangles are still too many");
    assert!(start.elapsed().as_secs() < 5, "{:?}", start.elapsed());
}

//! Files of other formats, and of glTF as programs write it: the message names the cause, and what is legal is read.

use serde_json::json;
use test_support::glb::{OPTIONS, container, fault, import_bytes, tetrahedron};

/// A binary STL of one triangle.
fn stl() -> Vec<u8> {
    [&[b' '; 80][..], &1u32.to_le_bytes(), &[0; 50]].concat()
}

/// Formats are told by their first bytes or, without such, by the name; the message says how to convert them.
///
/// Seen to catch: a parser's "expected value at line 1 column 1" for each of these; a binary STL that is not known.
#[test]
fn other_formats_are_named_with_the_way_to_gltf() {
    let stl = stl();
    let cases: [(&str, &[u8], &str, &str); 15] = [
        ("a.obj", b"# Blender\nv 0 0 0\n", "OBJ", "Blender"),
        ("a.glb", b"ply\nformat ascii 1.0\n", "PLY", "trimesh"),
        ("a.glb", b"solid cube\nfacet normal", "STL", "Blender"),
        ("a.glb", &stl, "STL", "Blender"),
        ("a.dat", b"Kaydara FBX Binary  \0\x1a\0", "FBX", "Blender"),
        ("a.dat", b"BLENDER-v300", "a Blender file", "export glTF"),
        ("a.dat", b"PXR-USDC\0", "USD", "Import"),
        ("a.dat", b"#usda 1.0", "USD", "Import"),
        ("a.usdz", b"PK\x03\x04aaaaaaaaaaaaaaaaaaaaaaaaaascene.usdc", "USD", "Import"),
        ("a.zip", b"PK\x03\x04aaaaaaaaaaaaaaaaaaaaaaaaaascene.gltf", "a packed folder", "unpack"),
        ("a.3ds", b"MM\0\0\0\0", "3DS", "assimp export"),
        ("a.dae", b"<?xml version=\"1.0\"?><COLLADA>", "COLLADA", "assimp export"),
        ("a.glb", b"version https://git-lfs.github.com/spec/v1\noid", "Git LFS", "git lfs pull"),
        ("a.glb", b"<!DOCTYPE html><html>", "a web page", "download"),
        ("a.glb", b"", "empty", "not a glTF file"),
    ];
    for (name, bytes, format, way) in cases {
        let message = import_bytes(name, bytes, &OPTIONS).err().unwrap_or_else(|| panic!("{name} was read"));
        for word in [name, "not a glTF file", format, way] {
            assert!(message.contains(word), "{name}, {format}: no `{word}` in: {message}");
        }
    }
    // The content counts, not the name.
    assert!(import_bytes("a.stl", &tetrahedron().glb(), &OPTIONS).is_ok());
    let text = import_bytes("a.gltf", b"no JSON", &OPTIONS).err().expect("it is no JSON");
    assert!(text.contains("not a glTF file") && text.contains("line 1"), "{text}");
}

/// Some writers do not fill the JSON up to a multiple of four bytes.
///
/// Seen to catch: the next chunk looked for behind padding that is not there.
#[test]
fn a_chunk_without_padding_is_read() {
    let asset = tetrahedron();
    let mut document = asset.json.clone();
    document["buffers"] = json!([{ "byteLength": asset.binary.len() }]);
    let mut text = document.to_string();
    while text.len() % 4 != 2 {
        text.push(' ');
    }
    let chunk = |kind: &[u8], content: &[u8]| [&(content.len() as u32).to_le_bytes(), kind, content].concat();
    let body = [chunk(b"JSON", text.as_bytes()), chunk(b"BIN\0", &asset.binary)].concat();
    let length = body.len() as u32 + 12;
    let bytes = [b"glTF".as_slice(), &2u32.to_le_bytes(), &length.to_le_bytes(), &body].concat();
    let scene = import_bytes("a.glb", &bytes, &OPTIONS).expect("it is read");
    assert_eq!(scene.mesh.triangles.len(), 4);
}

/// A scene that lists no nodes is legal; its file is shown whole, and one line says so. Where there are no nodes
/// either, nothing can be shown.
///
/// Seen to catch: "missing field `nodes`".
#[test]
fn scenes_without_nodes() {
    let mut asset = tetrahedron();
    asset.set("/scenes/0", json!({ "name": "Scene" }));
    let scene = asset.import().expect("it is legal");
    assert_eq!(scene.mesh.triangles.len(), 4);
    let said = scene.warnings.iter().filter(|w| w.contains("`Scene` lists no nodes")).count();
    assert_eq!(said, 1, "{:?}", scene.warnings);
    asset.set("/nodes", json!([]));
    assert!(fault(&asset).contains("no triangles"));
}

/// A channel without a node is ignored, as glTF says: extensions move other things than nodes.
///
/// Seen to catch: "missing field `node`".
#[test]
fn channels_without_nodes() {
    let mut asset = tetrahedron();
    let pointer = json!({ "KHR_animation_pointer": { "pointer": "/materials/0/emissiveFactor" } });
    let target = json!({ "path": "pointer", "extensions": pointer });
    let sampler = json!({ "input": 0, "output": 0 });
    let channels = json!([{ "sampler": 0, "target": target }]);
    asset.push("animations", json!({ "name": "glow", "channels": channels, "samplers": [sampler] }));
    asset.set("/extensionsUsed", json!(["KHR_animation_pointer"]));
    assert_eq!(asset.import().expect("it is legal").mesh.triangles.len(), 4);
}

/// A file that needs what is not supported says that, rather than what is missing without it.
///
/// Seen to catch: "buffers[0] has no uri" for an extension.
#[test]
fn the_cause_comes_before_the_symptom() {
    let mut document = tetrahedron().json;
    document["extensionsRequired"] = json!(["ACME_squeezed"]);
    document["buffers"] = json!([{ "byteLength": 1 << 20 }]);
    let bytes = container(&[(b"JSON", document.to_string().as_bytes())]);
    let message = import_bytes("a.glb", &bytes, &OPTIONS).err().expect("it is not supported");
    assert!(message.contains("ACME_squeezed") && !message.contains("uri"), "{message}");
}

/// Seen to catch: "invalid type: map" for the meshes of glTF 1.
#[test]
fn files_of_version_1_are_named() {
    let text = json!({ "asset": { "version": "1.0" }, "meshes": { "box": { "primitives": [] } } }).to_string();
    let message = import_bytes("a.gltf", text.as_bytes(), &OPTIONS).err().expect("it is not supported");
    assert!(message.contains("glTF 1") && message.contains("gltf-pipeline"), "{message}");
    let mut bytes = container(&[(b"JSON", text.as_bytes())]);
    bytes[4] = 1;
    let message = import_bytes("a.glb", &bytes, &OPTIONS).err().expect("it is not supported");
    assert!(message.contains("version 1") && message.contains("gltf-pipeline"), "{message}");
}

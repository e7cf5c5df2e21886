//! The files of a scene: containers, buffers beside them, data URIs, names.

use crate::import_textures::{encoded, textured, with_picture};
use base64::{Engine, engine::general_purpose::STANDARD};
use scene::Scene;
use serde_json::{Value, json};
use std::path::Path;
use test_support::{
    Bench,
    glb::{OPTIONS, container, import_bytes, tetrahedron},
};

/// The tetrahedron as a .gltf with these buffers.
fn gltf(buffers: Value) -> Vec<u8> {
    let mut document = tetrahedron().json;
    document["buffers"] = buffers;
    document.to_string().into_bytes()
}

/// Imports `scene.gltf` from a bench, with its buffer at `uri`.
fn import_in(bench: &Bench, uri: &str) -> Result<Scene, String> {
    let path = bench.write("my scene.gltf", gltf(json!([{ "uri": uri, "byteLength": tetrahedron().binary.len() }])));
    Scene::import(&path, &OPTIONS).map_err(|e| e.to_string())
}

#[test]
fn a_buffer_is_beside_the_scene_below_it_or_in_the_uri() {
    let binary = tetrahedron().binary;
    let names = [
        ("plain.bin", "plain.bin"),
        ("./plain.bin", "plain.bin"),
        ("with%20space.bin", "with space.bin"),
        ("with space.bin", "with space.bin"),
        ("%E9%87%91%C3%A9.bin", "金é.bin"),
        ("金é.bin", "金é.bin"),
        ("100%.bin", "100%.bin"),
        ("parts/deep/mesh.bin", "parts/deep/mesh.bin"),
    ];
    for (uri, file) in names {
        let bench = Bench::new();
        bench.write(file, &binary);
        let scene = import_in(&bench, uri).unwrap_or_else(|e| panic!("{uri}: {e}"));
        assert_eq!(scene.mesh.triangles.len(), 4, "{uri}");
    }
    let encoded = STANDARD.encode(&binary);
    for data in [&encoded, encoded.trim_end_matches('=')] {
        let uri = format!("data:application/octet-stream;base64,{data}");
        assert!(import_in(&Bench::new(), &uri).is_ok(), "{uri}");
    }
}

#[test]
fn a_missing_or_short_buffer_is_named_with_the_scene() {
    let bench = Bench::new();
    let message = import_in(&bench, "gone%20away.bin").err().expect("the file is missing");
    for word in ["my scene.gltf", "buffers[0].uri", "gone away.bin", "beside it"] {
        assert!(message.contains(word), "{word}: {message}");
    }
    bench.write("short.bin", &tetrahedron().binary[1..]);
    let message = import_in(&bench, "short.bin").err().expect("the file is short");
    assert!(message.contains("truncated") && message.contains("byteLength"), "{message}");
}

#[test]
fn nothing_outside_the_folder_is_read() {
    let outer = Bench::new();
    outer.write("secret.bin", &tetrahedron().binary);
    let uri = outer.path("secret.bin").display().to_string();
    let (encoded, url) = (uri.replace('/', "%2F"), format!("file://{uri}"));
    for uri in [&uri, &encoded, &url, "../secret.bin", "a/../../secret.bin", "%2e%2e/secret.bin", "", ".", "x:///y"] {
        let bench = Bench::new();
        let message = import_in(&bench, uri).err().unwrap_or_else(|| panic!("`{uri}` was read"));
        assert!(message.contains("not a file in the scene's folder"), "{uri}: {message}");
    }
}

#[test]
fn odd_uris_are_faults() {
    let cases = [
        ("data:application/octet-stream,abc", "base64"),
        ("data:application/octet-stream;base64,*", "base64"),
        ("data:", "base64"),
        ("%FF%FE.bin", "UTF-8"),
        ("a%00b.bin", "my scene.gltf"),
        ("folder", "not a regular file"),
    ];
    for (uri, word) in cases {
        let bench = Bench::new();
        bench.write("folder/inside", b"");
        let message = import_in(&bench, uri).err().unwrap_or_else(|| panic!("`{uri}` was read"));
        assert!(message.contains(word), "{uri}: {message}");
    }
}

/// A file that thousands of buffers name is read once.
#[test]
fn one_file_is_read_once() {
    let bench = Bench::new();
    let binary = tetrahedron().binary;
    let mut large = binary.clone();
    large.resize(4 << 20, 0);
    bench.write("mesh.bin", &large);
    let buffers: Vec<Value> = (0..4000).map(|_| json!({ "uri": "./mesh.bin", "byteLength": 4 << 20 })).collect();
    let path = bench.write("many.gltf", gltf(json!(buffers)));
    let start = std::time::Instant::now();
    assert!(Scene::import(&path, &OPTIONS).is_ok());
    assert!(start.elapsed().as_secs() < 5, "16 GiB would take longer");
}

/// The files of a scene's folder may be links. Their targets are read like files, and their content appears in no
/// message.
///
/// Seen to catch: the decoder's message, with bytes of the file; the value of an index or number in a message.
#[cfg(unix)]
#[test]
fn links_are_followed_and_messages_do_not_show_what_is_there() {
    let (outer, bench) = (Bench::new(), Bench::new());
    let link = |name: &str, content: &[u8]| {
        let path = outer.write(name, content);
        std::os::unix::fs::symlink(path, bench.path(name)).expect("a link");
    };
    link("mesh.bin", &tetrahedron().binary);
    let scene = import_in(&bench, "mesh.bin").expect("links are followed");
    assert_eq!(scene.files[1], bench.path("mesh.bin"));
    let mut asset = with_picture(&[], textured(json!({})), json!({}));
    let starts: [(&str, &[u8]); 3] =
        [("a.png", b"\x89PNG\r\n\x1a\n\0\0\0\x04"), ("b.jpg", b"\xff\xd8\xff"), ("c.txt", b"")];
    for (name, start) in starts {
        link(name, &[start, b"root:x:0:0:root:/root:/bin/bash"].concat());
        asset.set("/images/0", json!({ "uri": name }));
        let path = bench.write("picture.glb", asset.glb());
        let scene = Scene::import(&path, &OPTIONS).expect("only opaque surfaces need it");
        let message = scene.check_textures(|_| false).expect_err("no picture").to_string();
        let (_, said) = message.split_once(&format!("`{name}`: ")).expect("the image's name");
        let known = [
            "the picture is damaged or of a kind that is not supported; export it as PNG, JPEG or WebP again",
            "neither a PNG, a JPEG nor a WebP picture; export it as PNG, JPEG or WebP",
        ];
        assert!(known.contains(&said), "{said}");
    }
    // A link to its own folder gives a file any number of paths; it is read once.
    std::os::unix::fs::symlink(".", bench.path("d")).expect("a link");
    let uris = ["mesh.bin", "d/mesh.bin", "d/d/mesh.bin"];
    let buffers = uris.map(|uri| json!({ "uri": uri, "byteLength": tetrahedron().binary.len() }));
    let path = bench.write("round.gltf", gltf(json!(buffers)));
    assert_eq!(Scene::import(&path, &OPTIONS).expect("a good file").files.len(), 2);
    let good = tetrahedron();
    let secret = 7654321.0f32;
    let numbers: [(usize, Vec<u8>, &str); 2] = [
        (0, [secret.to_le_bytes(), f32::NAN.to_le_bytes()].concat(), "POSITION: element 0 is not finite"),
        (96, 54321u16.to_le_bytes().to_vec(), "indices: the index at 0 is out of range"),
    ];
    for (k, (at, bytes, words)) in numbers.into_iter().enumerate() {
        let mut binary = good.binary.clone();
        binary[at..at + bytes.len()].copy_from_slice(&bytes);
        link(&format!("{k}.bin"), &binary);
        let message = import_in(&bench, &format!("{k}.bin")).err().expect("a bad number");
        assert!(message.contains(words) && !message.contains("54321"), "{message}");
    }
}

/// Programs refuse to write over their inputs. The list has each file once, by the path at which it was opened.
#[test]
fn every_file_that_was_read_is_told() {
    let bench = Bench::new();
    let mut asset = with_picture(&[], textured(json!({})), json!({}));
    asset.set("/images/0", json!({ "uri": "skin%20one.png" }));
    asset.push("images", json!({ "uri": "./skin%20one.png" }));
    asset.push("images", json!({ "uri": "unused.png" }));
    let second = asset.push("textures", json!({ "source": 1 }));
    let mut material = textured(json!({}));
    material["pbrMetallicRoughness"]["baseColorTexture"]["index"] = json!(second);
    asset.push("materials", material);
    bench.write("parts/mesh.bin", &asset.binary);
    bench.write("more.bin", &asset.binary);
    bench.write("skin one.png", encoded(&image::RgbaImage::new(2, 2), image::ImageFormat::Png));
    let buffer = |uri: &str| json!({ "uri": uri, "byteLength": asset.binary.len() });
    let buffers = ["parts/mesh.bin", "parts/./mesh.bin", "more.bin"].map(buffer);
    asset.json["buffers"] = json!(buffers);
    let path = bench.write("scene.gltf", asset.json.to_string().as_bytes());
    let scene = Scene::import(&path, &OPTIONS).expect("a good file");
    let expected = ["scene.gltf", "parts/mesh.bin", "more.bin", "skin one.png"].map(|name| bench.path(name));
    assert_eq!(scene.files, expected);
    let path = bench.write("alone.glb", tetrahedron().glb());
    assert_eq!(Scene::import(&path, &OPTIONS).expect("a good file").files, [path]);
}

#[test]
fn a_byte_order_mark_is_no_fault() {
    let mut bytes = b"\xef\xbb\xbf".to_vec();
    bytes.extend(gltf(json!([{
        "uri": format!("data:;base64,{}", STANDARD.encode(tetrahedron().binary)),
        "byteLength": tetrahedron().binary.len(),
    }])));
    assert!(import_bytes("marked.gltf", &bytes, &OPTIONS).is_ok());
}

#[test]
fn chunks_of_other_kinds_are_ignored() {
    let asset = tetrahedron();
    let mut document = asset.json.clone();
    document["buffers"] = json!([{ "byteLength": asset.binary.len() }]);
    let text = document.to_string().into_bytes();
    let after = container(&[(b"JSON", &text), (b"BIN\0", &asset.binary), (b"MORE", b"anything")]);
    assert!(import_bytes("after.glb", &after, &OPTIONS).is_ok());
    let instead = container(&[(b"JSON", &text), (b"MORE", &asset.binary)]);
    let message = import_bytes("instead.glb", &instead, &OPTIONS).err().expect("no buffer");
    assert!(message.contains("no binary chunk"), "{message}");
}

/// Each length field of the header at its extremes.
#[test]
fn wrong_lengths_in_the_container_are_faults() {
    let good = tetrahedron().glb();
    let json_length = u32::from_le_bytes([good[12], good[13], good[14], good[15]]);
    let binary_at = 20 + json_length as usize;
    for at in [8, 12, binary_at] {
        let own = u32::from_le_bytes([good[at], good[at + 1], good[at + 2], good[at + 3]]);
        for value in [0, 1, 11, own - 4, own + 1, own + 4, 1 << 31, u32::MAX - 7, u32::MAX] {
            let mut bytes = good.clone();
            bytes[at..at + 4].copy_from_slice(&value.to_le_bytes());
            let message = import_bytes("bad.glb", &bytes, &OPTIONS).err();
            let message = message.unwrap_or_else(|| panic!("{value} at byte {at} was accepted"));
            assert!(message.contains("bad.glb"), "{message}");
        }
    }
    let bench = Bench::new();
    for length in 0..good.len() {
        let cut = Scene::import(&bench.write(&format!("cut-{length}.glb"), &good[..length]), &OPTIONS);
        assert!(cut.err().is_some_and(|e| e.to_string().contains("cut-")), "{length} bytes were accepted");
    }
}

#[test]
fn what_is_no_gltf_at_all() {
    let deep = [b"[".repeat(100_000), b"]".repeat(100_000)].concat();
    let extras = [b"{\"asset\":{\"version\":\"2.0\"},\"extras\":".to_vec(), deep.clone(), b"}".to_vec()].concat();
    let cases: [(&[u8], &str); 8] = [
        (b"", "not a glTF"),
        (b"v 0 0 0\nf 1 1 1\n", "not a glTF"),
        (b"glTF", "truncated"),
        (b"glTF\x01\0\0\0\x0c\0\0\0", "version 1"),
        (&deep, "not a glTF"),
        (&extras, "no.gltf"),
        (br#"{"asset":{"version":"1.0"}}"#, "glTF 2"),
        (br#"{"asset":{"version":"2.1","minVersion":"2.1"}}"#, "minVersion"),
    ];
    for (bytes, word) in cases {
        let message = import_bytes("no.gltf", bytes, &OPTIONS).err().expect("it is none");
        assert!(message.contains("no.gltf") && message.contains(word), "{word}: {message:.200}");
    }
    let bench = Bench::new();
    let missing = bench.path("missing.glb");
    let message = Scene::import(&missing, &OPTIONS).err().expect("missing").to_string();
    assert!(message.contains("missing.glb"), "{message}");
    // A device or a pipe could be endless.
    for path in [bench.folder(), Path::new("/dev/zero")] {
        let message = Scene::import(path, &OPTIONS).err().expect("no file").to_string();
        assert!(!path.exists() || message.contains("not a regular file"), "{message}");
    }
}

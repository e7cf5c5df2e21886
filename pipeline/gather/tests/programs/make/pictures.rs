//! Pictures are of the files that were named, as these are now.

use super::{IMAGES, Tree, medium, sky, view};
use serde_json::json;
use std::{fs, os::unix::fs::PermissionsExt};
use test_support::data;

/// If two files have one name, the one that was named last counts, even if it is the older one. Seen to fail where
/// targets depended on files by their times: each of these left the picture of the other file.
#[test]
fn a_picture_is_of_the_file_that_was_named() {
    let tree = Tree::new();
    tree.scene("a/thing.gltf", 1.0);
    let other = tree.scene("b/thing.gltf", 2.0);
    tree.write("a/s.json", view(0.5));
    let start = ["SCENE=a/thing.gltf", "VIEWS=a/s.json", "MEDIUM=marble"];
    tree.make(&start);
    let image = format!("{IMAGES}/s.exr");
    tree.remakes(&image, &["SCENE=b/thing.gltf", "VIEWS=a/s.json", "MEDIUM=marble"], || {
        tree.write_old("b/thing.gltf", &other);
    });
    tree.remakes(&image, &["SCENE=b/thing.gltf", "VIEWS=b/s.json", "MEDIUM=marble"], || {
        tree.write_old("b/s.json", view(0.6));
    });
}

/// The same holds for media and environments, and for a file that is replaced by an older one.
#[test]
fn a_picture_is_of_the_medium_and_the_environment_that_were_named() {
    let tree = Tree::new();
    tree.scene("thing.gltf", 1.0);
    tree.write("s.json", view(0.5));
    tree.write("a/m.json", medium(1.0));
    tree.write("sky.exr", sky(0.1));
    let image = "out/thing/k500-s0/m-half-space/s.exr";
    tree.make(&["SCENE=thing.gltf", "VIEWS=s.json", "MEDIUM=a/m.json", "ENVIRONMENT=sky.exr"]);
    let arguments = ["SCENE=thing.gltf", "VIEWS=s.json", "MEDIUM=b/m.json", "ENVIRONMENT=sky.exr"];
    tree.remakes(image, &arguments, || tree.write_old("b/m.json", medium(2.0)));
    tree.remakes(image, &arguments, || tree.write_old("sky.exr", sky(0.7)));
    // This file has the size and the time of the last one.
    tree.remakes(image, &arguments, || tree.write_old("b/m.json", medium(3.0)));
}

/// A picture depends on the files that a .gltf names. Seen to fail where a picture depended on the .gltf alone.
#[test]
fn a_picture_is_of_what_the_scene_names() {
    let tree = Tree::new();
    tree.scene("a/thing.gltf", 1.0);
    let arguments = ["SCENE=a/thing.gltf", "MEDIUM=marble", "VIEWS=s.json"];
    tree.write("s.json", view(0.5));
    tree.make(&arguments);
    let mesh = fs::read(tree.path("a/thing of  parts.bin")).expect("reads");
    // Positions are the first 36888 bytes: all of them times two.
    let larger: Vec<u8> = mesh[..36888]
        .as_chunks::<4>()
        .0
        .iter()
        .flat_map(|x| (2.0 * f32::from_le_bytes(*x)).to_le_bytes())
        .chain(mesh[36888..].iter().copied())
        .collect();
    tree.remakes(&format!("{IMAGES}/s.exr"), &arguments, || tree.write_old("a/thing of  parts.bin", larger));
    tree.write("a/card.png", "another");
    assert_eq!(tree.make(&arguments).made(), ["sample-surface", "calibrate", "gather"], "a texture changed");
    fs::remove_file(tree.path("a/card.png")).expect("removes");
    assert_eq!(tree.make(&arguments).made(), ["sample-surface", "calibrate", "gather"], "a texture is gone");
    assert!(tree.make(&arguments).made().is_empty());
}

/// Seen to fail where the OpenEXR image stood for its .png, and a list of views for its images.
#[test]
fn what_was_removed_is_made_again() {
    let tree = Tree::new();
    tree.scene("thing.gltf", 1.0);
    tree.write("s.json", view(0.5));
    let [mut near, mut far] =
        [0.4, 0.5].map(|height| serde_json::from_str::<serde_json::Value>(&view(height)).expect("JSON"));
    (near["name"], far["name"]) = ("near".into(), "far".into());
    tree.write("list.json", json!([near, far]).to_string());
    let arguments = ["SCENE=thing.gltf", "VIEWS=s.json list.json"];
    tree.make(&arguments);
    assert_eq!(tree.bytes(&format!("{IMAGES}/list.views")), b"list.near.exr\nlist.far.exr\n");
    for lost in ["s.png", "list.near.exr", "list.far.png", "list.views"] {
        fs::remove_file(tree.path(IMAGES).join(lost)).expect("removes");
        assert_eq!(tree.make(&arguments).made(), ["gather"], "{lost}");
        assert!(tree.path(IMAGES).join(lost).exists(), "{lost}");
        assert!(tree.make(&arguments).made().is_empty(), "{lost}");
    }
}

/// The cameras are those of the scene that was named, not of its younger namesake.
#[test]
fn cameras_are_of_the_scene_that_was_named() {
    let tree = Tree::new();
    tree.scene("a/thing.gltf", 1.0);
    let mut other: serde_json::Value = serde_json::from_slice(&tree.scene("b/thing.gltf", 1.0)).expect("JSON");
    other["nodes"][0]["camera"] = 0.into();
    tree.write_old("b/thing.gltf", other.to_string());
    for (scene, cameras) in [("a", "CAMERAS += 0\n"), ("b", "CAMERAS += 0\nCAMERAS += 1\n")] {
        tree.make(&[&format!("SCENE={scene}/thing.gltf"), "out/thing/k500-s0.cameras"]);
        assert_eq!(String::from_utf8_lossy(&tree.bytes("out/thing/k500-s0.cameras")), cameras);
    }
}

/// The gallery and the images of `make check`, of one scene. Seen to fail where the .png stood for nothing, where an
/// older picture in the place of the environment changed nothing, and where the sheet of one model stayed for another.
#[test]
fn the_gallery_is_of_what_it_was_made_from() {
    let tree = Tree::new();
    let slab = fs::read(data("scenes/slab.glb")).expect("reads");
    tree.write("data/scenes/thing.glb", slab);
    tree.write("data/views/thing/s.json", view(0.5));
    tree.write("data/media/m.json", medium(1.0));
    tree.write("sky.exr", sky(0.1));
    tree.write("target/release/contact-sheet", "#!/bin/sh\nfor sheet; do :; done\necho \"$@\" > \"$sheet\"\n");
    let executable = fs::Permissions::from_mode(0o755);
    fs::set_permissions(tree.path("target/release/contact-sheet"), executable).expect("sets a mode");
    let before = tree.files();
    let made = |arguments: &[&str], programs: &[&str]| {
        let all = [&["GALLERY=thing:m", "ENVIRONMENT_thing=sky.exr"], arguments].concat();
        assert_eq!(tree.make(&all).made(), programs, "{arguments:?}");
        assert!(tree.make(&all).made().is_empty(), "{arguments:?}");
    };
    made(&[], &["sample-surface", "calibrate", "gather", "contact-sheet"]);
    fs::remove_file(tree.path("out/thing/k500-s0/m-half-space/s.png")).expect("removes");
    made(&[], &["gather", "contact-sheet"]);
    tree.write_old("sky.exr", sky(0.7));
    made(&[], &["sample-surface", "calibrate", "gather", "contact-sheet"]);
    made(&["MODEL=standard-dipole"], &["gather", "contact-sheet"]);
    made(&[], &["contact-sheet"]);
    made(&["CALIBRATE=no"], &["gather", "contact-sheet"]);
    made(&[], &["gather", "contact-sheet"]);
    made(&["WALKS=400"], &["calibrate", "gather", "contact-sheet"]);

    let check = ["check-images", "CHECK_COUNT=1", "CHECK_SAMPLES=500", "CHECK_SPP=1", "CHECK_SIZE=8"];
    made(&check, &["sample-surface", "gather"]);
    made(&[&check[..], &["ENVIRONMENT_thing=1,1,1"]].concat(), &["sample-surface", "gather"]);
    tree.write_old("data/media/m.json", medium(2.0));
    made(&[&check[..], &["ENVIRONMENT_thing=1,1,1"]].concat(), &["gather"]);
    tree.make(&["clean", "GALLERY=thing:m"]);
    assert_eq!(tree.files(), before);
}

/// A scene without cameras has a picture from the front and one against the light, of the size that was asked for.
#[test]
fn a_scene_without_cameras_is_seen_by_those_that_are_made() {
    let tree = Tree::new();
    tree.scene("thing.gltf", 1.0);
    let mut root: serde_json::Value =
        serde_json::from_slice(&fs::read(tree.path("thing.gltf")).expect("reads")).expect("JSON");
    root.as_object_mut().expect("an object").remove("cameras");
    for node in root["nodes"].as_array_mut().expect("nodes") {
        node.as_object_mut().expect("an object").remove("camera");
    }
    tree.write("thing.gltf", root.to_string());
    let arguments = ["SCENE=thing.gltf", "MEDIUM=marble", "CALIBRATE=no", "SPP=1", "SIZE=0.01"];
    assert_eq!(tree.make(&arguments).made(), ["sample-surface", "gather", "gather"]);
    for name in ["front.exr", "front.png", "backlit.exr", "backlit.png"] {
        assert!(tree.path(IMAGES).join(name).exists(), "{name}");
    }
    assert!(tree.make(&arguments).made().is_empty());
    let larger = ["SCENE=thing.gltf", "MEDIUM=marble", "CALIBRATE=no", "SPP=1", "SIZE=0.02"];
    assert_eq!(tree.make(&larger).made(), ["sample-surface", "gather", "gather"]);
    let backdrop = [&larger[..], &["BACKDROP=yes"]].concat();
    assert_eq!(tree.make(&backdrop).made(), ["gather", "gather"]);
}

/// TIME and ANIMATION pose the scene, whatever characters a name has, and a picture of another pose is made again.
#[test]
fn a_picture_is_of_the_pose_that_was_asked_for() {
    let tree = Tree::new();
    let text = tree.scene("thing.gltf", 1.0);
    let mut root: serde_json::Value = serde_json::from_slice(&text).expect("JSON");
    let floats = [0.0f32, 1.0, 0.0, 0.0, 0.0, 0.001, 0.0, 0.0];
    tree.write("pose.bin", floats.iter().flat_map(|x| x.to_le_bytes()).collect::<Vec<u8>>());
    let push = |list: &mut serde_json::Value, item: serde_json::Value| {
        list.as_array_mut().expect("a list").push(item);
        list.as_array().map_or(0, Vec::len) - 1
    };
    let buffer = push(&mut root["buffers"], json!({ "uri": "pose.bin", "byteLength": 32 }));
    let accessor = |root: &mut serde_json::Value, offset: u32, length: u32, kind: &str| {
        let view = json!({ "buffer": buffer, "byteOffset": offset, "byteLength": length });
        let view = push(&mut root["bufferViews"], view);
        let fields = json!({ "bufferView": view, "componentType": 5126, "count": 2, "type": kind });
        push(&mut root["accessors"], fields)
    };
    let (input, output) = (accessor(&mut root, 0, 8, "SCALAR"), accessor(&mut root, 8, 24, "VEC3"));
    root["accessors"][input]["min"] = json!([0.0]);
    root["accessors"][input]["max"] = json!([1.0]);
    let node = root["nodes"].as_array().expect("nodes").iter().position(|n| n.get("mesh").is_some()).expect("a mesh");
    root["animations"] = json!([{
        "name": "walk|on it", "samplers": [{ "input": input, "output": output }],
        "channels": [{ "sampler": 0, "target": { "node": node, "path": "translation" } }],
    }]);
    tree.write("thing.gltf", root.to_string());
    let at_rest = ["SCENE=thing.gltf", "MEDIUM=marble", "CALIBRATE=no", "SPP=1"];
    let pose = || {
        let image = fs::read(tree.path(IMAGES).join("camera0.exr")).expect("reads");
        let image = formats::Image::decode(&image).expect("an image");
        image.attributes.get("pcsss/pose").map(|pose| format!("{pose:?}"))
    };
    assert_eq!(tree.make(&at_rest).made(), ["sample-surface", "gather"]);
    assert_eq!(pose(), None);
    let half = [&at_rest[..], &["TIME=0.5", "ANIMATION=walk|on it"]].concat();
    assert_eq!(tree.make(&half).made(), ["sample-surface", "gather"]);
    assert!(pose().is_some_and(|pose| pose.contains("walk|on it") && pose.contains("0.5")), "{:?}", pose());
    assert!(tree.make(&half).made().is_empty());
    let end = [&at_rest[..], &["TIME=1"]].concat();
    assert_eq!(tree.make(&end).made(), ["sample-surface", "gather"]);
}

/// Without MEDIUM, a file that states the media of its surfaces is rendered in these, and another one in marble.
///
/// Seen to catch: marble for every file.
#[test]
fn media_of_the_file_need_no_medium() {
    let tree = Tree::new();
    tree.scene("thing.gltf", 1.0);
    let arguments = ["SCENE=thing.gltf", "CALIBRATE=no", "SPP=1"];
    tree.make(&arguments);
    assert!(tree.path(IMAGES).join("camera0.exr").exists());
    let mut root: serde_json::Value =
        serde_json::from_slice(&fs::read(tree.path("thing.gltf")).expect("reads")).expect("JSON");
    for material in root["materials"].as_array_mut().expect("materials") {
        material["extras"] = json!({ "medium": "skin1" });
    }
    tree.write("thing.gltf", root.to_string());
    tree.make(&arguments);
    let own = tree.path("out/thing/k500-s0/own-half-space/camera0.exr");
    let image = formats::Image::decode(&fs::read(own).expect("reads")).expect("an image");
    let text = format!("{:?}", image.attributes);
    assert!(text.contains("skin1") && !text.contains("marble"), "{text}");
}

//! EXT_mesh_gpu_instancing: copies of a mesh.

use crate::import_poses::{assert_close, corners, volume, world};
use scene::DVec3;
use serde_json::{Value, json};
use test_support::glb::{Asset, FLOAT, fault, tetrahedron};

/// The tetrahedron at these places.
fn copies(places: Value) -> Asset {
    let mut asset = tetrahedron();
    asset.set("/nodes/0/extensions", json!({ "EXT_mesh_gpu_instancing": { "attributes": places } }));
    asset.set("/extensionsRequired", json!(["EXT_mesh_gpu_instancing"]));
    asset
}

/// Copies are placed, turned and scaled, and then go with their node.
///
/// Seen to catch: the node's transform before that of the copy.
#[test]
fn copies_have_places_of_their_own() {
    let mut asset = copies(json!({}));
    let places = asset.vectors(&[[0.0; 3], [4.0, 0.0, 0.0], [0.0, 4.0, 0.0]]);
    let sizes = asset.vectors(&[[1.0; 3], [2.0; 3], [1.0, 1.0, -1.0]]);
    let attributes = json!({ "TRANSLATION": places, "SCALE": sizes, "_ID": 0 });
    asset.set("/nodes/0/extensions/EXT_mesh_gpu_instancing/attributes", attributes);
    asset.set("/nodes/0/translation", json!([0, 0, 7]));
    let scene = asset.import().expect("a good file");
    assert!(scene.warnings.is_empty(), "{:?}", scene.warnings);
    let place = |scale: DVec3, to: DVec3| move |p: DVec3| p * scale + to + DVec3::Z * 7.0;
    let one = corners().into_iter().map(place(DVec3::ONE, DVec3::ZERO));
    let two = corners().into_iter().map(place(DVec3::splat(2.0), DVec3::X * 4.0));
    let three = corners().into_iter().map(place(DVec3::new(1.0, 1.0, -1.0), DVec3::Y * 4.0));
    assert_close(&world(&scene), &one.chain(two).chain(three).collect::<Vec<_>>());
    assert!((volume(&scene) - 10.0 / 6.0).abs() < 1e-6, "the mirrored copy is wound outwards: {}", volume(&scene));
    assert_eq!(copies(json!({})).import().expect("one copy").mesh.triangles.len(), 4);
}

/// Nodes that share the places of many copies are counted before anything is made.
///
/// Seen to catch: gigabytes for the triangles of all copies.
#[test]
fn copies_are_counted_before_they_are_made() {
    let mut asset = copies(json!({}));
    let places = asset.vectors(&vec![[0.0; 3]; 100_000]);
    let node = json!({ "mesh": 0, "extensions": { "EXT_mesh_gpu_instancing": { "attributes": { "SCALE": places } } } });
    for _ in 0..3000 {
        asset.node(node.clone());
    }
    let start = std::time::Instant::now();
    assert!(fault(&asset).contains("1200000004 triangles"), "{}", fault(&asset));
    assert!(start.elapsed().as_secs() < 5, "{:?}", start.elapsed());
    let turns = asset.accessor(&[0; 32], "VEC4", FLOAT, 2);
    let two = asset.vectors(&[[0.0; 3]; 2]);
    for (attributes, word) in [
        (json!({ "ROTATION": turns }), "no unit quaternion"),
        (json!({ "TRANSLATION": two, "SCALE": places }), "different numbers"),
        (json!({ "TRANSLATION": turns }), "TRANSLATION"),
        (json!({ "TRANSLATION": 99 }), "out of range"),
    ] {
        let mut asset = asset.clone();
        asset.set("/scenes/0/nodes", json!([0]));
        asset.set("/nodes/0/extensions/EXT_mesh_gpu_instancing/attributes", attributes);
        let message = fault(&asset);
        assert!(message.contains(word) && message.contains("`body`"), "{message}");
    }
}

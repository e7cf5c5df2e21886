//! Work that a short file can cause: time and memory grow with the length of the file, and not with the number of
//! references.

use crate::import_textures::{encoded, textured, with_picture};
use image::{ImageFormat, RgbaImage};
use scene::Scene;
use serde_json::{Value, json};
use std::{
    sync::Arc,
    time::{Duration, Instant},
};
use test_support::glb::{Asset, UNSIGNED_SHORT, fault, tetrahedron};

/// Longest time of the files below, on any machine. With the errors named it is several times as long.
const SOON: Duration = Duration::from_secs(15);

/// Imports a good file within the time limit.
fn import_soon(asset: &Asset) -> Scene {
    let start = Instant::now();
    let scene = asset.import().expect("a good file");
    assert!(start.elapsed() < SOON, "{:?}", start.elapsed());
    scene
}

/// Materials with these images, each with a texture of its own.
fn of_images(asset: &mut Asset, images: Vec<Value>) {
    let textures: Vec<Value> = (0..images.len()).map(|k| json!({ "source": k })).collect();
    let material = |k: usize| {
        let mut material = textured(json!({}));
        material["pbrMetallicRoughness"]["baseColorTexture"]["index"] = json!(k);
        material
    };
    let materials: Vec<Value> = (0..images.len()).map(material).collect();
    asset.json["images"] = json!(images);
    asset.json["textures"] = json!(textures);
    asset.json["materials"] = json!(materials);
    let mut primitive = asset.json["meshes"][0]["primitives"][0].take();
    let mut with = |k: usize| {
        primitive["material"] = json!(k);
        primitive.clone()
    };
    asset.json["meshes"][0]["primitives"] = (0..images.len()).map(&mut with).collect();
}

/// Seen to catch: equal images that are each decoded, and hashed once more for each material.
#[test]
fn a_picture_that_many_images_name_is_decoded_once() {
    let png = encoded(&RgbaImage::new(9, 9), ImageFormat::Png);
    let mut asset = with_picture(&png, textured(json!({})), json!({}));
    let view = asset.json["images"][0]["bufferView"].clone();
    of_images(&mut asset, vec![json!({ "bufferView": view }); 5]);
    let shared = asset.import().expect("a good file").geometry_digest();
    let pictures: Vec<_> =
        asset.import().expect("a good file").materials.into_iter().filter_map(|m| m.base_texture).collect();
    assert!(pictures.len() == 5 && pictures.iter().all(|t| Arc::ptr_eq(&t.picture, &pictures[0].picture)));
    // The digest of the scene distinguishes pictures of the same size.
    let other = encoded(&RgbaImage::from_pixel(9, 9, image::Rgba([1; 4])), ImageFormat::Png);
    let more = json!({ "buffer": 0, "byteOffset": asset.binary.len(), "byteLength": other.len() });
    asset.binary.extend(other);
    let more = asset.push("bufferViews", more);
    let mut digest = |uses: [usize; 5]| {
        let view = |own: usize| if own == 0 { view.clone() } else { json!(more) };
        of_images(&mut asset, uses.map(|own| json!({ "bufferView": view(own) })).into());
        asset.import().expect("a good file").geometry_digest()
    };
    let digests = [[0; 5], [0, 1, 0, 0, 0], [0, 1, 1, 0, 0], [0, 0, 1, 0, 0], [1; 5]].map(&mut digest);
    assert_eq!(digests[0], shared);
    assert!((0..5).all(|k| !digests[..k].contains(&digests[k])));
}

/// Views of the same bytes, each a byte longer than the last, are as many pictures. Seen to catch: no limit.
#[test]
fn pictures_do_not_overlap() {
    let pixels = RgbaImage::from_fn(64, 64, |x, y| image::Rgba([x as u8, y as u8, (x * y) as u8, 255]));
    let png = encoded(&pixels, ImageFormat::Png);
    let mut asset = with_picture(&png, textured(json!({})), json!({}));
    let first = asset.json["images"][0]["bufferView"].as_u64().expect("a number") as usize;
    let mut view = asset.json["bufferViews"][first].clone();
    let start = view["byteOffset"].as_u64().expect("a number");
    asset.binary.extend([0; 8]);
    view["byteLength"] = json!(png.len() + 1);
    let second = asset.push("bufferViews", view.clone());
    of_images(&mut asset, vec![json!({ "bufferView": first }), json!({ "bufferView": second })]);
    let overlap = asset.import().expect("a good file").check_textures(|_| false).expect_err("they overlap").to_string();
    assert!(png.len() > 500 && overlap.contains("images[1]: the bufferViews of the images overlap"), "{overlap}");
    // A copy is another picture.
    let copy = asset.binary[start as usize..start as usize + png.len()].to_vec();
    asset.json["bufferViews"][second]["byteOffset"] = json!(asset.binary.len());
    asset.json["bufferViews"][second]["byteLength"] = json!(png.len());
    asset.binary.extend(copy);
    asset.import().expect("a good file").check_textures(|_| false).expect("they are apart");
}

/// Pictures that fail at their end, where all work is done: each is tried once, and not many are.
///
/// Seen to catch: failures that are tried again for each material; no limit of failures.
#[test]
fn damaged_pictures_are_tried_once() {
    let png = encoded(&RgbaImage::new(4096, 4096), ImageFormat::Png);
    let cut = &png[..png.len() - 30];
    let mut asset = with_picture(cut, textured(json!({})), json!({}));
    let first = asset.json["images"][0]["bufferView"].clone();
    let other = |asset: &mut Asset| {
        let view = json!({ "buffer": 0, "byteOffset": asset.binary.len(), "byteLength": cut.len() });
        asset.binary.extend(cut);
        json!({ "bufferView": asset.push("bufferViews", view) })
    };
    let others: Vec<Value> = (0..200).map(|_| other(&mut asset)).collect();
    of_images(&mut asset, [vec![json!({ "bufferView": first }); 200], others].concat());
    let scene = import_soon(&asset);
    assert!(scene.check_textures(|k| k < 399).expect_err("it is damaged").to_string().contains("8 others cannot be"));
}

/// A short accessor with many changes, which many primitives share, is quickly stored and slowly read.
///
/// Seen to catch: changes that only their buffer view limits.
#[test]
fn sparse_accessors_change_no_more_elements_than_they_have() {
    let mut asset = tetrahedron();
    let (indices, values) = (asset.indices(&[3; 5]), asset.vectors(&[[0.0, 0.0, 5.0]; 5]));
    let indices = json!({ "bufferView": indices, "componentType": UNSIGNED_SHORT });
    let sparse = |count: usize| json!({ "count": count, "indices": indices, "values": { "bufferView": values } });
    asset.set("/accessors/0/sparse", sparse(4));
    assert!(asset.import().is_ok());
    asset.set("/accessors/0/sparse", sparse(5));
    assert!(fault(&asset).contains("POSITION: sparse: count 5 exceeds the 4 elements"), "{}", fault(&asset));
}

/// Seen to catch: the full name of a mesh in every column of its primitives; the name of a camera for each of its nodes
/// without a limit.
#[test]
fn long_names_are_not_multiplied() {
    let mut asset = tetrahedron();
    let points = json!({ "attributes": { "POSITION": 0 }, "mode": 0 });
    let triangles = asset.json["meshes"][0]["primitives"][0].clone();
    asset.set("/meshes/0/primitives", json!([vec![points; 100], vec![triangles]].concat()));
    asset.set("/meshes/0/name", json!("ä".repeat(100_000)));
    let warnings = asset.import().expect("a good file").warnings;
    assert!(warnings.len() == 100 && warnings.iter().all(|w| w.contains("äää...`, primitive") && w.len() < 500));
    let mut asset = tetrahedron();
    asset.set("/cameras/0/name", json!("x".repeat(1 << 20)));
    for _ in 0..15 {
        asset.node(json!({ "camera": 0 }));
    }
    assert_eq!(asset.import().expect("a good file").cameras.len(), 16);
    asset.node(json!({ "camera": 0, "name": "one more" }));
    assert!(fault(&asset).contains("`one more`: the names of cameras have more than 16777216 bytes"));
}

/// Seen to catch: the primitives of a mesh searched for each node that carries it.
#[test]
fn many_nodes_of_a_mesh_of_many_primitives() {
    const COUNT: usize = 120_000;
    let mut asset = tetrahedron();
    let points = json!({ "attributes": { "POSITION": 0 }, "mode": 0 });
    let mesh = asset.push("meshes", json!({ "primitives": vec![points; COUNT] }));
    for _ in 0..COUNT {
        asset.node(json!({ "mesh": mesh }));
    }
    assert_eq!(import_soon(&asset).mesh.triangles.len(), 4);
}

/// Seen to catch: the longest of all buffers searched at each accessor that starts from zeros.
#[test]
fn many_buffers_and_many_accessors_without() {
    const COUNT: usize = 60_000;
    let mut asset = tetrahedron();
    let (indices, values) = (asset.indices(&[3]), asset.vectors(&[[0.0, 0.0, 1.0]]));
    let indices = json!({ "bufferView": indices, "componentType": UNSIGNED_SHORT });
    let sparse = json!({ "count": 1, "indices": indices, "values": { "bufferView": values } });
    let zeros = json!({ "componentType": 5126, "type": "VEC3", "count": 4, "sparse": sparse });
    let zeros = asset.push("accessors", zeros);
    let mut primitive = asset.json["meshes"][0]["primitives"][0].clone();
    primitive["attributes"]["NORMAL"] = json!(zeros);
    let empty = asset.indices(&[]);
    primitive["indices"] = json!(empty);
    let own = asset.json["meshes"][0]["primitives"][0].clone();
    asset.set("/meshes/0/primitives", json!([vec![primitive; COUNT], vec![own]].concat()));
    let whole =
        format!("data:;base64,{}", base64::Engine::encode(&base64::engine::general_purpose::STANDARD, &asset.binary));
    let mut buffers = vec![json!({ "uri": whole, "byteLength": asset.binary.len() })];
    buffers.resize(COUNT, json!({ "uri": "data:;base64,AAAA", "byteLength": 3 }));
    asset.json["buffers"] = json!(buffers);
    let start = Instant::now();
    let scene =
        test_support::glb::import_bytes("many.gltf", asset.json.to_string().as_bytes(), &test_support::glb::OPTIONS);
    assert_eq!(scene.expect("a good file").mesh.triangles.len(), 4);
    assert!(start.elapsed() < SOON, "{:?}", start.elapsed());
}

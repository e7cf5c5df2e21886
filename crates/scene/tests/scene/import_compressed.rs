//! Compressed geometry: meshopt buffer views and Draco streams give the mesh that was compressed, and what is damaged or
//! swells is refused.

use draco_core::{DataType, EncoderBuffer, EncoderOptions, GeometryAttributeType, Mesh, MeshEncoder, PointAttribute};
use scene::{DVec3, Scene};
use serde_json::{Value, json};
use test_support::glb::{Asset, OPTIONS, TETRAHEDRON, TETRAHEDRON_SIDES, fault, import_bytes, tetrahedron};

fn world(scene: &Scene) -> Vec<DVec3> {
    (0..scene.mesh.triangles.len()).flat_map(|k| scene.mesh.corners(k).map(|c| c + scene.origin)).collect()
}

/// A meshopt stream of attributes whose differences are all stored as bytes.
fn attributes(bytes: &[u8], stride: usize) -> Vec<u8> {
    let mut stream = vec![0xa0];
    let vertices: Vec<&[u8]> = bytes.chunks(stride).collect();
    for k in 0..stride {
        let groups = vertices.len().div_ceil(16);
        stream.resize(stream.len() + groups.div_ceil(4), 0xff);
        let mut column: Vec<u8> = Vec::new();
        let mut before = 0u8;
        for vertex in &vertices {
            let delta = vertex[k].wrapping_sub(before) as i8;
            column.push(((delta << 1) ^ (delta >> 7)) as u8);
            before = vertex[k];
        }
        column.resize(16 * groups, 0);
        stream.extend(column);
    }
    stream.resize(stream.len() + stride.max(32), 0);
    stream
}

/// A meshopt stream of triangles whose corners are all given.
fn triangles(corners: &[u16]) -> Vec<u8> {
    let mut data = Vec::new();
    let mut last = 0;
    for triangle in corners.chunks(3) {
        data.push(0xff);
        for corner in triangle {
            let delta = i32::from(*corner) - last;
            data.push(((delta << 1) ^ (delta >> 31)) as u8);
            last = i32::from(*corner);
        }
    }
    [&[0xe1], &vec![0xff; corners.len() / 3][..], &data, &[0; 16]].concat()
}

/// The tetrahedron with its positions and indices compressed, which lie in a buffer that is not there.
fn meshopt(name: &str) -> Asset {
    let mut asset = tetrahedron();
    let positions: Vec<u8> = TETRAHEDRON.as_flattened().iter().flat_map(|x| x.to_le_bytes()).collect();
    let streams = [
        (0, attributes(&positions, 12), json!({ "mode": "ATTRIBUTES", "byteStride": 12, "count": 4 })),
        (2, triangles(&TETRAHEDRON_SIDES), json!({ "mode": "TRIANGLES", "byteStride": 2, "count": 12 })),
    ];
    for (view, stream, mut extension) in streams {
        extension["buffer"] = json!(0);
        extension["byteOffset"] = json!(asset.binary.len());
        extension["byteLength"] = json!(stream.len());
        asset.binary.extend(stream);
        asset.json["bufferViews"][view]["buffer"] = json!(1);
        asset.json["bufferViews"][view]["extensions"] = json!({ name: extension });
    }
    asset.set("/extensionsRequired", json!([name]));
    asset
}

/// A .glb with a second buffer that has no bytes.
fn with_fallback(asset: &Asset) -> Vec<u8> {
    let mut document = asset.json.clone();
    document["buffers"] = json!([{ "byteLength": asset.binary.len() }, { "byteLength": 1 << 20 }]);
    test_support::glb::container(&[(b"JSON", document.to_string().as_bytes()), (b"BIN\0", &asset.binary)])
}

fn import(asset: &Asset) -> Result<Scene, String> {
    import_bytes("tiny.glb", &with_fallback(asset), &OPTIONS)
}

/// Seen to catch: "buffers[1] has no uri".
#[test]
fn meshopt_views_are_decoded() {
    let expected = world(&tetrahedron().import().expect("a good file"));
    for name in ["EXT_meshopt_compression", "KHR_meshopt_compression"] {
        let scene = import(&meshopt(name)).expect("a good file");
        assert_eq!(world(&scene), expected, "{name}");
        assert!(scene.warnings.is_empty(), "{:?}", scene.warnings);
    }
}

/// Seen to catch: a count that the view has no room for.
#[test]
fn damaged_meshopt_views() {
    let extension = "/bufferViews/0/extensions/EXT_meshopt_compression";
    let at = |field: &str| format!("{extension}/{field}");
    let length = meshopt("EXT_meshopt_compression").json.pointer(&at("byteLength")).and_then(Value::as_u64);
    let length = length.expect("a number");
    for (pointer, value, word) in [
        (at("byteLength"), json!(length - 1), "damaged"),
        (at("byteLength"), json!(1 << 20), "exceeds its buffer"),
        (at("buffer"), json!(1), "buffers[1] has no uri"),
        (at("buffer"), json!(2), "out of range"),
        (at("count"), json!(5), "differ from those of the bufferView"),
        (at("count"), json!(u64::MAX / 2), "differ"),
        (at("byteStride"), json!(16), "differ"),
        (at("mode"), json!("INDICES"), "do not fit the mode"),
        (at("mode"), json!("POINTS"), "EXT_meshopt_compression"),
        (at("filter"), json!("QUATERNION"), "do not fit the mode and filter"),
        ("/bufferViews/0/extensions".into(), json!({}), "buffers[1] has no uri"),
    ] {
        let mut asset = meshopt("EXT_meshopt_compression");
        asset.set(&pointer, value.clone());
        let message = import(&asset).err().unwrap_or_else(|| panic!("{pointer} = {value} was accepted"));
        assert!(message.contains(word), "{pointer} = {value}: {message}");
    }
}

/// Many views of one stream, and streams of nothing but zeros: memory is in proportion to the file.
///
/// Seen to catch: no limit.
#[test]
fn compressed_geometry_does_not_swell() {
    let mut asset = meshopt("EXT_meshopt_compression");
    // 2^19 vertices of 32 bytes, all alike: 16 MB from 256 kB.
    let (count, stride) = (1usize << 19, 32usize);
    let stream = [&[0xa0][..], &vec![0; stride * count.div_ceil(64)], &vec![0; stride]].concat();
    let compressed = json!({ "buffer": 0, "byteOffset": asset.binary.len(), "byteLength": stream.len(),
        "byteStride": stride, "count": count, "mode": "ATTRIBUTES" });
    asset.binary.extend(stream);
    for _ in 0..200 {
        let view = json!({ "buffer": 1, "byteLength": count * stride, "byteStride": stride,
            "extensions": { "EXT_meshopt_compression": compressed } });
        let view = asset.push("bufferViews", view);
        let accessor = json!({ "bufferView": view, "componentType": 5126, "type": "VEC3", "count": 3 });
        let accessor = asset.push("accessors", accessor);
        let primitive = json!({ "attributes": { "POSITION": accessor } });
        asset.json["meshes"][0]["primitives"].as_array_mut().expect("a list").push(primitive);
    }
    let message = import(&asset).err().expect("too large");
    assert!(message.contains("too large for the length of the file"), "{message}");
}

/// The tetrahedron as a Draco stream.
fn stream() -> Vec<u8> {
    let mut mesh = Mesh::new();
    let columns = [
        (GeometryAttributeType::Position, TETRAHEDRON),
        (GeometryAttributeType::Normal, TETRAHEDRON.map(|p| p.map(|x| x - 0.25))),
    ];
    for (kind, vectors) in columns {
        let mut attribute = PointAttribute::new();
        attribute.init(kind, 3, DataType::Float32, false, vectors.len());
        attribute.buffer_mut().update_f32s_le(0, vectors.as_flattened());
        mesh.add_attribute(attribute);
    }
    mesh.set_num_points(TETRAHEDRON.len());
    mesh.set_num_faces(TETRAHEDRON_SIDES.len() / 3);
    mesh.set_faces_from_flat_indices(&TETRAHEDRON_SIDES.map(u32::from));
    let mut encoder = MeshEncoder::new();
    encoder.set_mesh(mesh);
    let mut buffer = EncoderBuffer::new();
    let mut options = EncoderOptions::new();
    options.set_attribute_quantization(0, 14);
    encoder.encode(&options, &mut buffer).expect("it encodes");
    buffer.data().to_vec()
}

/// The tetrahedron with its only primitive compressed. Its accessors have no bytes.
fn draco() -> Asset {
    let mut asset = tetrahedron();
    let stream = stream();
    let view = json!({ "buffer": 0, "byteOffset": asset.binary.len(), "byteLength": stream.len() });
    asset.binary.extend(stream);
    let view = asset.push("bufferViews", view);
    for accessor in asset.json["accessors"].as_array_mut().expect("a list") {
        accessor.as_object_mut().expect("an object").remove("bufferView");
    }
    let compressed = json!({ "bufferView": view, "attributes": { "POSITION": 0, "NORMAL": 1 } });
    asset.set("/meshes/0/primitives/0/extensions", json!({ "KHR_draco_mesh_compression": compressed }));
    asset.set("/extensionsRequired", json!(["KHR_draco_mesh_compression"]));
    asset
}

/// The order of vertices and triangles is the encoder's, so that sets of triangles are compared.
///
/// Seen to catch: corners of triangles in another order.
#[test]
fn draco_streams_are_decoded() {
    let scene = draco().import().expect("a good file");
    assert!(scene.warnings.is_empty(), "{:?}", scene.warnings);
    let volume: f64 = (0..scene.mesh.triangles.len())
        .map(|k| {
            let [a, b, c] = scene.mesh.corners(k);
            a.dot(b.cross(c)) / 6.0
        })
        .sum();
    assert_eq!(scene.mesh.triangles.len(), 4);
    assert!((volume - 1.0 / 6.0).abs() < 1e-4, "{volume}");
    for (p, n) in scene.mesh.positions.iter().zip(&scene.mesh.normals) {
        let expected = (p.as_dvec3() + scene.origin - DVec3::splat(0.25)).normalize();
        assert!(n.as_dvec3().dot(expected) > 0.99, "{n} {expected}");
    }
}

/// Colors of a stream in bytes are shares of 255, and opaque if they have no alpha.
///
/// Seen to catch: normalized integers as they are; alpha as of a number that is not there.
#[test]
fn colors_of_draco_streams() {
    let mut mesh = Mesh::new();
    let mut positions = PointAttribute::new();
    positions.init(GeometryAttributeType::Position, 3, DataType::Float32, false, 4);
    positions.buffer_mut().update_f32s_le(0, TETRAHEDRON.as_flattened());
    mesh.add_attribute(positions);
    let mut colors = PointAttribute::new();
    colors.init(GeometryAttributeType::Color, 3, DataType::Uint8, true, 4);
    colors.buffer_mut().update(&[255, 51, 0].repeat(4), None);
    mesh.add_attribute(colors);
    mesh.set_num_points(4);
    mesh.set_num_faces(TETRAHEDRON_SIDES.len() / 3);
    mesh.set_faces_from_flat_indices(&TETRAHEDRON_SIDES.map(u32::from));
    let mut encoder = MeshEncoder::new();
    encoder.set_mesh(mesh);
    let mut buffer = EncoderBuffer::new();
    encoder.encode(&EncoderOptions::new(), &mut buffer).expect("it encodes");
    let mut asset = tetrahedron();
    let view = json!({ "buffer": 0, "byteOffset": asset.binary.len(), "byteLength": buffer.data().len() });
    asset.binary.extend(buffer.data());
    let view = asset.push("bufferViews", view);
    let color = json!({ "componentType": 5121, "normalized": true, "type": "VEC3", "count": 4 });
    let color = asset.push("accessors", color);
    asset.json["meshes"][0]["primitives"][0]["attributes"]["COLOR_0"] = json!(color);
    asset.json["meshes"][0]["primitives"][0]["attributes"].as_object_mut().expect("an object").remove("NORMAL");
    let compressed = json!({ "bufferView": view, "attributes": { "POSITION": 0, "COLOR_0": 1 } });
    asset.set("/meshes/0/primitives/0/extensions", json!({ "KHR_draco_mesh_compression": compressed }));
    let scene = asset.import().expect("a good file");
    assert!(!scene.mesh.colors.is_empty());
    for color in &scene.mesh.colors {
        let close = color.iter().zip([1.0, 0.2, 0.0, 1.0]).all(|(a, b)| (a - b).abs() < 1e-3);
        assert!(close, "{color:?}");
    }
}

/// Streams that are cut or have other bits are refused, or give some mesh: nothing else happens.
///
/// Seen to catch: another attribute instead of one that the stream does not have.
#[test]
fn damaged_draco_streams() {
    let good = draco();
    let view = good.json["bufferViews"].as_array().expect("a list").len() - 1;
    let mut asset = good.clone();
    let length = asset.json["bufferViews"][view]["byteLength"].as_u64().expect("a number");
    asset.set(&format!("/bufferViews/{view}/byteLength"), json!(length / 2));
    let message = fault(&asset);
    for word in ["tiny.glb", "primitive 0", "KHR_draco_mesh_compression", "gltf-transform copy"] {
        assert!(message.contains(word), "{message}");
    }
    let mut asset = good.clone();
    asset.set("/meshes/0/primitives/0/extensions/KHR_draco_mesh_compression/attributes/NORMAL", json!(7));
    assert!(fault(&asset).contains("no attribute 7"));
    let start = good.binary.len() - length as usize;
    for bit in 0..8 * length as usize {
        let mut asset = good.clone();
        asset.binary[start + bit / 8] ^= 1 << (bit % 8);
        if let Err(message) = asset.import() {
            assert!(message.contains("tiny.glb"), "{message}");
        }
    }
}

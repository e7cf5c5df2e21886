//! KHR_mesh_quantization: positions and normals as integers.

use scene::{DVec3, NormalKind, Scene};
use serde_json::json;
use test_support::glb::{Asset, TETRAHEDRON, fault, tetrahedron};

const BYTE: u32 = 5120;
const UNSIGNED_BYTE: u32 = 5121;
const SHORT: u32 = 5122;
const UNSIGNED_SHORT: u32 = 5123;

/// The tetrahedron with the attribute of this accessor as integers in a view of `stride` bytes, to be scaled by
/// `scale`.
fn quantized(accessor: usize, vectors: &[[i32; 3]; 4], kind: (u32, usize, bool), scale: f64) -> Asset {
    let (component, width, normalized) = kind;
    let mut asset = tetrahedron();
    let stride = (3 * width).next_multiple_of(4);
    let mut bytes = Vec::new();
    for v in vectors {
        v.iter().for_each(|x| bytes.extend(&x.to_le_bytes()[..width]));
        bytes.resize(bytes.len().next_multiple_of(stride), 0xff);
    }
    let view =
        json!({ "buffer": 0, "byteOffset": asset.binary.len(), "byteLength": bytes.len(), "byteStride": stride });
    asset.binary.extend(bytes);
    let view = asset.push("bufferViews", view);
    let integers = json!({
        "bufferView": view, "componentType": component, "type": "VEC3", "count": 4, "normalized": normalized,
    });
    asset.set(&format!("/accessors/{accessor}"), integers);
    asset.set("/nodes/0/scale", json!([scale, scale, scale]));
    asset.set("/extensionsRequired", json!(["KHR_mesh_quantization"]));
    asset
}

fn world(scene: &Scene) -> Vec<DVec3> {
    (0..scene.mesh.triangles.len()).flat_map(|k| scene.mesh.corners(k).map(|c| c + scene.origin)).collect()
}

/// Each type of integer, normalized or not, gives the tetrahedron back.
///
/// Seen to catch: a signed byte read without its sign; `normalized` ignored.
#[test]
fn positions_of_every_kind_of_integer() {
    let expected = world(&tetrahedron().import().expect("a good file"));
    let kinds = [(BYTE, 1, 127), (UNSIGNED_BYTE, 1, 255), (SHORT, 2, 32767), (UNSIGNED_SHORT, 2, 65535)];
    for (component, width, largest) in kinds {
        let integers = TETRAHEDRON.map(|p| p.map(|x| x as i32 * largest));
        for (normalized, scale) in [(true, 1.0), (false, 1.0 / f64::from(largest))] {
            let scene = quantized(0, &integers, (component, width, normalized), scale).import().expect("a good file");
            assert!(scene.warnings.is_empty(), "{:?}", scene.warnings);
            for (a, b) in world(&scene).iter().zip(&expected) {
                assert!(a.distance(*b) < 1e-6, "{component}: {a} {b}");
            }
        }
    }
    // Negative ones. The smallest integer of a type is -1, too.
    let below = TETRAHEDRON.map(|p| p.map(|x| if x > 0.0 { -128 } else { 0 }));
    let (low, high) = quantized(0, &below, (BYTE, 1, true), 1.0).import().expect("a good file").mesh.bounds();
    assert_eq!(high - low, DVec3::ONE);
}

#[test]
fn normals_of_normalized_integers() {
    for (component, width, largest) in [(BYTE, 1, 127.0), (SHORT, 2, 32767.0)] {
        let out = TETRAHEDRON.map(|p| DVec3::from_array(p.map(f64::from)) - 0.25);
        let integers = out.map(|n| (n.normalize() * largest).to_array().map(|x| x.round() as i32));
        let scene = quantized(1, &integers, (component, width, true), 1.0).import().expect("a good file");
        let plain = tetrahedron().import().expect("a good file");
        for k in 0..4 {
            let of = |scene: &Scene| scene.mesh.point(k, [0.6, 0.3, 0.1], NormalKind::Shading).normal;
            assert!(of(&scene).distance(of(&plain)) < 1.0 / largest, "{} {}", of(&scene), of(&plain));
        }
    }
}

#[test]
fn integers_of_32_bits_and_normalized_floats_are_none_of_it() {
    let wide = quantized(0, &[[1; 3]; 4], (5125, 4, false), 1.0);
    assert!(fault(&wide).contains("POSITION: the accessor must hold VEC3"));
    let mut float = tetrahedron();
    float.set("/accessors/1/normalized", json!(true));
    assert!(fault(&float).contains("NORMAL: the accessor must hold VEC3"));
}

//! Geometry of glTF files in every layout that glTF allows.

use scene::{DVec3, ImportOptions, Mesh, NormalKind, Scene};
use serde_json::{Value, json};
use test_support::glb::{Asset, OPTIONS, TETRAHEDRON, UNSIGNED_BYTE, UNSIGNED_INT, tetrahedron};

fn import(asset: &Asset) -> Scene {
    asset.import().expect("a good file")
}

/// Corners of all triangles in the world, m.
fn corners(scene: &Scene) -> Vec<[DVec3; 3]> {
    (0..scene.mesh.triangles.len()).map(|k| scene.mesh.corners(k).map(|c| c + scene.origin)).collect()
}

/// Volume inside a closed mesh: positive if it is wound outwards.
fn volume(mesh: &Mesh) -> f64 {
    let signed = |k| {
        let [a, b, c]: [DVec3; 3] = mesh.corners(k);
        a.dot(b.cross(c)) / 6.0
    };
    (0..mesh.triangles.len()).map(signed).sum()
}

/// Asserts that every vertex normal points out of its triangle.
fn normals_point_outwards(mesh: &Mesh) -> bool {
    (0..mesh.triangles.len() as u32).all(|k| {
        let point = mesh.point(k, [1.0 / 3.0; 3], NormalKind::Shading);
        point.normal.dot(point.geometric_normal) > 0.5
    })
}

const STRIP: [[f32; 3]; 5] = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [1.0, 1.0, 0.0], [0.0, 2.0, 0.0]];

fn flat_asset(positions: &[[f32; 3]], mode: u32) -> Asset {
    let mut asset = Asset::new();
    let positions = asset.vectors(positions);
    asset.mesh(json!({ "attributes": { "POSITION": positions }, "mode": mode }));
    asset.node(json!({ "mesh": 0 }));
    asset
}

#[test]
fn lists_strips_and_fans_without_indices() {
    let up = |asset: &Asset, count: usize| {
        let scene = import(asset);
        assert_eq!(scene.mesh.triangles.len(), count);
        (0..count as u32).all(|k| scene.mesh.point(k, [0.3; 3], NormalKind::Shading).normal == DVec3::Z)
    };
    assert!(up(&flat_asset(&STRIP[..3], 4), 1));
    assert!(up(&flat_asset(&STRIP, 5), 3), "strip");
    let fan = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0], [-1.0, 1.0, 0.0]];
    assert!(up(&flat_asset(&fan, 6), 3), "fan");
    assert!(up(&flat_asset(&STRIP, 4), 1), "a remainder makes no triangle");
}

#[test]
fn a_strip_covers_what_its_triangles_cover() {
    let scene = import(&flat_asset(&STRIP, 5));
    let area: f64 = (0..3).map(|k| scene.mesh.area(k)).sum();
    assert_eq!(area, 1.5);
    let fan = import(&flat_asset(&STRIP[..4], 6));
    assert_eq!(fan.mesh.triangles.len(), 2);
}

#[test]
fn indices_of_every_width() {
    let expected = corners(&import(&tetrahedron()));
    for (component, width) in [(UNSIGNED_BYTE, 1), (UNSIGNED_INT, 4)] {
        let mut asset = tetrahedron();
        let bytes =
            test_support::glb::TETRAHEDRON_SIDES.iter().flat_map(|i| u32::from(*i).to_le_bytes()[..width].to_vec());
        let bytes: Vec<u8> = bytes.collect();
        let indices = asset.accessor(&bytes, "SCALAR", component, 12);
        asset.set("/meshes/0/primitives/0/indices", json!(indices));
        assert_eq!(corners(&import(&asset)), expected, "{width} bytes");
    }
}

/// Positions and normals are interleaved in one view with a stride, and the accessors start within it.
#[test]
fn interleaved_vertices() {
    let expected = corners(&import(&tetrahedron()));
    let mut asset = tetrahedron();
    let both = TETRAHEDRON.iter().flat_map(|p| p.iter().copied().chain(p.map(|x| x - 0.25)));
    let bytes: Vec<u8> = both.flat_map(f32::to_le_bytes).collect();
    let view = json!({ "buffer": 0, "byteOffset": asset.binary.len(), "byteLength": bytes.len(), "byteStride": 24 });
    asset.binary.extend(bytes);
    let view = asset.push("bufferViews", view);
    for (accessor, offset) in [(0, 0), (1, 12)] {
        asset.set(&format!("/accessors/{accessor}/bufferView"), json!(view));
        asset.set(&format!("/accessors/{accessor}/byteOffset"), json!(offset));
    }
    let scene = import(&asset);
    assert_eq!(corners(&scene), expected);
    assert!(normals_point_outwards(&scene.mesh));
}

#[test]
fn sparse_accessors_replace_some_elements() {
    let mut asset = tetrahedron();
    let indices = asset.indices(&[3]);
    let values = asset.vectors(&[[0.0, 0.0, 5.0]]);
    let sparse = json!({
        "count": 1,
        "indices": { "bufferView": indices, "componentType": 5123 },
        "values": { "bufferView": values },
    });
    asset.set("/accessors/0/sparse", sparse);
    let (low, high) = import(&asset).mesh.bounds();
    assert_eq!(high - low, DVec3::new(1.0, 1.0, 5.0));
}

/// Without a buffer view, a sparse accessor starts from zeros.
#[test]
fn sparse_accessors_of_zeros() {
    let mut asset = tetrahedron();
    let indices = asset.indices(&[1, 2, 3]);
    let values = asset.vectors(&TETRAHEDRON[1..]);
    let sparse = json!({
        "count": 3,
        "indices": { "bufferView": indices, "componentType": 5123 },
        "values": { "bufferView": values },
    });
    asset.set("/accessors/0", json!({ "componentType": 5126, "type": "VEC3", "count": 4, "sparse": sparse }));
    assert_eq!(corners(&import(&asset)), corners(&import(&tetrahedron())));
}

fn placed(node: Value) -> Scene {
    let mut asset = tetrahedron();
    asset.set("/nodes/0", node);
    import(&asset)
}

#[test]
fn matrix_and_translation_rotation_scale_agree() {
    let half = std::f64::consts::FRAC_1_SQRT_2;
    let trs = placed(json!({
        "mesh": 0, "translation": [1, 2, 3], "rotation": [0, 0, half, half], "scale": [2, 3, 4],
    }));
    // A rotation by 90 degrees about z takes x to y and y to -x.
    let matrix = placed(json!({ "mesh": 0, "matrix": [0, 2, 0, 0, -3, 0, 0, 0, 0, 0, 4, 0, 1, 2, 3, 1] }));
    for (a, b) in corners(&trs).iter().flatten().zip(corners(&matrix).iter().flatten()) {
        assert!(a.distance(*b) < 1e-6, "{a} {b}");
    }
    assert!((volume(&trs.mesh) - 4.0).abs() < 1e-5 && normals_point_outwards(&trs.mesh));
}

#[test]
fn a_mirrored_copy_is_the_mirror_image_and_stays_outwards() {
    let plain = placed(json!({ "mesh": 0, "translation": [1, 0, 0] }));
    let mirrored = placed(json!({ "mesh": 0, "translation": [-1, 0, 0], "scale": [-1, 1, 1] }));
    assert!(volume(&plain.mesh) > 0.1 && (volume(&plain.mesh) - volume(&mirrored.mesh)).abs() < 1e-7);
    assert!(normals_point_outwards(&plain.mesh) && normals_point_outwards(&mirrored.mesh));
    let flip = DVec3::new(-1.0, 1.0, 1.0);
    for (a, b) in corners(&plain).iter().zip(corners(&mirrored)) {
        assert_eq!([a[0], a[2], a[1]].map(|c| c * flip), b);
    }
    // Two reflections on the way to the world, and one of all three axes.
    let nested = |inner: Value| {
        let mut asset = tetrahedron();
        asset.set("/nodes/0", json!({ "children": [3], "scale": [1, -1, 1] }));
        asset.push("nodes", inner);
        volume(&import(&asset).mesh)
    };
    assert!(nested(json!({ "mesh": 0, "scale": [2, 2, -2] })) > 0.0);
    assert!(nested(json!({ "mesh": 0, "scale": [-1, -1, -1] })) > 0.0);
}

/// Under nonuniform scale, a normal does not transform like a direction.
#[test]
fn normals_stay_upright_on_a_stretched_slope() {
    let mut asset = Asset::new();
    let positions = asset.vectors(&[[0.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 0.0, -1.0]]);
    let normals = asset.vectors(&[[-3.0, 3.0, 0.0]; 3]);
    asset.mesh(json!({ "attributes": { "POSITION": positions, "NORMAL": normals } }));
    asset.node(json!({ "mesh": 0, "scale": [1, 4, 1] }));
    let point = import(&asset).mesh.point(0, [0.2, 0.3, 0.5], NormalKind::Shading);
    assert!(point.normal.distance(point.geometric_normal) < 1e-7, "{} {}", point.normal, point.geometric_normal);
    assert!(point.normal.distance(DVec3::new(-4.0, 1.0, 0.0).normalize()) < 1e-7);
}

#[test]
fn instances_and_unused_nodes() {
    let mut asset = tetrahedron();
    asset.node(json!({ "mesh": 0, "translation": [10, 0, 0] }));
    asset.push("nodes", json!({ "name": "spare", "mesh": 0, "translation": [1000, 0, 0] }));
    let scene = import(&asset);
    assert_eq!(scene.mesh.triangles.len(), 8);
    let (low, high) = scene.mesh.bounds();
    assert_eq!(high - low, DVec3::new(11.0, 1.0, 1.0));
    assert_eq!(scene.origin, DVec3::new(5.5, 0.5, 0.5));
}

#[test]
fn only_the_default_scene_is_read_or_all_nodes_without_scenes() {
    let mut asset = tetrahedron();
    asset.push("nodes", json!({ "mesh": 0, "translation": [10, 0, 0] }));
    asset.push("scenes", json!({ "nodes": [3] }));
    assert_eq!(import(&asset).origin, DVec3::splat(0.5));
    asset.set("/scene", json!(1));
    assert_eq!(import(&asset).origin, DVec3::new(10.5, 0.5, 0.5));
    for list in ["scenes", "scene"] {
        asset.json.as_object_mut().expect("an object").remove(list);
    }
    assert_eq!(import(&asset).mesh.triangles.len(), 8);
}

#[test]
fn metres_per_unit_scales_everything_but_normals() {
    let options = ImportOptions { metres_per_unit: 1e-3, ..OPTIONS };
    let mut asset = tetrahedron();
    asset.set("/nodes/0/translation", json!([2000, 0, 0]));
    let scene = asset.import_with(&options).expect("a good file");
    let (low, high) = scene.mesh.bounds();
    assert!((high - low).distance(DVec3::splat(1e-3)) < 1e-9 && (scene.origin.x - 2.0005).abs() < 1e-12);
    assert!(scene.mesh.normals.iter().all(|n| (n.length() - 1.0).abs() < 1e-6));
}

/// Ten thousand kilometres from the origin, float32 has steps of a metre.
#[test]
fn an_object_far_from_the_origin_keeps_its_shape() {
    let scene = placed(json!({ "mesh": 0, "translation": [1e7, 0, -1e7] }));
    assert!((volume(&scene.mesh) - 1.0 / 6.0).abs() < 1e-7, "{}", volume(&scene.mesh));
}

/// Stray vertices far away make needles without area, exactly or in float32. None moves the mesh or costs it precision.
///
/// Seen to fail: all triangles of the file counted in the box whose center is the origin.
#[test]
fn what_has_no_area_costs_the_others_no_digits() {
    let strays: [[[f32; 3]; 3]; 2] =
        [[[0.0; 3], [1.0, 2.0, 3.0], [1e30, 2e30, 3e30]], [[0.0; 3], [1e-3, 0.0, 1e-4], [1e6, 0.0, 3e7]]];
    for stray in strays {
        let mut asset = tetrahedron();
        let positions = asset.vectors(&stray);
        let mesh = asset.mesh(json!({ "attributes": { "POSITION": positions } }));
        asset.node(json!({ "mesh": mesh }));
        let scene = import(&asset);
        assert_eq!(scene.degenerate_triangles.values().sum::<u64>(), 1, "{stray:?}");
        assert_eq!((scene.origin, scene.mesh.triangles.len()), (DVec3::splat(0.5), 4), "{stray:?}");
        assert!((volume(&scene.mesh) - 1.0 / 6.0).abs() < 1e-7, "{stray:?}: {}", volume(&scene.mesh));
        scene::Rays::new(&scene.mesh);
    }
}

#[test]
fn what_is_left_out_is_said() {
    let mut asset = tetrahedron();
    let flat = asset.indices(&[0, 1, 1, 0, 1, 2]);
    asset.mesh(json!({ "attributes": { "POSITION": 0 }, "indices": flat }));
    asset.mesh(json!({ "attributes": { "POSITION": 0 }, "mode": 0 }));
    let none = asset.indices(&[]);
    asset.mesh(json!({ "attributes": { "POSITION": 0 }, "indices": none }));
    for k in 1..4 {
        asset.node(json!({ "name": "more", "mesh": k }));
    }
    let scene = import(&asset);
    assert_eq!((scene.mesh.triangles.len(), scene.degenerate_triangles.values().sum::<u64>()), (5, 1));
    for word in ["1 triangles without area", "points and lines", "makes no triangle"] {
        assert!(scene.warnings.iter().any(|w| w.contains(word)), "{word}: {:?}", scene.warnings);
    }
    assert_eq!(scene.materials.len(), 2, "triangles without a material get one");
    assert_eq!(scene.materials[1].name, "default");
}

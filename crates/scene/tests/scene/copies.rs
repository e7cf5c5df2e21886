//! Triangles that are there more than once.

use scene::Scene;
use serde_json::{Value, json};
use test_support::glb::{Asset, TETRAHEDRON, tetrahedron};

/// Appends a primitive whose triangles are those of the tetrahedron by other corners, with normals of their own.
fn again(asset: &mut Asset, sides: &[u16], material: usize) {
    let mirrored = asset.vectors(&TETRAHEDRON.map(|p| p.map(|x| 0.25 - x)));
    let indices = asset.indices(sides);
    let attributes = json!({ "POSITION": 0, "NORMAL": mirrored });
    let primitive = json!({ "attributes": attributes, "indices": indices, "material": material });
    asset.json["meshes"][0]["primitives"].as_array_mut().expect("a list").push(primitive);
}

fn import(asset: &Asset) -> Scene {
    asset.import().expect("a good file")
}

fn area(scene: &Scene) -> f64 {
    (0..scene.mesh.triangles.len()).map(|k| scene.mesh.area(k)).sum()
}

/// Turned, or begun with another corner; with normals of the other side. The first stays, and the mesh is that of one
/// copy.
///
/// Seen to fail: eight triangles, and a surface of twice its area, which takes in twice the light.
#[test]
fn copies_within_a_material_are_left_out() {
    let single = import(&tetrahedron());
    for sides in [[0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3], [2, 1, 0, 3, 1, 0, 3, 2, 0, 3, 1, 2]] {
        let mut asset = tetrahedron();
        again(&mut asset, &sides, 0);
        again(&mut asset, &sides[..3], 0);
        let scene = import(&asset);
        assert_eq!(scene.mesh.triangles, single.mesh.triangles);
        assert_eq!((area(&scene), scene.origin), (area(&single), single.origin));
        assert!(scene.warnings[0].starts_with("5 triangles lie exactly on others"), "{:?}", scene.warnings);
        let defects = scene.defects(|_| true);
        assert_eq!((defects.duplicate_triangles, defects.open_edges, defects.inward_parts), (5, 0, 0));
        assert!(scene.defects(|m| m != 0).is_good());
    }
}

/// Zeros of either sign, and a mesh placed twice.
#[test]
fn copies_are_found_by_where_they_are() {
    let mut asset = tetrahedron();
    asset.node(json!({ "mesh": 0, "scale": [-1, -1, 1], "rotation": [0, 0, 1, 0] }));
    let scene = import(&asset);
    assert_eq!((scene.mesh.triangles.len(), scene.duplicate_triangles.get(&0)), (4, Some(&4)));
    asset.set("/nodes/3/translation", json!([1e-6, 0, 0]));
    assert_eq!(import(&asset).mesh.triangles.len(), 8, "beside, not upon");
}

/// Copies of two materials are ambiguous: both stay, and are counted if both materials are translucent.
#[test]
fn copies_of_other_materials_stay() {
    let mut asset = tetrahedron();
    let other = asset.push("materials", json!({ "name": "paint" }));
    again(&mut asset, &[0, 2, 1, 0, 1, 3], other);
    let scene = import(&asset);
    assert_eq!((scene.mesh.triangles.len(), scene.duplicate_triangles.len()), (6, 0));
    assert_eq!(scene.defects(|_| true).duplicate_triangles, 2);
    assert!(scene.defects(|m| m == 0).is_good());
}

/// A lamp of two sides may be two sheets that emit to their fronts; twice the same front is one lamp.
///
/// Seen to catch: lamps that lost their backs.
#[test]
fn fronts_and_backs_of_lamps_differ() {
    let lamp = |sides: &[u16], double_sided: bool| {
        let mut asset = tetrahedron();
        let emits: Value = json!({ "name": "lamp", "emissiveFactor": [1, 1, 1], "doubleSided": double_sided });
        asset.set("/materials/0", emits);
        again(&mut asset, sides, 0);
        import(&asset).mesh.triangles.len()
    };
    assert_eq!(lamp(&[2, 1, 0, 3, 0, 1], false), 4);
    assert_eq!(lamp(&[1, 2, 0, 1, 0, 3], false), 6);
    assert_eq!(lamp(&[1, 2, 0, 1, 0, 3], true), 4);
}

/// Two triangles, each a hundred thousand times: a tenth of a second, and minutes if each were compared with all
/// others.
#[test]
fn many_copies_take_a_moment() {
    let mut asset = tetrahedron();
    let copies: Vec<u16> = [0, 2, 1, 2, 1, 0].into_iter().cycle().take(3 << 18).collect();
    again(&mut asset, &copies, 0);
    let start = std::time::Instant::now();
    assert_eq!(import(&asset).duplicate_triangles.get(&0), Some(&(1 << 18)));
    let seconds = start.elapsed().as_secs_f64();
    println!("{seconds:.3} s");
    assert!(seconds < 15.0, "{seconds} s");
}

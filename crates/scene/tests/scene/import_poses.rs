//! Skins, morph targets and animations: where the vertices are.

use scene::{DVec3, ImportOptions, Pose, Scene};
use serde_json::json;
use test_support::glb::{Asset, FLOAT, OPTIONS, TETRAHEDRON, UNSIGNED_BYTE, fault, tetrahedron};

pub fn world(scene: &Scene) -> Vec<DVec3> {
    scene.mesh.positions.iter().map(|p| p.as_dvec3() + scene.origin).collect()
}

pub fn volume(scene: &Scene) -> f64 {
    let signed = |k| {
        let [a, b, c] = scene.mesh.corners(k);
        a.dot(b.cross(c)) / 6.0
    };
    (0..scene.mesh.triangles.len()).map(signed).sum()
}

#[track_caller]
pub fn assert_close(a: &[DVec3], b: &[DVec3]) {
    assert_eq!(a.len(), b.len());
    for (a, b) in a.iter().zip(b) {
        assert!(a.distance(*b) < 1e-6, "{a} {b}");
    }
}

pub fn corners() -> Vec<DVec3> {
    TETRAHEDRON.map(|p| DVec3::from_array(p.map(f64::from))).to_vec()
}

fn floats(asset: &mut Asset, kind: &str, numbers: &[f32], count: usize) -> usize {
    let bytes: Vec<u8> = numbers.iter().flat_map(|x| x.to_le_bytes()).collect();
    asset.accessor(&bytes, kind, FLOAT, count)
}

fn at(animation: Option<&str>, seconds: f64) -> ImportOptions {
    let pose = Some(Pose { animation: animation.map(str::to_owned), seconds });
    ImportOptions { pose, ..OPTIONS }
}

/// Adds an animation of one channel.
fn animate(asset: &mut Asset, name: &str, (node, path): (usize, &str), times: &[f32], keys: (&str, &[f32]), how: &str) {
    let input = floats(asset, "SCALAR", times, times.len());
    let (kind, numbers) = keys;
    let size = match kind {
        "VEC3" => 3,
        "VEC4" => 4,
        _ => 1,
    };
    let output = floats(asset, kind, numbers, numbers.len() / size);
    let sampler = json!({ "input": input, "output": output, "interpolation": how });
    let channel = json!({ "sampler": 0, "target": { "node": node, "path": path } });
    asset.push("animations", json!({ "name": name, "channels": [channel], "samplers": [sampler] }));
}

/// Where the body stands at each time of an animation of its translation, whose keys are at 1 s and 3 s.
fn moved(numbers: &[f32], how: &str) -> impl Fn(f64) -> DVec3 {
    let mut asset = tetrahedron();
    animate(&mut asset, "go", (0, "translation"), &[1.0, 3.0], ("VEC3", numbers), how);
    move |seconds| {
        let scene = asset.import_with(&at(Some("go"), seconds)).expect("a good file");
        world(&scene)[0]
    }
}

/// Before the first key and after the last, it stands there. A spline with tangents 0 is the smooth step.
///
/// Seen to catch: tangents that are not scaled by the time between keys.
#[test]
fn keys_are_interpolated() {
    let keys = [0.0, 2.0, 0.0, 8.0, 2.0, 0.0];
    let linear = moved(&keys, "LINEAR");
    let step = moved(&keys, "STEP");
    let mut spline = [[0.0; 3]; 6];
    (spline[1], spline[4]) = ([0.0, 2.0, 0.0], [8.0, 2.0, 0.0]);
    // Tangents of z: it rises by 1 m/s from the first key, and falls as fast to the second.
    (spline[2], spline[3]) = ([0.0, 0.0, 1.0], [0.0, 0.0, -1.0]);
    let spline = moved(spline.as_flattened(), "CUBICSPLINE");
    for (seconds, expected) in [(0.0, 0.0), (1.0, 0.0), (1.5, 2.0), (2.0, 4.0), (3.0, 8.0), (9.0, 8.0)] {
        assert!((linear(seconds) - DVec3::new(expected, 2.0, 0.0)).length() < 1e-6, "{seconds}");
        let stepped = if seconds < 3.0 { 0.0 } else { 8.0 };
        assert_eq!(step(seconds), DVec3::new(stepped, 2.0, 0.0), "{seconds}");
        let t = ((seconds - 1.0) / 2.0).clamp(0.0, 1.0);
        let z = 2.0 * (t * t * t - 2.0 * t * t + t) - 2.0 * (t * t * t - t * t);
        let smooth = DVec3::new(8.0 * t * t * (3.0 - 2.0 * t), 2.0, z);
        assert!((spline(seconds) - smooth).length() < 1e-6, "{seconds}: {} {smooth}", spline(seconds));
    }
}

/// From 0 to a quarter turn about z, whose quaternion has the other sign: the shorter way. A child turns with its
/// parent, whose matrix is replaced.
///
/// Seen to catch: the four numbers interpolated one by one, as they are.
#[test]
fn rotations_take_the_shorter_way() {
    let mut asset = tetrahedron();
    asset.set("/scenes/0/nodes", json!([1, 2, 3]));
    let matrix = [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 5, 0, 0, 1];
    let parent = asset.push("nodes", json!({ "children": [0], "matrix": matrix }));
    let half = (std::f32::consts::PI / 4.0).sin_cos();
    let keys = [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, -half.0, -half.1];
    animate(&mut asset, "turn", (parent, "rotation"), &[0.0, 1.0], ("VEC4", &keys), "LINEAR");
    let scene = asset.import_with(&at(None, 0.5)).expect("a good file");
    let (sin, cos) = (std::f64::consts::PI / 4.0).sin_cos();
    let turned = |p: DVec3| DVec3::new(5.0 + cos * p.x - sin * p.y, sin * p.x + cos * p.y, p.z);
    assert_close(&world(&scene), &corners().into_iter().map(turned).collect::<Vec<_>>());
    assert_eq!(scene.pose, "turn at 0.5 s");
}

/// At rest the file is as before, and says what could move. Poses that are not there are named with what is.
///
/// Seen to catch: the first animation taken for one that is not there.
#[test]
fn poses_are_chosen() {
    let mut asset = tetrahedron();
    let still = tetrahedron().import().expect("a good file");
    for name in ["walk", "run"] {
        animate(&mut asset, name, (0, "scale"), &[1.0, 2.0], ("VEC3", &[2.0; 6]), "LINEAR");
    }
    asset.json["animations"][1].as_object_mut().expect("an object").remove("name");
    let scene = asset.import().expect("a good file");
    assert_eq!(scene.geometry_digest(), still.geometry_digest());
    assert_eq!(scene.warnings, ["everything is at rest; the file has animations: `walk`, `animation1`"]);
    let posed = |animation, seconds| asset.import_with(&at(animation, seconds));
    let scene = posed(Some("animation1"), 5.0).expect("it is there");
    assert!(scene.geometry_digest() != still.geometry_digest() && volume(&scene) > 1.3, "{}", volume(&scene));
    assert!(scene.warnings[0].contains("ends at 2 s"), "{:?}", scene.warnings);
    let message = |animation| posed(animation, 0.0).err().expect("no such pose");
    assert!(message(None).contains("several animations: `walk`, `animation1`"));
    assert!(message(Some("run")).contains("no animation `run`; the file has `walk`"));
    let none = tetrahedron().import_with(&at(Some("run"), 0.0)).err().expect("none");
    assert!(none.contains("no animation `run`; the file has none"), "{none}");
}

/// A lamp and a camera move, too.
///
/// Seen to catch: channels of nodes without a mesh passed over.
#[test]
fn lights_and_cameras_move() {
    let mut asset = tetrahedron();
    animate(&mut asset, "lamp", (1, "translation"), &[0.0], ("VEC3", &[0.0, 3.0, 0.0]), "LINEAR");
    animate(&mut asset, "eye", (2, "translation"), &[0.0], ("VEC3", &[0.0, 3.0, 0.0]), "STEP");
    let [rest, lamp, eye] = [OPTIONS, at(Some("lamp"), 0.0), at(Some("eye"), 0.0)]
        .map(|options| asset.import_with(&options).expect("a good file"));
    assert!(lamp.light_digest() != rest.light_digest() && eye.light_digest() == rest.light_digest());
    assert_eq!(eye.cameras[0].position - rest.cameras[0].position, DVec3::new(0.0, 3.0, 0.0));
}

/// Faults of animations are named; those of animations that are not asked for do no harm.
///
/// Seen to catch: three values for two keys.
#[test]
fn faulty_animations() {
    let mut good = tetrahedron();
    animate(&mut good, "go", (0, "translation"), &[0.0, 1.0], ("VEC3", &[0.0; 6]), "LINEAR");
    let accessors = good.json["accessors"].as_array().expect("a list").len();
    let sampler = "/animations/0/samplers/0";
    for (pointer, value, word) in [
        ("/animations/0/channels/0/target/node", json!(9), "node index 9"),
        ("/animations/0/channels/0/target/path", json!("rotation"), "VEC4"),
        ("/animations/0/channels/0/target/path", json!("weights"), "SCALAR"),
        ("/animations/0/channels/0/sampler", json!(1), "sampler&out of range"),
        (&format!("{sampler}/input"), json!(99), "input&out of range"),
        (&format!("{sampler}/output"), json!(accessors - 2), "output&VEC3"),
        (&format!("{sampler}/interpolation"), json!("CUBICSPLINE"), "do not fit"),
        (&format!("{sampler}/interpolation"), json!("BEZIER"), "interpolation"),
        (&format!("/accessors/{}/count", accessors - 2), json!(0), "do not fit"),
        (&format!("/accessors/{}/count", accessors - 1), json!(3), "do not fit"),
    ] {
        let mut asset = good.clone();
        asset.set(pointer, value.clone());
        let message = asset.import_with(&at(None, 0.5)).err().unwrap_or_else(|| panic!("{pointer} = {value}"));
        for word in word.split('&').chain(["tiny.glb"]) {
            assert!(message.contains(word), "{pointer} = {value}: no `{word}` in {message}");
        }
        assert!(asset.import().is_ok(), "{pointer} = {value}");
    }
    let mut odd = tetrahedron();
    animate(&mut odd, "go", (0, "translation"), &[0.0, 1.0], ("VEC3", &[0.0; 9]), "LINEAR");
    let message = odd.import_with(&at(None, 0.5)).err().expect("one value is too many");
    assert!(message.contains("3 elements of output do not fit 2 of input"), "{message}");
}

/// The tetrahedron with two morph targets: the first moves all of it along x, the second its last corner along z.
fn morphing() -> Asset {
    let mut asset = tetrahedron();
    let along = asset.vectors(&[[1.0, 0.0, 0.0]; 4]);
    let up = asset.vectors(&[[0.0; 3], [0.0; 3], [0.0; 3], [0.0, 0.0, 2.0]]);
    let targets = json!([{ "POSITION": along }, { "POSITION": up, "NORMAL": up, "TANGENT": up }]);
    asset.set("/meshes/0/primitives/0/targets", targets);
    asset
}

/// The weights of the pose count before those of the node, and these before those of the mesh.
///
/// Seen to catch: weights of the file that win over those of the pose.
#[test]
fn morph_targets() {
    let expected = |x: f64, z: f64| {
        let mut list = corners();
        list[3].z += z;
        list.iter().map(|p| *p + DVec3::X * x).collect::<Vec<_>>()
    };
    let mut asset = morphing();
    assert_close(&world(&asset.import().expect("a good file")), &expected(0.0, 0.0));
    asset.set("/meshes/0/weights", json!([0.0, 1.0]));
    assert_close(&world(&asset.import().expect("a good file")), &expected(0.0, 2.0));
    asset.set("/nodes/0/weights", json!([0.5, 0.25]));
    let scene = asset.import().expect("a good file");
    assert_close(&world(&scene), &expected(0.5, 0.5));
    assert!(scene.warnings.is_empty(), "{:?}", scene.warnings);
    let normal = DVec3::new(-0.25, -0.25, 0.75 + 0.5).normalize();
    assert!(scene.mesh.normals[3].as_dvec3().distance(normal) < 1e-6);
    animate(&mut asset, "grow", (0, "weights"), &[0.0, 4.0], ("SCALAR", &[0.0, 0.0, 1.0, 2.0]), "LINEAR");
    assert_close(&world(&asset.import_with(&at(None, 1.0)).expect("a good file")), &expected(0.25, 1.0));
    let mut short = morphing();
    let three = short.vectors(&[[0.0; 3]; 3]);
    short.set("/meshes/0/primitives/0/targets/1/POSITION", json!(three));
    assert!(fault(&short).contains("targets[1].POSITION has 3 elements"));
}

/// The tetrahedron on two joints: the first three corners follow the first, the last both alike.
fn skinned() -> Asset {
    let mut asset = tetrahedron();
    let joints = asset.accessor(&[0, 1, 9, 9].repeat(4), "VEC4", UNSIGNED_BYTE, 4);
    let mut weights = [[1.0, 0.0, 0.0, 0.0]; 4];
    weights[3] = [0.5, 0.5, 0.0, 0.0];
    let weights = floats(&mut asset, "VEC4", weights.as_flattened(), 4);
    asset.set("/meshes/0/primitives/0/attributes/JOINTS_0", json!(joints));
    asset.set("/meshes/0/primitives/0/attributes/WEIGHTS_0", json!(weights));
    let child = asset.push("nodes", json!({ "name": "tip", "translation": [0, 0, 4] }));
    let root = asset.node(json!({ "name": "bone", "translation": [10, 0, 0], "children": [child] }));
    let shift = |x: f32, z: f32| [1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, x, 0.0, z, 1.0];
    let inverse = floats(&mut asset, "MAT4", [shift(-10.0, 0.0), shift(-10.0, -4.0)].as_flattened(), 2);
    asset.push("skins", json!({ "joints": [root, child], "inverseBindMatrices": inverse }));
    asset.set("/nodes/0/skin", json!(0));
    // The node of a skinned mesh has no effect.
    asset.set("/nodes/0/translation", json!([100, 100, 100]));
    asset
}

/// At rest the mesh is where it was bound; it follows its joints, and not its node, in as many sets of four as there are.
///
/// Seen to catch: weights that are not scaled to a sum of 1; the first set of four alone; copies of a skinned mesh.
#[test]
fn skins_follow_their_joints() {
    let mut asset = skinned();
    let scene = asset.import().expect("a good file");
    assert_close(&world(&scene), &corners());
    assert!(scene.warnings.is_empty(), "{:?}", scene.warnings);
    // The tip moves by 1: the last corner by a half of that.
    asset.set("/nodes/3/translation", json!([0, 0, 5]));
    let mut expected = corners();
    expected[3].z += 0.5;
    assert_close(&world(&asset.import().expect("a good file")), &expected);
    animate(&mut asset, "nod", (3, "translation"), &[0.0], ("VEC3", &[0.0, 0.0, 8.0]), "STEP");
    expected[3].z += 1.5;
    assert_close(&world(&asset.import_with(&at(None, 0.0)).expect("a good file")), &expected);
    // Weights of any sum.
    let mut heavy = skinned();
    heavy.set("/nodes/3/translation", json!([0, 0, 5]));
    let weights = floats(&mut heavy, "VEC4", &[3.0, 1.0, 0.0, 0.0].repeat(4), 4);
    heavy.set("/meshes/0/primitives/0/attributes/WEIGHTS_0", json!(weights));
    let expected: Vec<DVec3> = corners().iter().map(|p| *p + DVec3::Z * 0.25).collect();
    assert_close(&world(&heavy.import().expect("a good file")), &expected);
    // The second set has the tip alone, with as much weight as the first: of 8 parts 5 follow the tip.
    let joints = heavy.accessor(&[1, 9, 9, 9].repeat(4), "VEC4", UNSIGNED_BYTE, 4);
    let weights = floats(&mut heavy, "VEC4", &[4.0, 0.0, 0.0, 0.0].repeat(4), 4);
    heavy.set("/meshes/0/primitives/0/attributes/JOINTS_1", json!(joints));
    heavy.set("/meshes/0/primitives/0/attributes/WEIGHTS_1", json!(weights));
    let expected: Vec<DVec3> = corners().iter().map(|p| *p + DVec3::Z * 0.625).collect();
    assert_close(&world(&heavy.import().expect("a good file")), &expected);
    // A skinned mesh is where its joints are: copies would all lie there.
    let places = heavy.vectors(&[[0.0; 3], [4.0, 0.0, 0.0]]);
    let attributes = json!({ "attributes": { "TRANSLATION": places } });
    heavy.set("/nodes/0/extensions", json!({ "EXT_mesh_gpu_instancing": attributes }));
    assert_close(&world(&heavy.import().expect("a good file")), &expected);
}

/// A mirrored skeleton does not turn the surface inside out, and normals follow.
///
/// Seen to catch: the winding of the file.
#[test]
fn mirrored_skeletons() {
    let mut asset = skinned();
    asset.set("/nodes/4/scale", json!([-1, 1, 1]));
    let scene = asset.import().expect("a good file");
    assert!((volume(&scene) - 1.0 / 6.0).abs() < 1e-6, "{}", volume(&scene));
    // Corner 1 is bound at x = 1, which is 9 left of the joint at 10: it is mirrored to 19.
    assert!((world(&scene)[1].x - 19.0).abs() < 1e-6);
    assert!(scene.mesh.normals[1].x < 0.0);
}

/// Seen to catch: joints without weights.
#[test]
fn faulty_skins() {
    let few = |asset: &mut Asset| floats(asset, "MAT4", &[1.0; 16], 1);
    for (pointer, value, word) in [
        ("/nodes/0/skin", json!(1), "node.skin&out of range"),
        ("/skins/0/joints", json!([4, 99]), "`skin0`&joint 99"),
        ("/skins/0/joints", json!([4]), "`body`&joint that its skin does not have"),
        ("/skins/0/inverseBindMatrices", json!(0), "MAT4"),
        ("/skins/0/inverseBindMatrices", json!(null), ""),
        ("/meshes/0/primitives/0/attributes/WEIGHTS_0", json!(null), "tiny.glb"),
        ("/meshes/0/primitives/0/attributes/JOINTS_0", json!(0), "JOINTS_0&unsigned"),
        ("/nodes/4/children", json!([]), "not in the scene"),
    ] {
        let mut asset = skinned();
        asset.set(pointer, value.clone());
        match asset.import() {
            Ok(_) => assert!(word.is_empty(), "{pointer} = {value} was accepted"),
            Err(message) => {
                let found = !word.is_empty() && word.split('&').all(|word| message.contains(word));
                assert!(found, "{pointer} = {value}: {message}");
            }
        }
    }
    let mut asset = skinned();
    let few = few(&mut asset);
    asset.set("/skins/0/inverseBindMatrices", json!(few));
    assert!(fault(&asset).contains("1 inverseBindMatrices for 2 joints"));
    let mut asset = skinned();
    asset.json["meshes"][0]["primitives"][0]["attributes"].as_object_mut().expect("an object").remove("WEIGHTS_0");
    assert!(fault(&asset).contains("need each other"));
}

/// Many nodes with many morph targets are refused by their work.
///
/// Seen to catch: no limit, which took more than half a minute.
#[test]
fn changes_are_counted_before_they_are_made() {
    let mut asset = morphing();
    let target = asset.json["meshes"][0]["primitives"][0]["targets"][0].clone();
    asset.set("/meshes/0/primitives/0/targets", json!(vec![target; 20_000]));
    asset.set("/meshes/0/weights", json!(vec![1.0; 20_000]));
    for _ in 0..8000 {
        asset.node(json!({ "mesh": 0 }));
    }
    let start = std::time::Instant::now();
    assert!(fault(&asset).contains("joints and morphs of vertices"), "{}", fault(&asset));
    assert!(start.elapsed().as_secs() < 10, "{:?}", start.elapsed());
}

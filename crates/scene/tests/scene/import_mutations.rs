//! Damaged files, three thousand at random but the same in every run: each is read or refused, none panics.

use crate::asset::{Asset, Folder, OPTIONS, container, tetrahedron};
use scene::{
    DVec3, NormalKind, Rays, Scene,
    random::{Item, Purpose, Stream},
};
use serde_json::{Value, json};

/// A small file with one of everything.
fn everything() -> Asset {
    let mut asset = tetrahedron();
    asset.light(json!({ "type": "directional", "color": [1, 0.5, 0.25] }), json!({ "rotation": [0, 1, 0, 0] }));
    asset.light(json!({ "type": "point", "range": 3.5 }), json!({ "translation": [0, 2, 0] }));
    let glow = json!({ "KHR_materials_emissive_strength": { "emissiveStrength": 2.5 } });
    asset.push("materials", json!({ "emissiveFactor": [1, 1, 1], "extensions": glow, "doubleSided": true }));
    asset.mesh(json!({ "attributes": { "POSITION": 0 }, "mode": 5, "material": 1 }));
    asset.node(json!({ "mesh": 1, "matrix": [0, 2, 0, 0, -3, 0, 0, 0, 0, 0, 4, 0, 5, 6, 7, 1] }));
    let orthographic = json!({ "xmag": 1, "ymag": 2, "znear": 0, "zfar": 9 });
    asset.push("cameras", json!({ "type": "orthographic", "orthographic": orthographic }));
    asset.node(json!({ "camera": 1, "scale": [1, 1, -1] }));
    asset.set("/bufferViews/0/byteStride", json!(12));
    assert!(asset.import().is_ok());
    asset
}

struct Random(Item, u64);

impl Random {
    fn below(&mut self, limit: usize) -> usize {
        self.1 += 1;
        (self.0.bits(self.1) % limit as u64) as usize
    }

    fn pick<T: Clone>(&mut self, list: &[T]) -> T {
        list[self.below(list.len())].clone()
    }
}

fn flip_bytes(mut bytes: Vec<u8>, random: &mut Random) -> Vec<u8> {
    for _ in 0..1 + random.below(4) {
        let at = random.below(bytes.len());
        bytes[at] = random.pick(&[0, 1, 0x7f, 0x80, 0xff, bytes[at] ^ 1, bytes[at] ^ 0x40, b'0', b'9', b'-', b'{']);
    }
    bytes
}

/// Replaces up to three numbers, wherever they are in the document.
fn replace_numbers(asset: &mut Asset, random: &mut Random) {
    let mut numbers = Vec::new();
    collect(&asset.json, String::new(), &mut numbers);
    for _ in 0..1 + random.below(3) {
        let large = [u64::MAX, 1 << 63, (1 << 32) - 1, 1 << 32, 1 << 31, 65535, 5121, 5125, 5126].map(|n| json!(n));
        let small = [0, 1, 2, 3, 4, 5, 6, 7, -1, i32::MIN].map(|n| json!(n));
        let real = [0.5, -0.0, 1e-45, 1e38, 1e39, 1e300, -1e300, 1e-300, 3.2].map(|x| json!(x));
        let other = [Value::Null, json!("1"), json!([]), json!({})];
        let values: Vec<Value> = [&large[..], &small[..], &real[..], &other[..]].concat();
        let (pointer, value) = (random.pick(&numbers), random.pick(&values));
        if let Some(number) = asset.json.pointer_mut(&pointer) {
            *number = value;
        }
    }
}

/// Pointers to all numbers.
fn collect(value: &Value, at: String, numbers: &mut Vec<String>) {
    match value {
        Value::Number(_) => numbers.push(at),
        Value::Array(items) => items.iter().enumerate().for_each(|(k, v)| collect(v, format!("{at}/{k}"), numbers)),
        Value::Object(fields) => fields.iter().for_each(|(k, v)| collect(v, format!("{at}/{k}"), numbers)),
        _ => {}
    }
}

fn mutate(asset: &Asset, kind: u64, random: &mut Random) -> Vec<u8> {
    let mut copy = Asset { json: asset.json.clone(), binary: asset.binary.clone() };
    match kind {
        0 => flip_bytes(asset.glb(), random),
        1 => {
            let bytes = asset.glb();
            let length = random.below(bytes.len());
            bytes[..length].to_vec()
        }
        2 => {
            // A container that is whole around a buffer that is damaged.
            copy.binary = flip_bytes(copy.binary, random);
            copy.glb()
        }
        3 => {
            let text = flip_bytes(copy.json.to_string().into_bytes(), random);
            container(&[(b"JSON", &text), (b"BIN\0", &copy.binary)])
        }
        _ => {
            replace_numbers(&mut copy, random);
            copy.glb()
        }
    }
}

/// What every scene promises; looks at it as the stages do.
fn assert_usable(scene: &Scene) {
    assert!(!scene.mesh.triangles.is_empty() && scene.origin.is_finite());
    let rays = Rays::new(&scene.mesh);
    for k in 0..scene.mesh.triangles.len() as u32 {
        assert!(usize::from(scene.mesh.triangles[k as usize].material) < scene.materials.len());
        let point = scene.mesh.point(k, [0.2, 0.3, 0.5], NormalKind::Shading);
        assert!(scene.mesh.area(k as usize) > 0.0 && point.position.is_finite());
        assert!((point.normal.length() - 1.0).abs() < 1e-6 && (point.geometric_normal.length() - 1.0).abs() < 1e-12);
        for light in &scene.lights {
            assert!(light.importance(&point) >= 0.0);
            if let Some(l) = light.illuminate(&point, [0.3, 0.6]) {
                assert!(l.irradiance.is_finite() && l.irradiance.min_element() >= 0.0);
                rays.visible(point.position, l.direction, l.distance, Some(k));
            }
        }
    }
    for camera in &scene.cameras {
        let (origin, direction) = camera.ray(glam::DVec2::splat(3.0), glam::DVec2::splat(8.0));
        assert!((direction.length() - 1.0).abs() < 1e-9);
        rays.closest(origin - scene.origin, direction, None);
    }
    assert!(rays.closest(DVec3::ZERO, DVec3::X, None).is_none_or(|hit| hit.distance >= 0.0));
}

#[test]
fn no_damage_makes_a_panic_or_a_scene_that_breaks_its_promises() {
    let (asset, folder) = (everything(), Folder::new());
    let stream = Stream::new(11, Purpose::Surface);
    let (mut read, mut refused) = (0, 0);
    for k in 0..3000 {
        let bytes = mutate(&asset, k % 6, &mut Random(stream.item(k), 0));
        // A new name each time: to write over a file takes some file systems milliseconds.
        let path = folder.write(&format!("damaged-{k}.glb"), &bytes);
        let outcome = std::panic::catch_unwind(|| match Scene::import(&path, &OPTIONS) {
            Ok(scene) => {
                assert_usable(&scene);
                true
            }
            Err(e) => {
                assert!(e.to_string().contains("damaged-"), "{e}");
                false
            }
        });
        match outcome {
            Ok(true) => read += 1,
            Ok(false) => refused += 1,
            Err(_) => panic!("mutation {k} panicked, see above"),
        }
    }
    // Both kinds must be there, or the mutations test nothing.
    assert!(read > 300 && refused > 1000, "{read} read, {refused} refused");
}

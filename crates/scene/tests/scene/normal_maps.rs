//! Normal maps, at known points of a square.

use crate::{
    import_textures::{NEAREST, add_picture, encoded, square},
    meshes::random,
};
use image::{ImageFormat, Rgba, RgbaImage};
use scene::{DVec3, NormalKind, Scene, SurfacePoint};
use serde_json::{Value, json};
use std::f64::consts::TAU;
use test_support::glb::{Asset, FLOAT};

/// The square with this picture of normals. The picture's up is -Y, so that the square shows it mirrored.
fn mapped(picture: &RgbaImage, texture: Value) -> Asset {
    let mut asset = Asset::new();
    let mut of_material = json!({ "index": 0 });
    of_material.as_object_mut().expect("an object").extend(texture.as_object().expect("an object").clone());
    let mut primitive = square(&mut asset, json!({ "name": "Bark", "normalTexture": of_material }));
    primitive["attributes"]["NORMAL"] = json!(asset.vectors(&[[0.0, 0.0, 1.0]; 4]));
    asset.mesh(primitive);
    add_picture(&mut asset, &encoded(picture, ImageFormat::Png), json!({ "magFilter": NEAREST }));
    asset
}

fn import(asset: &Asset) -> Scene {
    let scene = asset.import().expect("imports");
    assert!(scene.warnings.is_empty(), "{:?}", scene.warnings);
    scene
}

/// The point of the square at x and y.
fn at(scene: &Scene, x: f64, y: f64) -> SurfacePoint {
    let (triangle, weights) = if x > y { (0, [1.0 - x, x - y, y]) } else { (1, [1.0 - y, x, y - x]) };
    scene.mesh.point(triangle, weights, NormalKind::Shading)
}

/// A code that stands for a component of a normal.
fn code(x: f64) -> u8 {
    (128.0 + 127.0 * x).round() as u8
}

/// The four sides of a pyramid of slope 1: to the right, up, left and down in the picture, clockwise from the top left.
fn pyramid() -> RgbaImage {
    let h = 0.5f64.sqrt();
    let side = |x, y| match (x, y) {
        (0, 0) => [h, 0.0],
        (1, 0) => [0.0, h],
        (1, 1) => [-h, 0.0],
        _ => [0.0, -h],
    };
    RgbaImage::from_fn(2, 2, |x, y| {
        let [a, b] = side(x, y);
        Rgba([code(a), code(b), code(h), 255])
    })
}

/// Within the rounding of the codes.
fn assert_near(normal: DVec3, expected: DVec3) {
    assert!((normal - expected.normalize()).length() < 0.01, "{normal}, not {}", expected.normalize());
}

/// A flat picture changes nothing but rounding, and less than that of the light.
///
/// Seen to catch: 127.5 for 0.
#[test]
fn a_flat_picture_is_none() {
    let flat = RgbaImage::from_pixel(2, 2, Rgba([128, 128, 255, 255]));
    let mut asset = mapped(&flat, json!({ "scale": 3.0 }));
    let normals = asset.vectors(&[[0.6, 0.0, 0.8], [0.0, 0.6, 0.8], [0.0, 0.0, 1.0], [-0.6, 0.0, 0.8]]);
    asset.set("/meshes/0/primitives/0/attributes/NORMAL", json!(normals));
    let scene = import(&asset);
    for (x, y) in [(0.2, 0.1), (0.7, 0.3), (0.3, 0.9)] {
        let point = at(&scene, x, y);
        assert!((point.normal - point.smooth_normal).length() < 1e-15 && point.normal.x != 0.0);
        assert_eq!([point.bump.gain(0.9), point.bump.gain(0.01)], [1.0; 2]);
    }
    assert!(scene.mesh.bumps.is_some());
}

/// The sides of a pyramid face where the picture says, also where it is mirrored, turned, or in a mirrored node.
///
/// Seen to catch: `v` not turned over for MikkTSpace; the sign of the file's tangents turned over, and not turned over in
/// a mirrored node; no scale.
#[test]
fn the_sides_of_a_pyramid_face_outwards() {
    let corners = [(0.25, 0.25), (0.75, 0.25), (0.75, 0.75), (0.25, 0.75)];
    let expect = |scene: &Scene, expected: [DVec3; 4]| {
        for ((x, y), expected) in corners.into_iter().zip(expected) {
            assert_near(at(scene, x, y).normal, expected);
            assert_eq!(at(scene, x, y).smooth_normal, DVec3::Z);
        }
    };
    // The square has the top of the picture at y = 0: its up is -Y.
    let facing = |slope: DVec3| (slope + DVec3::Z).normalize();
    let mut asset = mapped(&pyramid(), json!({}));
    expect(&import(&asset), [DVec3::X, DVec3::NEG_Y, DVec3::NEG_X, DVec3::Y].map(facing));
    // Half as steep.
    asset.set("/materials/0/normalTexture/scale", json!(0.5));
    assert_near(at(&import(&asset), 0.25, 0.25).normal, DVec3::new(0.5, 0.0, 1.0));
    // With the coordinates of the picture the other way around, it is not mirrored.
    let flipped = json!({ "KHR_texture_transform": { "offset": [0.0, 1.0], "scale": [1.0, -1.0] } });
    let asset = mapped(&pyramid(), json!({ "extensions": flipped }));
    expect(&import(&asset), [DVec3::NEG_Y, DVec3::NEG_X, DVec3::Y, DVec3::X].map(facing));
    // A node that mirrors x, without and with tangents of the file, whose bitangents point down in the picture here.
    for (tangents, y) in [(false, -1.0), (true, 1.0)] {
        let mut asset = mapped(&pyramid(), json!({}));
        if tangents {
            let bytes: Vec<u8> = [1f32, 0.0, 0.0, 1.0].repeat(4).iter().flat_map(|x| x.to_le_bytes()).collect();
            let tangents = asset.accessor(&bytes, "VEC4", FLOAT, 4);
            asset.set("/meshes/0/primitives/0/attributes/TANGENT", json!(tangents));
        }
        let expected = [DVec3::X, y * DVec3::Y, DVec3::NEG_X, -y * DVec3::Y];
        expect(&import(&asset), expected.map(facing));
        asset.set("/nodes/0/scale", json!([-1, 1, 1]));
        let scene = import(&asset);
        for (triangle, weights) in [(0, [0.2, 0.6, 0.2]), (0, [0.6, 0.3, 0.1]), (1, [0.2, 0.5, 0.3])] {
            let point = scene.mesh.point(triangle, weights, NormalKind::Shading);
            let place = point.position + scene.origin;
            let is_own = |(x, y): &(f64, f64)| (-place.x - x).abs() < 0.25 && (place.y - y).abs() < 0.25;
            let own = corners.iter().position(is_own).expect("inside");
            assert_near(point.normal, facing(expected[own]) * DVec3::new(-1.0, 1.0, 1.0));
        }
    }
}

/// Where all bumps face the light, they get what falls on the smooth plane: exactly on the pyramid and, with bumps that
/// face away and shadow others, on average of normally distributed slopes.
///
/// Seen to catch: no stretch, no shadows.
#[test]
fn bumps_get_the_light_of_the_plane() {
    let scene = import(&mapped(&pyramid(), json!({})));
    let mean = |scene: &Scene, towards: DVec3, places: &[(f64, f64)]| {
        let light = |(x, y): &(f64, f64)| {
            let point = at(scene, *x, *y);
            point.normal.dot(towards).max(0.0) * point.bump.gain(towards.z)
        };
        places.iter().map(light).sum::<f64>() / places.len() as f64
    };
    let sides = [(0.25, 0.25), (0.75, 0.25), (0.75, 0.75), (0.25, 0.75)];
    for towards in [DVec3::Z, DVec3::new(0.3, -0.1, 0.9).normalize()] {
        let light = mean(&scene, towards, &sides);
        assert!((light / towards.z - 1.0).abs() < 0.01, "{towards}: {light}");
    }
    let texel = |x: u32, y: u32| {
        let item = random(u64::from(x + 128 * y));
        let [radius, angle] = [(-2.0 * (1.0 - item.uniform(0)).ln()).sqrt() * 0.3, TAU * item.uniform(1)];
        let normal = DVec3::new(radius * angle.cos(), radius * angle.sin(), 1.0).normalize();
        Rgba([code(normal.x), code(normal.y), code(normal.z), 255])
    };
    let scene = import(&mapped(&RgbaImage::from_fn(128, 128, texel), json!({})));
    let places: Vec<(f64, f64)> =
        (0..128 * 128).map(|k| ((f64::from(k % 128) + 0.4) / 128.0, (f64::from(k / 128) + 0.6) / 128.0)).collect();
    for cosine in [1.0f64, 0.7, 0.3, 0.1] {
        let towards = DVec3::new((1.0 - cosine * cosine).sqrt(), 0.0, cosine);
        let light = mean(&scene, towards, &places);
        assert!((light / cosine - 1.0).abs() < 0.03, "{cosine}: {light}");
    }
}

/// Faults of a normal map leave the surface smooth, and say so. Clouds recognize the map.
///
/// Seen to catch: triangles without end around one point, for each of which the library calls itself; a digest without
/// the map.
#[test]
fn faults_leave_the_surface_smooth() {
    let good = mapped(&pyramid(), json!({}));
    let mut unreadable = good.clone();
    unreadable.set("/images/0", json!({ "uri": "nowhere.png" }));
    let mut infinite = good.clone();
    infinite.set("/materials/0/normalTexture/scale", json!(1e39));
    for (asset, word) in [(unreadable, "nowhere.png"), (infinite, "scale inf must be finite")] {
        let scene = asset.import().expect("imports");
        assert!(scene.warnings.iter().any(|w| w.contains(word) && w.contains("smooth")), "{:?}", scene.warnings);
        assert_eq!(at(&scene, 0.2, 0.1).normal, DVec3::Z);
        assert_ne!(scene.geometry_digest(), import(&good).geometry_digest());
    }
    let mut fan = good.clone();
    let around: Vec<[f32; 3]> = (0..200_000).map(|k| (k as f32 * 3e-5).sin_cos()).map(|(s, c)| [s, c, 0.1]).collect();
    let positions: Vec<[f32; 3]> = [[0.0; 3]].into_iter().chain(around).collect();
    let coordinates: Vec<u8> =
        positions.iter().flat_map(|p| [p[0].to_le_bytes(), p[1].to_le_bytes()].concat()).collect();
    let indices: Vec<u32> = (1..200_000).flat_map(|k| [0, k + 1, k]).collect();
    let (count, positions) = (positions.len(), fan.vectors(&positions));
    let (coordinates, indices) = (fan.accessor(&coordinates, "VEC2", FLOAT, count), fan.long_indices(&indices));
    let attributes = json!({ "POSITION": positions, "TEXCOORD_0": coordinates });
    fan.set("/meshes/0/primitives/0", json!({ "attributes": attributes, "indices": indices, "material": 0 }));
    let warnings = fan.import().expect("imports").warnings;
    assert!(warnings.iter().any(|w| w.contains("triangles share points")), "{warnings:?}");
}

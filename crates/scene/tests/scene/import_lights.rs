//! Lights, cameras and materials of glTF files.

use scene::{DVec3, ImportOptions, LightUnit, NormalKind, Projection, Scene, SurfacePoint};
use serde_json::{Value, json};
use test_support::glb::{Asset, OPTIONS, tetrahedron};

/// A point at `position` in the world that faces `normal`.
fn facing(scene: &Scene, position: DVec3, normal: DVec3) -> SurfacePoint {
    let mut point = scene.mesh.point(0, [1.0, 0.0, 0.0], NormalKind::Geometric);
    (point.position, point.normal, point.geometric_normal) = (position - scene.origin, normal, normal);
    point
}

/// Irradiance at a point by the scene's only light; 0 if there is none.
fn irradiance(scene: &Scene, position: DVec3, normal: DVec3) -> DVec3 {
    assert_eq!(scene.file_lights.len(), 1);
    let light = scene.file_lights[0].illuminate(&facing(scene, position, normal), [0.5; 2]);
    light.map_or(DVec3::ZERO, |l| l.irradiance)
}

/// The tetrahedron with one light on this node.
fn lit(light: Value, node: Value) -> Asset {
    let mut asset = tetrahedron();
    asset.set("/scenes/0/nodes", json!([0]));
    asset.light(light, node);
    asset
}

fn import(asset: &Asset) -> Scene {
    asset.import().expect("a good file")
}

#[test]
fn lights_shine_along_minus_z_whatever_the_scale_of_their_nodes() {
    for scale in [json!([1, 1, 1]), json!([0.01, 0.01, 0.01]), json!([5, 1, 3])] {
        let mut asset = lit(json!({ "type": "directional", "intensity": 3 }), json!({}));
        // The light's node is the child of a scaled one that turns -z to -x.
        let half = std::f64::consts::FRAC_1_SQRT_2;
        asset.set("/scenes/0/nodes", json!([0, 4]));
        asset.push("nodes", json!({ "children": [3], "rotation": [0, half, 0, half], "scale": scale }));
        let scene = import(&asset);
        assert!((irradiance(&scene, DVec3::ZERO, DVec3::X).x - 3.0).abs() < 1e-12);
        assert_eq!(irradiance(&scene, DVec3::ZERO, DVec3::NEG_X), DVec3::ZERO);
    }
}

#[test]
fn a_point_lights_intensity_ignores_scale_and_its_place_does_not() {
    let mut asset = lit(json!({ "type": "point", "intensity": 8 }), json!({ "translation": [0, 0, 1] }));
    asset.set("/scenes/0/nodes", json!([0, 4]));
    asset.push("nodes", json!({ "children": [3], "scale": [2, 2, 2] }));
    assert_eq!(irradiance(&import(&asset), DVec3::ZERO, DVec3::Z), DVec3::splat(2.0));
    // A point light needs no direction, so that its node may have scale 0.
    asset.set("/nodes/4/scale", json!([0, 0, 0]));
    assert_eq!(irradiance(&import(&asset), DVec3::new(0.0, 0.0, -2.0), DVec3::Z), DVec3::splat(2.0));
}

#[test]
fn colors_add_up_to_white() {
    let light = |color: Value| import(&lit(json!({ "type": "point", "color": color, "intensity": 2 }), json!({})));
    let at = |scene: Scene| irradiance(&scene, DVec3::new(0.0, 0.0, -0.5), DVec3::Z);
    let sum: DVec3 = [json!([1, 0, 0]), json!([0, 1, 0]), json!([0, 0, 1])].map(|c| at(light(c))).iter().sum();
    assert_eq!(sum, at(light(json!([1, 1, 1]))));
    assert_eq!(sum, DVec3::splat(8.0));
}

#[test]
fn spot_cones_have_the_defaults_of_the_standard() {
    let scene = import(&lit(json!({ "type": "spot", "spot": {}, "intensity": 1 }), json!({})));
    let at = |degrees: f64| {
        let (sine, cosine) = degrees.to_radians().sin_cos();
        let towards = DVec3::new(sine, 0.0, -cosine);
        irradiance(&scene, towards, -towards).x
    };
    let outer = std::f64::consts::FRAC_PI_4.cos();
    let half_way = (30f64.to_radians().cos() - outer) / (1.0 - outer);
    assert!((at(0.0) - 1.0).abs() < 1e-12);
    assert!((at(30.0) - half_way * half_way).abs() < 1e-6, "the angles are 0 and pi/4");
    assert_eq!((at(45.1), at(180.0)), (0.0, 0.0));
    let sharp = json!({ "type": "spot", "spot": { "innerConeAngle": 0.5, "outerConeAngle": 0.5 }, "intensity": 1 });
    assert!(irradiance(&import(&lit(sharp, json!({}))), DVec3::NEG_Z, DVec3::Z).x > 0.99);
}

#[test]
fn range_is_in_units_of_the_file() {
    let options = ImportOptions { metres_per_unit: 0.1, ..OPTIONS };
    let asset = lit(json!({ "type": "point", "intensity": 1, "range": 10 }), json!({}));
    let scene = asset.import_with(&options).expect("a good file");
    let at = |d: f64| irradiance(&scene, DVec3::new(0.0, 0.0, -d), DVec3::Z).x;
    assert!((at(0.5) - 4.0 * (1.0 - 0.5f64.powi(4))).abs() < 1e-12);
    assert_eq!(at(1.0), 0.0);
}

#[test]
fn photometric_numbers_are_divided_by_683() {
    let lights = [json!({ "type": "directional", "intensity": 683 }), json!({ "type": "point", "intensity": 683 })];
    for light in lights {
        let asset = lit(light, json!({}));
        let with = |unit| asset.import_with(&ImportOptions { light_unit: Some(unit), ..OPTIONS }).expect("a good file");
        let at = |scene: Scene| irradiance(&scene, DVec3::NEG_Z, DVec3::Z);
        assert_eq!(at(with(LightUnit::Radiometric)), DVec3::splat(683.0));
        assert!(at(with(LightUnit::Photometric)).distance(DVec3::ONE) < 1e-12);
    }
}

/// Blender writes lights in candela and emission in W: each has a unit of its own.
///
/// Seen to catch: emission in the unit of the lights.
#[test]
fn emission_has_a_unit_of_its_own() {
    let mut asset = lit(json!({ "type": "point", "intensity": 683 }), json!({}));
    asset.set("/materials/0/emissiveFactor", json!([1, 0.5, 0]));
    let (watts, lumens) = (LightUnit::Radiometric, LightUnit::Photometric);
    for (light_unit, emission_unit) in [(watts, watts), (watts, lumens), (lumens, watts), (lumens, lumens)] {
        let units = ImportOptions { light_unit: Some(light_unit), emission_unit: Some(emission_unit), ..OPTIONS };
        let scene = asset.import_with(&units).expect("a good file");
        let light = scene.file_lights[0].illuminate(&facing(&scene, DVec3::NEG_Z, DVec3::Z), [0.5; 2]).expect("lit");
        let factor = |unit| if unit == watts { 1.0 } else { 1.0 / 683.0 };
        assert!(light.irradiance.distance(DVec3::splat(683.0 * factor(light_unit))) < 1e-10);
        let emission = scene.materials[0].emission;
        assert!(emission.distance(DVec3::new(1.0, 0.5, 0.0) * factor(emission_unit)) < 1e-12, "{emission}");
    }
}

/// What is left open is decided by the program that wrote the file, and by whether it has lights: Blender's lamps are
/// multiplied by 683 lm/W and its emission is not, glTF says lux, candela and nits, and a file without a writer, or
/// whose lamps are all weak, is in watts. One line says what was decided.
///
/// Seen to catch: the emission of Blender divided too; a decision that overrides what is given; weak lamps divided.
#[test]
fn the_writer_of_a_file_decides_its_units() {
    let (watts, lumens) = (LightUnit::Radiometric, LightUnit::Photometric);
    let open = ImportOptions { light_unit: None, emission_unit: None, ..OPTIONS };
    let units = |generator: Option<&str>, has_light: bool, options: &ImportOptions| {
        let mut asset =
            if has_light { lit(json!({ "type": "point", "intensity": 683 }), json!({})) } else { tetrahedron() };
        if !has_light {
            asset.set("/scenes/0/nodes", json!([0]));
        }
        if let Some(generator) = generator {
            asset.set("/asset/generator", json!(generator));
        }
        let units = asset.import_with(options).expect("a good file").units;
        ([units.light, units.emission], units.note)
    };
    for (generator, expected, word) in [
        (None, [watts, watts], None),
        (Some("make-scenes"), [watts, watts], None),
        (Some("Khronos glTF Blender I/O v4.5.51"), [lumens, watts], Some("`Khronos glTF Blender I/O v4.5.51`")),
        (Some("blender"), [lumens, watts], Some("lights in lux and candela, emission in watts")),
        (Some("COLLADA2GLTF"), [lumens, lumens], Some("emission in nits, as glTF says")),
    ] {
        let (found, note) = units(generator, true, &open);
        assert_eq!(found, expected, "{generator:?}");
        assert_eq!(note.is_some(), word.is_some(), "{note:?}");
        assert!(note.iter().zip(word).all(|(note, word)| note.contains(word)), "{note:?}");
        assert_eq!(units(generator, false, &open), ([watts; 2], None), "{generator:?} without lights");
        assert_eq!(units(generator, true, &OPTIONS), ([watts; 2], None), "{generator:?} with given units");
    }
    let weak = |intensity: f64| {
        let mut asset = lit(json!({ "type": "directional", "intensity": intensity }), json!({}));
        asset.set("/asset/generator", json!("Khronos glTF Blender I/O v4.5.51"));
        let units = asset.import_with(&open).expect("a good file").units;
        assert!(units.note.is_some());
        units.light
    };
    assert_eq!([99.0, 100.0].map(weak), [watts, lumens]);
    let half = ImportOptions { light_unit: Some(watts), ..open };
    assert_eq!(units(Some("COLLADA2GLTF"), true, &half).0, [watts, lumens]);
}

#[test]
fn a_light_without_intensity_is_left_out_with_a_warning() {
    let scene = import(&lit(json!({ "type": "point", "intensity": 0 }), json!({ "name": "dark" })));
    assert!(scene.file_lights.is_empty());
    assert!(scene.warnings.iter().any(|w| w.contains("`dark`")), "{:?}", scene.warnings);
}

#[test]
fn emitting_materials_are_area_lights() {
    let mut asset = tetrahedron();
    asset.set("/scenes/0/nodes", json!([0]));
    asset.set("/extensionsRequired", json!(["KHR_materials_emissive_strength"]));
    asset.set("/materials/0/emissiveFactor", json!([1, 1, 1]));
    asset.set("/materials/0/extensions", json!({ "KHR_materials_emissive_strength": { "emissiveStrength": 4 } }));
    // A material without triangles gives no light.
    asset.push("materials", json!({ "emissiveFactor": [9, 9, 9] }));
    let scene = import(&asset);
    assert_eq!((scene.file_lights.len(), scene.materials[0].emission), (1, DVec3::splat(4.0)));
    assert!(irradiance(&scene, DVec3::splat(-100.0), DVec3::ONE.normalize()).x > 0.0);
}

/// Seen to catch: the cosines of the angles in the digest, which are 1 for both narrow spots.
#[test]
fn the_light_digest_tells_lights_apart() {
    let digest = |light: Value| import(&lit(light, json!({}))).light_digest();
    let spot = |outer: f64| json!({ "type": "spot", "spot": { "outerConeAngle": outer }, "intensity": 1 });
    let all = [
        digest(json!({ "type": "point", "intensity": 1 })),
        digest(json!({ "type": "point", "intensity": 2 })),
        digest(json!({ "type": "point", "intensity": 1, "range": 5 })),
        digest(json!({ "type": "directional", "intensity": 1 })),
        digest(spot(0.5)),
        digest(spot(0.6)),
        digest(spot(1e-9)),
        digest(spot(2e-9)),
    ];
    for (k, one) in all.iter().enumerate() {
        assert!(!all[..k].contains(one), "{k}");
    }
    assert_eq!(all[4], digest(spot(0.5)));
}

#[test]
fn cameras_look_along_minus_z_whatever_the_scale_of_their_nodes() {
    let mut asset = tetrahedron();
    asset.set("/scenes/0/nodes", json!([0, 3]));
    let half = std::f64::consts::FRAC_1_SQRT_2;
    asset.push("nodes", json!({ "children": [2], "rotation": [0, half, 0, half], "scale": [3, 2, 0.1] }));
    asset.set("/nodes/2/translation", json!([0, 1, 10]));
    let camera = import(&asset).cameras[0].clone();
    assert_eq!(camera.name, "eye");
    let close = |a: DVec3, b: DVec3| assert!(a.distance(b) < 1e-12, "{a} {b}");
    close(camera.forward, DVec3::NEG_X);
    close(camera.up, DVec3::Y);
    close(camera.right, DVec3::NEG_Z);
    close(camera.position, DVec3::new(1.0, 2.0, 0.0));
    let Projection::Perspective { tangent } = camera.projection else { panic!("perspective") };
    assert!((tangent - 0.25f64.tan()).abs() < 1e-7 && camera.aspect.is_none());
}

#[test]
fn orthographic_cameras_have_a_height_in_metres() {
    let mut asset = tetrahedron();
    let orthographic = json!({ "xmag": 4, "ymag": 2, "znear": 0, "zfar": 1 });
    asset.set("/cameras/0", json!({ "type": "orthographic", "orthographic": orthographic }));
    let scene = asset.import_with(&ImportOptions { metres_per_unit: 0.01, ..OPTIONS }).expect("a good file");
    assert_eq!(scene.cameras[0].projection, Projection::Orthographic { half_height: 0.02 });
    assert_eq!(scene.cameras[0].aspect, Some(2.0));
}

#[test]
fn volumes_are_marked_by_their_extension() {
    let volume = |value: Value| {
        let mut asset = tetrahedron();
        asset.set("/extensionsRequired", json!(["KHR_materials_volume", "KHR_materials_transmission"]));
        asset.set("/materials/0/extensions", json!({ "KHR_materials_volume": value }));
        import(&asset).materials[0].volume
    };
    assert!(volume(json!({ "thicknessFactor": 0.1 })));
    assert!(!volume(json!({})), "thin-walled");
    assert!(!import(&tetrahedron()).materials[0].volume);
    let mut draft = tetrahedron();
    draft.set("/materials/0/extensions", json!({ "KHR_materials_volume_scatter": {} }));
    assert!(import(&draft).materials[0].volume);
}

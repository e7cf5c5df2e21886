//! Thin walls, which scatter light to both sides.

use crate::import_textures::{NEAREST, add_picture, linear, png};
use scene::{
    DVec3, Rays, Scene, WallShares,
    light::{Light, LightTree, reflected},
};
use serde_json::{Value, json};
use test_support::glb::{Asset, FLOAT, tetrahedron};

const LEAF: u16 = 1;

/// The tetrahedron, marked as a volume, and far from it a square over x and y from 0 to 1 at z = 5, above which is a lamp
/// of 3 W/m² and below which is one of 5 W/m².
fn leaf(extensions: Value) -> Asset {
    let mut asset = tetrahedron();
    asset.set("/materials/0/extensions", json!({ "KHR_materials_volume": { "thicknessFactor": 1 } }));
    let base = json!({ "baseColorFactor": [0.5, 1, 0.25, 1] });
    asset.push("materials", json!({ "name": "leaf", "extensions": extensions, "pbrMetallicRoughness": base }));
    let positions = asset.vectors(&[[0.0, 0.0, 5.0], [1.0, 0.0, 5.0], [1.0, 1.0, 5.0], [0.0, 1.0, 5.0]]);
    let indices = asset.indices(&[0, 1, 2, 0, 2, 3]);
    let coordinates: Vec<u8> =
        [0.0f32, 0.0, 1.0, 0.0, 1.0, 1.0, 0.0, 1.0].iter().flat_map(|x| x.to_le_bytes()).collect();
    let coordinates = asset.accessor(&coordinates, "VEC2", FLOAT, 4);
    let attributes = json!({ "POSITION": positions, "TEXCOORD_0": coordinates });
    let mesh = asset.mesh(json!({ "attributes": attributes, "indices": indices, "material": LEAF }));
    asset.node(json!({ "mesh": mesh }));
    for (intensity, rotation) in [(3, [0, 0, 0, 1]), (5, [1, 0, 0, 0])] {
        asset.light(json!({ "type": "directional", "intensity": intensity }), json!({ "rotation": rotation }));
    }
    asset
}

fn import(extensions: Value) -> Scene {
    leaf(extensions).import().expect("imports")
}

/// Diffuse transmission by this share, with a color.
fn diffuse(share: f64) -> Value {
    json!({ "KHR_materials_diffuse_transmission": {
        "diffuseTransmissionFactor": share, "diffuseTransmissionColorFactor": [1, 0.5, 0.25] } })
}

/// The newer draft for scattering, with this strength behind a transmission.
fn scatter(transmission: f64, strength: f64) -> Value {
    json!({
        "KHR_materials_transmission": { "transmissionFactor": transmission },
        "KHR_materials_scatter": { "scatterStrengthFactor": strength, "scatterAnisotropy": 0.5,
            "multiscatterColorFactor": [1, 0.5, 0] },
    })
}

fn assert_wall(extensions: Value, expected: WallShares) {
    let scene = import(extensions.clone());
    let wall = scene.materials[1].wall.as_ref().expect("a wall").plain();
    let close = (wall.base - expected.base).abs() < 1e-7 && (wall.clear - expected.clear).abs() < 1e-7;
    assert!(close && wall.back.abs_diff_eq(expected.back, 1e-7), "{extensions}: {wall:?}");
    assert!(wall.through.abs_diff_eq(expected.through, 1e-7), "{extensions}: {wall:?}");
    assert!(scene.is_wall(LEAF) && !scene.is_pane(LEAF) && scene.translucent() == Ok((vec![0], false)));
    assert_eq!(scene.warnings, Vec::<String>::new(), "{extensions}");
}

/// By hand: the numbers of the extensions in the formulas of docs/method.md (13.8).
///
/// Seen to catch: the shares of the two sides exchanged; the default color of the older draft; a warning about a solid where
/// there is a wall.
#[test]
fn files_describe_walls() {
    let of_diffuse = WallShares { base: 0.25, back: DVec3::ZERO, through: DVec3::new(0.75, 0.375, 0.1875), clear: 0.0 };
    assert_wall(diffuse(0.75), of_diffuse);
    let mut flat = diffuse(0.75);
    flat["KHR_materials_volume"] = json!({ "thicknessFactor": 0 });
    assert_wall(flat, of_diffuse);
    let color = DVec3::new(1.0, 0.5, 0.0);
    assert_wall(scatter(1.0, 1.0), WallShares { base: 0.0, back: color * 0.25, through: color * 0.75, clear: 0.0 });
    // Of 0.5 that enters, 0.25 goes straight; of the other 0.75 two thirds are base color.
    let half = WallShares { base: 2.0 / 3.0, back: color / 12.0, through: color * 0.25, clear: 0.25 };
    assert_wall(scatter(0.5, 0.5), half);
    let mut white = scatter(1.0, 1.0);
    white["KHR_materials_scatter"] = json!({ "scatterStrengthFactor": 1 });
    assert_wall(white, WallShares { base: 0.0, back: DVec3::splat(0.5), through: DVec3::splat(0.5), clear: 0.0 });
}

/// The leaf with a picture of two by two texels as its only texture, over the square; `extensions` name it.
fn textured(extensions: Value) -> Asset {
    let mut asset = leaf(extensions);
    add_picture(&mut asset, &png(), json!({ "magFilter": NEAREST }));
    asset
}

/// The textures of a share and of a color, whose pictures are half a picture apart, named as an extension does.
fn textures([share, color]: [&str; 2]) -> Value {
    let moved = json!({ "KHR_texture_transform": { "offset": [0.5, 0] } });
    json!({ share: { "index": 0, "extensions": moved }, color: { "index": 0 } })
}

/// `extensions` with more in the one of this name.
fn with(mut extensions: Value, name: &str, more: &Value) -> Value {
    let own = extensions[name].as_object_mut().expect("the extension is there");
    own.extend(more.as_object().expect("an object").clone());
    extensions
}

const OF_DIFFUSE: [&str; 2] = ["diffuseTransmissionTexture", "diffuseTransmissionColorTexture"];
const OF_SCATTER: [&str; 2] = ["scatterStrengthTexture", "multiscatterColorTexture"];

/// By hand, in the middle of each texel: alpha is a factor of the share, and colors of the color.
///
/// Seen to catch: the two textures exchanged; the coordinates of one for both; colors that are not linear; the numbers of
/// a wall named as not honoured.
#[test]
fn textures_vary_walls() {
    let older = with(diffuse(0.75), "KHR_materials_diffuse_transmission", &textures(OF_DIFFUSE));
    let draft = with(scatter(0.5, 0.5), "KHR_materials_scatter", &textures(OF_SCATTER));
    let [mut older, mut draft] = [older, draft].map(|extensions| textured(extensions).import().expect("imports"));
    for scene in [&mut older, &mut draft] {
        scene.warn_of_unhonoured(|k| k != LEAF);
        assert_eq!(scene.warnings, Vec::<String>::new());
    }
    let base = DVec3::new(0.5, 1.0, 0.25);
    for (column, row) in [(0, 0), (1, 0), (0, 1), (1, 1)] {
        let (x, y) = (0.25 + 0.5 * f64::from(column), 0.25 + 0.5 * f64::from(row));
        let (triangle, weights) = if x >= y { (0, [1.0 - x, x - y, y]) } else { (1, [1.0 - y, x, y - x]) };
        let (alpha, color) = (linear(1 - column, row).w, linear(column, row).truncate());
        let at = |scene: &Scene| {
            let of_leaf = scene.mesh.triangles.iter().position(|t| t.material == LEAF).expect("the leaf");
            scene.wall(of_leaf as u32 + triangle, weights).expect("a wall")
        };
        let wall = at(&older);
        assert!(wall.back.abs_diff_eq(base * (1.0 - 0.75 * alpha), 1e-7), "{column} {row}: {wall:?}");
        let through = DVec3::new(1.0, 0.5, 0.25) * color * (0.75 * alpha);
        assert!(wall.through.abs_diff_eq(through, 1e-7), "{column} {row}: {wall:?}");
        let (wall, scattered) = (at(&draft), 0.25 * alpha);
        let met = 0.5 + scattered;
        let color = DVec3::new(1.0, 0.5, 0.0) * color * (scattered / met);
        assert!(wall.back.abs_diff_eq(base * 0.5 / met + color * 0.25, 1e-7), "{column} {row}: {wall:?}");
        assert!(wall.through.abs_diff_eq(color * 0.75, 1e-7), "{column} {row}: {wall:?}");
    }
}

/// Of the rays that meet the fourth texel, whose alpha is 0, all go straight that enter; of the first, whose alpha is 1, as
/// many as without a texture.
///
/// Seen to catch: one share of rays for all of the wall.
#[test]
fn a_texture_varies_the_rays_that_cross_a_wall() {
    let share = json!({ "scatterStrengthTexture": { "index": 0 } });
    let scene = textured(with(scatter(0.8, 0.5), "KHR_materials_scatter", &share)).import().expect("imports");
    let rays = Rays::of_scene(&scene, |k| k == 0);
    let passing = |first: f64| {
        let passes = |k: &u32| {
            let at = |k: u32| first + f64::from(k) / 410.0 + 2e-3;
            let from = DVec3::new(at(k % 200), at(k / 200), 6.0);
            rays.visible(from - scene.origin, DVec3::NEG_Z, 2.0, None)
        };
        (0..40_000).filter(passes).count() as f64 / 40_000.0
    };
    let (all, half) = (passing(0.5), passing(0.0));
    assert!((all - 0.8).abs() < 0.009 && (half - 0.4).abs() < 0.01, "{all} {half}");
}

/// Seen to catch: a fault that refuses the file.
#[test]
fn a_texture_of_a_wall_that_cannot_be_read_is_said() {
    let extensions = with(diffuse(0.75), "KHR_materials_diffuse_transmission", &textures(OF_DIFFUSE));
    let mut asset = textured(extensions);
    asset.set("/images/0/mimeType", json!("image/gif"));
    let at = asset.json["bufferViews"].as_array().expect("views").last().expect("one")["byteOffset"].as_u64();
    let at = at.expect("an offset") as usize;
    asset.binary[at..].fill(0);
    let scene = asset.import().expect("imports");
    let said = scene.warnings.join("\n");
    assert!(OF_DIFFUSE.iter().all(|name| said.contains(name)) && said.contains("its factor alone"), "{said}");
    let wall = scene.materials[usize::from(LEAF)].wall.as_ref().expect("a wall");
    assert_eq!(wall.textures, [None, None]);
}

/// What has a volume, the older draft, nothing that scatters, a medium of its own, or no other translucent surface beside
/// it is no wall. Of those the draft's warning is said.
///
/// Seen to catch: walls beside which nothing is sampled.
#[test]
fn what_is_no_wall() {
    let mut solid = diffuse(0.75);
    solid["KHR_materials_volume"] = json!({ "thicknessFactor": 0.1 });
    let older = json!({
        "KHR_materials_transmission": { "transmissionFactor": 1 },
        "KHR_materials_volume_scatter": { "multiscatterColorFactor": [1, 1, 1] },
    });
    for extensions in [solid, older, diffuse(0.0), scatter(1.0, 0.0), scatter(0.0, 1.0)] {
        assert!(!import(extensions.clone()).is_wall(LEAF), "{extensions}");
    }
    let mut stated = leaf(diffuse(0.75));
    stated.json["materials"][1]["extras"] = json!({ "medium": "marble" });
    assert!(!stated.import().expect("imports").is_wall(LEAF));
    let mut extensions = scatter(1.0, 1.0);
    extensions["KHR_materials_volume"] = json!({ "attenuationDistance": 1, "attenuationColor": [0.5, 0.5, 0.5] });
    let mut alone = leaf(extensions);
    alone.set("/materials/0/extensions", json!({}));
    let scene = alone.import().expect("imports");
    assert!(!scene.is_wall(LEAF) && scene.translucent() == Ok((vec![LEAF], false)));
    assert!(scene.warnings.concat().contains("rendered as the solid that it bounds"), "{:?}", scene.warnings);
}

/// Both lamps light both sides, each the viewer's by its own share.
///
/// Seen to catch: light from behind left out; the same side lit twice; the base color left out.
#[test]
fn walls_are_lit_from_both_sides() {
    let scene = import(scatter(0.5, 0.5));
    let (rays, lights) =
        (Rays::of_scene(&scene, |k| k == 0), LightTree::new(scene.file_lights.iter().map(|l| &**l as &dyn Light)));
    let solid = Rays::of_scene(&scene, |_| true);
    let base = DVec3::new(0.5, 1.0, 0.25);
    let color = DVec3::new(1.0, 0.5, 0.0);
    let [back, through] = [base * 2.0 / 3.0 + color / 12.0, color * 0.25];
    for (up, own, other) in [(1.0, 3.0, 5.0), (-1.0, 5.0, 3.0)] {
        // The tetrahedron does not lie below this place.
        let from = DVec3::new(0.8, 0.9, 5.0 + up) - scene.origin;
        let hit = solid.closest(from, DVec3::new(0.0, 0.0, -up), None).expect("the wall");
        let point = scene.mesh.point(hit.triangle, hit.weights, scene::NormalKind::Geometric).facing(DVec3::Z * up);
        let mut shadow_rays = 0;
        let found = reflected(&scene, &lights, (&rays, &hit), &point, || [0.5; 2], &mut shadow_rays);
        assert!(found.abs_diff_eq(back * own + through * other, 1e-6), "{up}: {found}");
        assert_eq!(shadow_rays, 2);
    }
}

/// A quarter of the rays goes straight on, of 40000 within four standard deviations, and none where the wall is sampled as
/// translucent. Alpha makes holes besides.
///
/// Seen to catch: walls that are opaque to rays; alpha left out of them.
#[test]
fn some_rays_cross_a_wall() {
    let passing = |asset: &Asset, translucent: bool| {
        let scene = asset.import().expect("imports");
        let rays = Rays::of_scene(&scene, |k| k == 0 || translucent);
        let passes = |k: &u32| {
            let from = DVec3::new(f64::from(k % 200) / 200.0, f64::from(k / 200) / 200.0, 6.0) + DVec3::splat(1e-3);
            rays.visible(from - scene.origin, DVec3::NEG_Z, 2.0, None)
        };
        (0..40_000).filter(passes).count() as f64 / 40_000.0
    };
    let mut wall = leaf(scatter(0.5, 0.5));
    assert!((passing(&wall, false) - 0.25).abs() < 0.009);
    assert_eq!(passing(&wall, true), 0.0);
    assert_eq!(passing(&leaf(diffuse(0.75)), false), 0.0);
    wall.set("/materials/1/alphaMode", json!("BLEND"));
    wall.set("/materials/1/pbrMetallicRoughness/baseColorFactor", json!([1, 1, 1, 0.4]));
    assert!((passing(&wall, false) - 0.7).abs() < 0.01);
    wall.set("/materials/1/alphaMode", json!("MASK"));
    assert_eq!(passing(&wall, false), 1.0);
}

/// Clouds of other walls are other clouds.
///
/// Seen to catch: the numbers of the wall, or which texture it is, left out of the identity.
#[test]
fn the_identity_of_a_scene_depends_on_its_walls() {
    let [one, other, opaque] = [diffuse(0.75), diffuse(0.5), diffuse(0.0)].map(|e| import(e).geometry_digest());
    assert!(one != other && other != opaque && one != opaque);
    let of_texture = |name: &str| {
        let own = json!({ name: { "index": 0 } });
        let extensions = with(diffuse(0.75), "KHR_materials_diffuse_transmission", &own);
        textured(extensions).import().expect("imports").geometry_digest()
    };
    let [share, color] = OF_DIFFUSE.map(of_texture);
    assert!(share != color && share != one && color != one);
}

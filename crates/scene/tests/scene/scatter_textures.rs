//! Textures of the color after multiple scattering.

use crate::{
    import_textures::{NEAREST, add_picture, linear, png, square},
    import_volumes::volume,
};
use scene::{DVec3, DVec4, ScatterExtension};
use serde_json::{Value, json};
use test_support::glb::{Asset, FLOAT, fault};

/// A square of two by two texels as the color of its medium, and the texture with more fields.
fn with_texture(draft: ScatterExtension, more: Value) -> Asset {
    let mut texture = json!({ "index": 0 });
    texture.as_object_mut().expect("an object").extend(more.as_object().expect("an object").clone());
    let extensions = json!({
        "KHR_materials_volume": volume(),
        "KHR_materials_transmission": { "transmissionFactor": 1 },
        draft.extension(): {
            "multiscatterColorFactor": [1, 0.5, 0.25], "scatterStrengthFactor": 1, "multiscatterColorTexture": texture
        },
    });
    let mut asset = Asset::new();
    let base = json!({ "baseColorFactor": [1, 1, 1, 1] });
    let mut primitive =
        square(&mut asset, json!({ "name": "wax", "extensions": extensions, "pbrMetallicRoughness": base }));
    // The second set is the first turned by half a turn.
    let turned: Vec<u8> = [1.0f32, 1.0, 0.0, 1.0, 0.0, 0.0, 1.0, 0.0].iter().flat_map(|x| x.to_le_bytes()).collect();
    primitive["attributes"]["TEXCOORD_1"] = asset.accessor(&turned, "VEC2", FLOAT, 4).into();
    asset.mesh(primitive);
    add_picture(&mut asset, &png(), json!({ "magFilter": NEAREST }));
    asset
}

/// A texture varies the color after multiple scattering, whose mean over the surface, a quarter of each texel, is that of
/// the medium. It is a picture of sRGB, has its own set of coordinates and transform, and is no base color.
///
/// Seen to catch: codes taken as linear; the coordinates of the base color; the mean left out; the texture of a solid that
/// the file calls thin left out; the picture as base color too.
#[test]
fn a_texture_varies_the_color_of_a_medium() {
    let moved = json!({ "KHR_texture_transform": { "offset": [0.5, 0] } });
    let texels = [(0, 0), (1, 0), (0, 1), (1, 1)];
    let mean = texels.map(|(x, y)| linear(x, y).truncate()).iter().sum::<DVec3>() * 0.25;
    for draft in [ScatterExtension::VolumeScatter, ScatterExtension::Scatter] {
        for (more, from) in [
            (json!({}), [0, 0]),
            (json!({ "texCoord": 1 }), [1, 1]),
            (json!({ "extensions": moved }), [1, 0]),
            (json!({ "texCoord": 1, "extensions": moved }), [0, 1]),
        ] {
            for thickness in [1, 0] {
                let mut asset = with_texture(draft, more.clone());
                asset.set("/materials/0/extensions/KHR_materials_volume/thicknessFactor", json!(thickness));
                let mut scene = asset.import().expect("imports");
                scene.warn_of_unhonoured(|_| true);
                assert!(scene.warnings.iter().all(|w| w.contains("thicknessFactor is 0")), "{:?}", scene.warnings);
                for (x, y) in texels {
                    let [column, row] = [x, y].map(|k: u32| 0.25 + 0.5 * f64::from(k));
                    let (triangle, weights) = match x >= y {
                        true => (0, [1.0 - column, column - row, row]),
                        false => (1, [1.0 - row, column, row - column]),
                    };
                    let color = scene.texture_color(triangle, weights);
                    let expected = linear((x + from[0]) % 2, (y + from[1]) % 2).truncate();
                    assert!(color.scatter.abs_diff_eq(expected, 1e-7), "{more} at {x} {y}: {color:?}");
                    assert_eq!((color.base, scene.color(triangle, weights)), (DVec4::ONE, DVec4::ONE));
                }
                let scatter = scene.materials[0].medium.as_ref().and_then(|m| m.scatter.clone()).expect("it scatters");
                assert!(scatter.color.abs_diff_eq(DVec3::new(1.0, 0.5, 0.25) * mean, 1e-3), "{scatter:?}");
            }
        }
    }
}

/// A picture that cannot be read would change the medium, and is refused; one of a material that the scene does not use is
/// not read. The identity of a scene covers the texture.
///
/// Seen to catch: the texture left out of the identity; a number in place of a texture that is passed over.
#[test]
fn a_texture_of_scattering_belongs_to_the_scene() {
    let asset = || with_texture(ScatterExtension::Scatter, json!({}));
    let identity = |asset: &Asset| asset.import().expect("imports").geometry_digest();
    let mut other = asset();
    other.set("/samplers/0/wrapS", json!(33071));
    let mut none = asset();
    let draft = &mut none.json["materials"][0]["extensions"]["KHR_materials_scatter"];
    draft.as_object_mut().expect("an object").remove("multiscatterColorTexture");
    let identities = [asset(), other, none].map(|asset| identity(&asset));
    assert!(identities[0] != identities[1] && identities[0] != identities[2] && identities[1] != identities[2]);

    let mut lost = asset();
    lost.set("/images/0", json!({ "uri": "lost.png" }));
    let message = fault(&lost);
    for word in ["`wax`", "multiscatterColorTexture", "images[0] `lost.png`"] {
        assert!(message.contains(word), "{word}: {message}");
    }
    let mut number = asset();
    number.set("/materials/0/extensions/KHR_materials_scatter/multiscatterColorTexture", json!(3));
    assert!(fault(&number).contains("multiscatterColorTexture: not a texture"));
    lost.push("materials", json!({ "name": "other" }));
    lost.set("/meshes/0/primitives/0/material", json!(1));
    assert!(lost.import().is_ok());
}

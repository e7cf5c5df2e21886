//! Pictures of other formats and models of materials, and those that nothing needs.

use crate::import_textures::{NEAREST, assert_color, encoded, fault, linear, png, texels, textured, with_picture};
use image::{ImageFormat, Rgba, RgbaImage};
use scene::DVec4;
use serde_json::json;

/// The same texels as WebP, by the picture itself and by the extension that names it beside a PNG or alone.
///
/// Seen to catch: the source of the extension not looked at; a picture that ends early padded.
#[test]
fn webp_pictures() {
    let webp = encoded(&texels(), ImageFormat::WebP);
    let plain = with_picture(&webp, textured(json!({})), json!({ "magFilter": NEAREST }));
    let mut named = plain.clone();
    named.set("/textures/0", json!({ "sampler": 0, "extensions": { "EXT_texture_webp": { "source": 0 } } }));
    named.json["extensionsRequired"] = json!(["EXT_texture_webp"]);
    for asset in [plain, named] {
        let scene = asset.import().expect("imports");
        scene.check_textures(|_| false).expect("it can be read");
        for (x, y) in [(0, 0), (1, 0), (0, 1), (1, 1)] {
            assert_color(&scene, [x, y].map(|k| 0.5 * f64::from(k) + 0.25), linear(x, y));
        }
    }
    let long = encoded(
        &RgbaImage::from_fn(40, 24, |x, y| Rgba([6 * x as u8, 10 * y as u8, (x * y) as u8, 255])),
        ImageFormat::WebP,
    );
    for missing in 1..long.len() {
        let cut = with_picture(&long[..long.len() - missing], textured(json!({})), json!({}));
        assert!(fault(&cut).contains("images[0] `weave`: "), "{missing}");
    }
}

/// A picture that nobody can read is no fault on a translucent surface, nor on one that is not in the scene.
///
/// Seen to catch: textures of unused materials read.
#[test]
fn what_is_not_needed_is_not_read() {
    let scene = with_picture(b"KTX 20", textured(json!({})), json!({})).import().expect("imports");
    assert!(scene.check_textures(|_| true).is_ok() && scene.check_textures(|_| false).is_err());
    let mut asset = with_picture(b"KTX 20", textured(json!({})), json!({}));
    let plain = asset.push("materials", json!({ "name": "Plain" }));
    asset.set("/meshes/0/primitives/0/material", json!(plain));
    asset.import().expect("imports").check_textures(|_| false).expect("no surface needs it");
    asset.json["materials"][0]["emissiveFactor"] = json!([1, 1, 1]);
    asset.json["materials"][0]["emissiveTexture"] = json!({ "index": 0 });
    asset.import().expect("imports");
    asset.set("/meshes/0/primitives/0/material", json!(0));
    let message = asset.import().err().expect("its light is needed").to_string();
    assert!(message.contains("`Cloth`: emissiveTexture: images[0] `weave`: neither"), "{message}");
}

/// The older model of materials: its diffuse color, whatever the newer one says.
///
/// Seen to catch: the texture of the newer model.
#[test]
fn diffuse_color_of_specular_glossiness() {
    let older = json!({ "diffuseFactor": [0.5, 0.25, 1, 1], "diffuseTexture": { "index": 0 }, "glossinessFactor": 0 });
    let material = json!({ "name": "Cloth", "extensions": { "KHR_materials_pbrSpecularGlossiness": older },
        "pbrMetallicRoughness": { "baseColorFactor": [0, 0, 0, 0], "baseColorTexture": { "index": 7 } } });
    let mut asset = with_picture(&png(), material, json!({ "magFilter": NEAREST }));
    asset.json["extensionsRequired"] = json!(["KHR_materials_pbrSpecularGlossiness"]);
    let mut scene = asset.import().expect("imports");
    scene.check_textures(|_| false).expect("it can be read");
    assert_color(&scene, [0.25, 0.75], linear(0, 1) * DVec4::new(0.5, 0.25, 1.0, 1.0));
    scene.warn_of_unhonoured(|_| false);
    assert!(scene.warnings.len() == 1 && scene.warnings[0].contains("glossinessFactor"), "{:?}", scene.warnings);
    asset.json["materials"][0]["extensions"]["KHR_materials_pbrSpecularGlossiness"]["diffuseFactor"] = json!(["red"]);
    assert!(fault(&asset).contains("baseColorFactor"));
}

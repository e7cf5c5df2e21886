//! Metal and roughness: factors, their texture, index and specular factors, and what leaves a surface matt.

use super::import_textures::{NEAREST, png, texels, with_picture};
use scene::{DVec3, Scene};
use serde_json::{Value, json};

fn imported(material: Value) -> Scene {
    with_picture(&png(), material, json!({ "magFilter": NEAREST })).import().expect("imports")
}

const CENTER: (u32, [f64; 3]) = (0, [0.2, 0.3, 0.5]);

/// Roughness is the green and metal the blue of a texel, as numbers, times the factors.
#[test]
fn factors_multiply_the_texture() {
    let texture = json!({ "index": 0, "extensions": { "KHR_texture_transform": { "offset": [0.5, 0] } } });
    let scene = imported(json!({ "pbrMetallicRoughness": {
        "metallicFactor": 0.5, "roughnessFactor": 0.8, "baseColorFactor": [0.5, 1, 1, 1], "metallicRoughnessTexture": texture } }));
    assert!(scene.warnings.is_empty(), "{:?}", scene.warnings);
    // The transform shifts the upper left quarter to the second texel.
    let (triangle, weights) = (1, [0.75, 0.125, 0.125]);
    let [_, green, blue, _] = texels().get_pixel(1, 0).0.map(|code| f64::from(code) / 255.0);
    let gloss = scene.gloss(triangle, weights).expect("it is glossy");
    assert!((gloss.roughness - 0.8 * green).abs() < 1e-7 && (gloss.metallic - 0.5 * blue).abs() < 1e-7, "{gloss:?}");
    assert_eq!(scene.roughness(triangle, weights), Some(gloss.roughness));
    let diffuse = DVec3::new(0.5, 1.0, 1.0) * (1.0 - gloss.metallic);
    assert!(scene.diffuse(triangle, weights).abs_diff_eq(diffuse, 1e-7));
}

/// What states neither a roughness nor a metal is matt; what is left out beside one of them has glTF's default.
#[test]
fn surfaces_are_glossy_where_the_file_says_so() {
    let gloss = |pbr: Value| {
        let scene = imported(json!({ "pbrMetallicRoughness": pbr }));
        scene.gloss(CENTER.0, CENTER.1).map(|gloss| [gloss.metallic, gloss.roughness])
    };
    assert_eq!(gloss(json!({})), None);
    assert_eq!(gloss(json!({ "metallicFactor": 0 })), None);
    assert_eq!(gloss(json!({ "metallicFactor": 1 })), Some([1.0, 1.0]));
    assert_eq!(gloss(json!({ "roughnessFactor": 0.25 })), Some([1.0, 0.25]));
    assert_eq!(gloss(json!({ "roughnessFactor": 0.25, "metallicFactor": 0 })), Some([0.0, 0.25]));
}

/// `f₀ = ((n − 1)/(n + 1))²` times color and factor, `f₉₀` the factor.
#[test]
fn index_and_specular_factors_change_what_dielectrics_mirror() {
    let extensions = json!({ "KHR_materials_ior": { "ior": 2 },
        "KHR_materials_specular": { "specularFactor": 0.5, "specularColorFactor": [1, 0.5, 20] } });
    let material = json!({ "pbrMetallicRoughness": { "roughnessFactor": 0.5 }, "extensions": extensions });
    let layer = imported(material).gloss(CENTER.0, CENTER.1).expect("it is glossy").dielectric;
    assert!(layer.normal.abs_diff_eq(DVec3::new(1.0 / 18.0, 1.0 / 36.0, 0.5), 1e-7), "{layer:?}");
    assert_eq!(layer.grazing, DVec3::splat(0.5));
}

#[test]
fn a_bad_texture_is_left_out_and_a_bad_factor_refused() {
    let material = json!({ "name": "Tin", "pbrMetallicRoughness": { "metallicRoughnessTexture": { "index": 0 } } });
    let scene = with_picture(b"no picture", material, json!({})).import().expect("imports");
    let said = |warning: &String| warning.contains("`Tin`") && warning.contains("metallicRoughnessTexture");
    assert!(scene.warnings.iter().any(said), "{:?}", scene.warnings);
    assert!(scene.gloss(CENTER.0, CENTER.1).is_some_and(|gloss| gloss.roughness == 1.0));
    let material = json!({ "name": "Tin", "pbrMetallicRoughness": { "roughnessFactor": 1.5 } });
    let fault = with_picture(&png(), material, json!({})).import().err().expect("it is refused").to_string();
    assert!(fault.contains("`Tin`") && fault.contains("roughnessFactor 1.5"), "{fault}");
}

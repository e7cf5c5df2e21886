//! Base colors: factors, textures and vertex colors, at known points of a square.

use base64::{Engine, engine::general_purpose::STANDARD};
use image::{ImageFormat, Rgba, RgbaImage};
use scene::{DVec4, Scene};
use serde_json::{Value, json};
use std::io::Cursor;
use test_support::{
    Bench,
    glb::{Asset, FLOAT, OPTIONS, UNSIGNED_BYTE, UNSIGNED_SHORT},
};

/// Linear values of some sRGB codes (IEC 61966-2-1).
const LINEAR_64: f64 = 0.051_269_458;
const LINEAR_188: f64 = 0.502_886_458;

/// Why the file is refused where its surfaces are opaque.
pub fn fault(asset: &Asset) -> String {
    match asset.import() {
        Ok(scene) => scene.check_textures(|_| false).expect_err("a texture is needed").to_string(),
        Err(fault) => fault.to_string(),
    }
}

/// Two by two texels with alpha 255, 51, 102, 0.
pub fn texels() -> RgbaImage {
    let colors = [[255, 0, 64, 255], [0, 255, 188, 51], [64, 188, 0, 102], [188, 64, 255, 0]];
    RgbaImage::from_fn(2, 2, |x, y| Rgba(colors[(x + 2 * y) as usize]))
}

pub fn linear(x: u32, y: u32) -> DVec4 {
    let codes = texels().get_pixel(x, y).0;
    let [r, g, b] = [0, 1, 2].map(|c| match codes[c] {
        0 => 0.0,
        64 => LINEAR_64,
        188 => LINEAR_188,
        _ => 1.0,
    });
    DVec4::new(r, g, b, f64::from(codes[3]) / 255.0)
}

pub fn encoded(image: &RgbaImage, format: ImageFormat) -> Vec<u8> {
    let mut bytes = Cursor::new(Vec::new());
    let image = image::DynamicImage::from(image.clone());
    let image = if format == ImageFormat::Jpeg { image.into_rgb8().into() } else { image };
    image.write_to(&mut bytes, format).expect("encodes");
    bytes.into_inner()
}

/// A square of material 0 over x and y from 0 to 1, which faces +Z. Its texture coordinates are x, and y from the top.
pub fn square(asset: &mut Asset, material: Value) -> Value {
    asset.push("materials", material);
    let positions = asset.vectors(&[[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]]);
    let coordinates: [f32; 8] = [0.0, 0.0, 1.0, 0.0, 1.0, 1.0, 0.0, 1.0];
    let bytes: Vec<u8> = coordinates.iter().flat_map(|x| x.to_le_bytes()).collect();
    let coordinates = asset.accessor(&bytes, "VEC2", FLOAT, 4);
    let indices = asset.indices(&[0, 1, 2, 0, 2, 3]);
    asset.node(json!({ "mesh": 0 }));
    json!({ "attributes": { "POSITION": positions, "TEXCOORD_0": coordinates }, "indices": indices, "material": 0 })
}

pub fn textured(extra: Value) -> Value {
    let mut texture = json!({ "index": 0 });
    texture.as_object_mut().expect("an object").extend(extra.as_object().expect("an object").clone());
    json!({ "name": "Cloth", "pbrMetallicRoughness": { "baseColorTexture": texture } })
}

/// The square with a picture inside the .glb.
pub fn with_picture(bytes: &[u8], material: Value, sampler: Value) -> Asset {
    let mut asset = Asset::new();
    let primitive = square(&mut asset, material);
    asset.mesh(primitive);
    add_picture(&mut asset, bytes, sampler);
    asset
}

/// Adds texture 0, whose picture is inside the file.
pub fn add_picture(asset: &mut Asset, bytes: &[u8], sampler: Value) {
    let view = json!({ "buffer": 0, "byteOffset": asset.binary.len(), "byteLength": bytes.len() });
    asset.binary.extend(bytes);
    let view = asset.push("bufferViews", view);
    asset.push("images", json!({ "bufferView": view, "mimeType": "image/png", "name": "weave" }));
    asset.push("samplers", sampler);
    asset.push("textures", json!({ "source": 0, "sampler": 0 }));
}

/// The color of the square at x and y.
pub fn color_at(scene: &Scene, x: f64, y: f64) -> DVec4 {
    let (triangle, weights) = if x > y { (0, [1.0 - x, x - y, y]) } else { (1, [1.0 - y, x, y - x]) };
    scene.color(triangle, weights)
}

pub fn assert_color(scene: &Scene, [x, y]: [f64; 2], expected: DVec4) {
    let color = color_at(scene, x, y);
    assert!(color.abs_diff_eq(expected, 1e-7), "at {x} {y}: {color}, not {expected}");
}

pub fn png() -> Vec<u8> {
    encoded(&texels(), ImageFormat::Png)
}

pub const NEAREST: u32 = 9728;
const LINEAR: u32 = 9729;

#[test]
fn texels_of_an_embedded_png() {
    let scene = with_picture(&png(), textured(json!({})), json!({ "magFilter": NEAREST })).import().expect("imports");
    assert!(scene.warnings.is_empty(), "{:?}", scene.warnings);
    for (x, y) in [(0, 0), (1, 0), (0, 1), (1, 1)] {
        let center = [x, y].map(|k| 0.5 * f64::from(k) + 0.25);
        assert_color(&scene, center, linear(x, y));
        assert_color(&scene, center.map(|c| c + 0.2), linear(x, y));
    }
    for sampler in [json!({}), json!({ "magFilter": LINEAR }), json!({ "minFilter": NEAREST })] {
        let scene = with_picture(&png(), textured(json!({})), sampler).import().expect("imports");
        assert_color(&scene, [0.25, 0.75], linear(0, 1));
        let mean = (linear(0, 0) + linear(1, 0) + linear(0, 1) + linear(1, 1)) * 0.25;
        assert_color(&scene, [0.5, 0.5], mean);
        assert_color(&scene, [0.0, 0.5], mean); // The picture repeats.
    }
    let clamped = json!({ "wrapS": 33071, "wrapT": 33648 });
    let scene = with_picture(&png(), textured(json!({})), clamped).import().expect("imports");
    assert_color(&scene, [0.0, 0.0], linear(0, 0));
}

/// Seen to catch: the factor left out.
#[test]
fn a_jpeg_in_the_uri_times_the_factor() {
    let gray = RgbaImage::from_pixel(16, 8, Rgba([188, 188, 188, 255]));
    let mut material = textured(json!({}));
    material["pbrMetallicRoughness"]["baseColorFactor"] = json!([0.5, 0.25, 1.0, 0.5]);
    let mut asset = with_picture(&[], material, json!({}));
    let uri = format!("data:image/jpeg;base64,{}", STANDARD.encode(encoded(&gray, ImageFormat::Jpeg)));
    asset.set("/images/0", json!({ "uri": uri }));
    let color = color_at(&asset.import().expect("imports"), 0.3, 0.6);
    let expected = DVec4::new(0.5, 0.25, 1.0, 0.0) * LINEAR_188 + DVec4::W * 0.5;
    // One code of 255 is 0.006 of the light of this gray.
    assert!(color.abs_diff_eq(expected, 0.013), "{color}");
}

#[test]
fn a_picture_beside_the_scene() {
    let bench = Bench::new();
    let mut asset = with_picture(&[], textured(json!({})), json!({ "magFilter": NEAREST }));
    asset.set("/images/0", json!({ "uri": "my%20w%C3%A9ave.png" }));
    let path = bench.write("cloth.glb", asset.glb());
    let scene = Scene::import(&path, &OPTIONS).expect("a translucent surface needs no texture");
    let message = scene.check_textures(|_| false).expect_err("it is not there").to_string();
    for word in ["cloth.glb", "`Cloth`", "images[0] `my%20w%C3%A9ave.png`", "my wéave.png", "beside it"] {
        assert!(message.contains(word), "{word}: {message}");
    }
    bench.write("my wéave.png", png());
    assert_color(&Scene::import(&path, &OPTIONS).expect("imports"), [0.7, 0.2], linear(1, 0));
    asset.set("/images/0", json!({ "uri": "../weave.png" }));
    assert!(fault(&asset).contains("not a file in the scene's folder"));
}

/// Seen to catch: the angle with the other sign; scale after rotation; the texture's set of coordinates where the
/// transform states its own.
#[test]
fn coordinates_of_another_set_transformed() {
    let angle = 0.5_f64;
    let transform = json!({ "offset": [0.25, 0.5], "rotation": angle, "scale": [0.5, 2.0], "texCoord": 1 });
    let material = textured(json!({ "texCoord": 7, "extensions": { "KHR_texture_transform": transform } }));
    let mut asset = with_picture(&png(), material, json!({ "magFilter": LINEAR }));
    let coordinates = asset.json["meshes"][0]["primitives"][0]["attributes"]["TEXCOORD_0"].take();
    asset.set("/meshes/0/primitives/0/attributes", json!({ "POSITION": 0, "TEXCOORD_1": coordinates }));
    asset.json["extensionsRequired"] = json!(["KHR_texture_transform"]);
    let scene = asset.import().expect("imports");
    let plain = with_picture(&png(), textured(json!({})), json!({ "magFilter": LINEAR })).import().expect("imports");
    let mut inside = 0;
    for (x, y) in (0..100).map(|k| (f64::from(k % 10) / 10.0 + 0.03, f64::from(k / 10) / 10.0 + 0.05)) {
        let (sin, cos) = angle.sin_cos();
        let u = 0.25 + cos * 0.5 * x + sin * 2.0 * y;
        let v = 0.5 - sin * 0.5 * x + cos * 2.0 * y;
        if u.max(v) < 1.0 && u.min(v) > 0.0 {
            let [color, expected] = [color_at(&scene, x, y), color_at(&plain, u, v)];
            assert!(color.abs_diff_eq(expected, 1e-6), "{x} {y}: {color}, not {expected}");
            inside += 1;
        }
    }
    assert!(inside > 10, "{inside}");
}

/// Seen to catch: integers not normalized; vertices of another primitive.
#[test]
fn vertex_colors_of_every_kind() {
    let corners = [[0.0, 0.2, 0.4, 1.0], [0.6, 0.8, 1.0, 0.4], [0.2, 0.0, 0.0, 0.8], [1.0, 1.0, 1.0, 0.0f32]];
    let flat = corners.as_flattened();
    let floats: Vec<u8> = flat.iter().flat_map(|x| x.to_le_bytes()).collect();
    let over: Vec<u8> = flat
        .iter()
        .map(|x| if *x == 1.0 { 3.0 } else { x - f32::from(*x == 0.0) })
        .flat_map(f32::to_le_bytes)
        .collect();
    let three: Vec<u8> = corners.iter().flat_map(|c| c[..3].to_vec()).flat_map(f32::to_le_bytes).collect();
    let bytes: Vec<u8> = flat.iter().map(|x| (x * 255.0) as u8).collect();
    let shorts: Vec<u8> = flat.iter().flat_map(|x| ((x * 65535.0) as u16).to_le_bytes()).collect();
    let kinds = [
        (&floats, "VEC4", FLOAT),
        (&over, "VEC4", FLOAT),
        (&three, "VEC3", FLOAT),
        (&bytes, "VEC4", UNSIGNED_BYTE),
        (&shorts, "VEC4", UNSIGNED_SHORT),
    ];
    for (bytes, kind, component) in kinds {
        let mut asset = Asset::new();
        let factor = json!({ "baseColorFactor": [0.5, 1.0, 1.0, 1.0] });
        let mut primitive = square(&mut asset, json!({ "name": "Paint", "pbrMetallicRoughness": factor }));
        // Another material, since it would be a copy.
        let mut plain = primitive.clone();
        let other = asset.json["materials"][0].clone();
        plain["material"] = json!(asset.push("materials", other));
        let colors = asset.accessor(bytes, kind, component, 4);
        asset.json["accessors"][colors]["normalized"] = json!(component != FLOAT);
        primitive["attributes"]["COLOR_0"] = json!(colors);
        asset.push("meshes", json!({ "primitives": [plain, primitive] }));
        let scene = asset.import().expect("imports");
        assert_eq!(scene.color(0, [0.2, 0.3, 0.5]), DVec4::new(0.5, 1.0, 1.0, 1.0));
        let alpha = |a: f64| if kind == "VEC3" { 1.0 } else { a };
        let color = scene.color(2, [0.5, 0.25, 0.25]);
        assert!(color.abs_diff_eq(DVec4::new(0.1, 0.3, 0.45, alpha(0.8)), 1e-5), "{kind} {component}: {color}");
        if component != FLOAT {
            asset.json["accessors"][colors]["normalized"] = json!(false);
            assert!(fault(&asset).contains("COLOR_0: the accessor must hold"));
        }
        asset.json["accessors"][colors]["count"] = json!(3);
        asset.json["accessors"][colors]["normalized"] = json!(component != FLOAT);
        assert!(fault(&asset).contains("COLOR_0 has 3 elements, POSITION 4"));
    }
}

/// A mask does not change a translucent surface, vertex colors change none without a texture, and one line warns of
/// them. A texture that cannot be read is said.
#[test]
fn what_is_not_used_is_said() {
    let mut material = textured(json!({}));
    material["alphaMode"] = json!("MASK");
    let mut asset = with_picture(&png(), material, json!({}));
    asset.json["meshes"][0]["primitives"][0]["attributes"]["COLOR_0"] = json!(0);
    let mut scene = asset.import().expect("imports");
    scene.warn_of_colors(|_| false);
    assert!(scene.warnings.is_empty());
    scene.warn_of_colors(|m| m == 0);
    let expected = "`Cloth`: not used on a translucent surface: alphaMode MASK";
    assert!(scene.warnings.len() == 1 && scene.warnings[0].ends_with(expected), "{:?}", scene.warnings);
    asset.json["materials"][0]["pbrMetallicRoughness"] = json!({});
    let mut scene = asset.import().expect("imports");
    scene.warn_of_colors(|m| m == 0);
    assert!(scene.warnings[0].ends_with(&format!("{expected}, vertex colors")), "{:?}", scene.warnings);
    let mut scene = with_picture(&png()[..60], textured(json!({})), json!({})).import().expect("imports");
    scene.warn_of_colors(|m| m == 0);
    assert!(scene.warnings[0].ends_with("its medium has one color"), "{:?}", scene.warnings);
    let mut bare = with_picture(&png(), textured(json!({})), json!({}));
    bare.set("/meshes/0/primitives/0/attributes", json!({ "POSITION": 0 }));
    assert!(bare.import().expect("imports").warnings[0].contains("no TEXCOORD_0"));
}

/// A PNG that states so many texels.
fn claiming(width: u32, height: u32) -> Vec<u8> {
    let mut header = b"IHDR".to_vec();
    header.extend([width, height].iter().flat_map(|x| x.to_be_bytes()));
    header.extend([8, 6, 0, 0, 0]);
    let crc = header.iter().fold(u32::MAX, |crc, byte| {
        (0..8).fold(crc ^ u32::from(*byte), |c, _| if c & 1 == 1 { c >> 1 ^ 0xEDB8_8320 } else { c >> 1 })
    });
    let mut bytes = b"\x89PNG\r\n\x1a\n\0\0\0\x0d".to_vec();
    bytes.extend(header);
    bytes.extend((!crc).to_be_bytes());
    bytes.extend(&png()[33..]);
    bytes
}

#[test]
fn pictures_that_cannot_be_read() {
    let jpeg = encoded(&texels(), ImageFormat::Jpeg);
    let cases = [
        (png()[..60].to_vec(), "PNG"),
        (jpeg[..jpeg.len() / 2].to_vec(), "PNG, JPEG or WebP again"),
        (b"GIF89a".to_vec(), "neither a PNG, a JPEG nor a WebP"),
        (Vec::new(), "neither a PNG, a JPEG nor a WebP"),
        (claiming(60_000, 60_000), "60000 x 60000 texels: 1 to 67108864"),
        (claiming(u32::MAX >> 1, u32::MAX >> 1), "images[0]"),
        (claiming(0, 7), "images[0]"),
        (claiming(8_000, 8_000), "images[0]"),
    ];
    for (bytes, words) in cases {
        let message = fault(&with_picture(&bytes, textured(json!({})), json!({})));
        assert!(message.contains("material `Cloth`: baseColorTexture: images[0] `weave`"), "{message}");
        assert!(message.contains(words), "{words}: {message}");
    }
    let good = with_picture(&png(), textured(json!({})), json!({}));
    let faults = [
        ("/images/0/bufferView", json!(99), "bufferView: index 99"),
        ("/bufferViews/3/byteLength", json!(1 << 20), "exceeds its buffer"),
        ("/images/0", json!({}), "neither uri nor bufferView"),
        ("/textures/0/source", json!(5), "texture.source: index 5"),
        (
            "/textures/0",
            json!({ "extensions": { "KHR_texture_basisu": { "source": 0 } } }),
            "no PNG, JPEG or WebP `source`",
        ),
        ("/textures/0/sampler", json!(5), "texture.sampler: index 5"),
        ("/materials/0/pbrMetallicRoughness/baseColorTexture/index", json!(5), "index 5 is out of range"),
        ("/samplers/0", json!({ "wrapS": 1 }), "unknown wrap mode"),
    ];
    for (pointer, value, words) in faults {
        let mut asset = Asset { json: good.json.clone(), binary: good.binary.clone() };
        asset.set(pointer, value);
        let message = fault(&asset);
        assert!(message.contains("`Cloth`: baseColorTexture: ") && message.contains(words), "{words}: {message}");
    }
}

/// A picture that ends early is refused; only the end marker of a PNG picture may be missing.
///
/// Seen to catch: a JPEG picture padded with gray.
#[test]
fn pictures_that_end_early_are_refused() {
    let picture = RgbaImage::from_fn(40, 24, |x, y| Rgba([6 * x as u8, 10 * y as u8, (x * y) as u8, 255]));
    for (format, end) in [(ImageFormat::Jpeg, 1), (ImageFormat::Png, 17)] {
        let whole = encoded(&picture, format);
        assert!(with_picture(&whole, textured(json!({})), json!({})).import().is_ok());
        for missing in (end..whole.len() - 1).step_by(5) {
            let cut = &whole[..whole.len() - missing];
            let message = fault(&with_picture(cut, textured(json!({})), json!({})));
            assert!(message.contains("images[0] `weave`: "), "{missing}: {message}");
            let marked = [cut, &[0xff, 0xd9]].concat();
            let marked = with_picture(&marked, textured(json!({})), json!({})).import();
            let refused = marked.map_or(true, |scene| scene.check_textures(|_| false).is_err());
            assert!(format == ImageFormat::Png || missing < 8 || refused, "{missing}");
        }
    }
}

/// Damage is refused or visible; nothing ends the program.
#[test]
fn damaged_pictures() {
    let small = RgbaImage::from_fn(9, 9, |x, y| Rgba([20 * x as u8, 20 * y as u8, 7, 255]));
    let mut refused = 0;
    for format in [ImageFormat::Png, ImageFormat::Jpeg, ImageFormat::WebP] {
        let bytes = encoded(&small, format);
        for at in 0..bytes.len() {
            let mut bytes = bytes.clone();
            bytes[at] ^= [0xFF, 0x01, 0x80][at % 3];
            let scene = with_picture(&bytes, textured(json!({})), json!({})).import().expect("imports");
            refused += u32::from(scene.check_textures(|_| false).is_err());
        }
    }
    assert!(refused > 30, "{refused}");
}

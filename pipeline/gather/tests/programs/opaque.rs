//! Opaque surfaces through the programs: color, texture and holes of a card above the slab.

use base64::{Engine, engine::general_purpose::STANDARD};
use serde_json::{Value, json};
use test_support::Bench;

/// A picture of two texels: light red with alpha 0, and the codes 188, 64, 0 with alpha 255.
const TEXELS: [[u8; 4]; 2] = [[255, 200, 200, 0], [188, 64, 0, 255]];

/// The second texel in linear light (IEC 61966-2-1).
const LINEAR: [f64; 3] = [0.502_886_458, 0.051_269_458, 0.0];

/// A picture of these texels side by side.
pub fn picture(texels: &[[u8; 4]]) -> Vec<u8> {
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, texels.len() as u32, 1);
    encoder.set_color(png::ColorType::Rgba);
    let mut writer = encoder.write_header().expect("a header");
    writer.write_image_data(texels.as_flattened()).expect("texels");
    writer.finish().expect("an end");
    bytes
}

/// Adds a card 25 cm above the slab and wider than it, half of it the first texel of `card.png`, half the second. The
/// sun shines straight down with 1 W/m².
fn with_card(root: &mut Value, alpha_mode: &str) {
    let floats = |numbers: &[f32]| -> Vec<u8> { numbers.iter().flat_map(|x| x.to_le_bytes()).collect() };
    let corners = floats(&[-1.0, 0.25, -1.0, -1.0, 0.25, 1.0, 1.0, 0.25, 1.0, 1.0, 0.25, -1.0]);
    let coordinates = floats(&[0.0, 0.0, 0.0, 1.0, 1.0, 1.0, 1.0, 0.0]);
    let bytes = [corners, coordinates].concat();
    let mut push = |list: &str, item: Value| {
        let items = root.as_object_mut().expect("an object").entry(list).or_insert_with(|| json!([]));
        let items = items.as_array_mut().expect("a list");
        items.push(item);
        items.len() - 1
    };
    let uri = format!("data:application/octet-stream;base64,{}", STANDARD.encode(&bytes));
    let buffer = push("buffers", json!({ "uri": uri, "byteLength": bytes.len() }));
    let mut accessor = |offset: usize, length: usize, kind: &str| {
        let view = json!({ "buffer": buffer, "byteOffset": offset, "byteLength": length });
        let view = push("bufferViews", view);
        push("accessors", json!({ "bufferView": view, "componentType": 5126, "type": kind, "count": 4 }))
    };
    let attributes = json!({ "POSITION": accessor(0, 48, "VEC3"), "TEXCOORD_0": accessor(48, 32, "VEC2") });
    push("images", json!({ "uri": "card.png" }));
    push("samplers", json!({ "magFilter": 9728 }));
    push("textures", json!({ "source": 0, "sampler": 0 }));
    let base = json!({ "baseColorTexture": { "index": 0 }, "baseColorFactor": [0.5, 1, 1, 1] });
    let material = json!({ "name": "Card", "alphaMode": alpha_mode, "pbrMetallicRoughness": base });
    let material = push("materials", material);
    // As a fan, the card faces upwards.
    let primitive = json!({ "attributes": attributes, "mode": 6, "material": material });
    let mesh = push("meshes", json!({ "primitives": [primitive] }));
    let node = push("nodes", json!({ "mesh": mesh }));
    root["scenes"][0]["nodes"].as_array_mut().expect("a list").push(json!(node));
}

fn sample(bench: &Bench, scene: &str) -> f64 {
    let arguments = [scene, "-n", "20k", "-o", "card.cloud", "--stats", "stats.json", "--quiet"];
    bench.succeed("sample-surface", &arguments);
    bench.json("stats.json")["mean_flux_w"][1].as_f64().expect("a number")
}

/// Below the opaque half of the card the slab is dark and hidden; through the other half it is lit and seen.
#[test]
fn a_hole_shows_what_is_behind_and_lets_light_through() {
    let bench = Bench::new();
    bench.write("card.png", picture(&TEXELS));
    let masked = bench.slab("masked.gltf", |root| with_card(root, "MASK"));
    let flux = sample(&bench, &masked);
    // Half of 0.2 m by 0.2 m. A sixth of the samples lies there, a quarter of those looks at the card's dark side
    // instead of the sun: five standard errors.
    assert!((flux / 0.02 - 1.0).abs() < 5.0 * (1.0f64 / 3.0 / (20_000.0 / 6.0)).sqrt(), "{flux}");
    let size = ["--width", "16", "--height", "16", "--spp", "4"];
    let image = ["card.cloud", &masked, "--medium", "marble", "-o", "card.exr", "--quiet"];
    bench.succeed("gather", &[&image[..], &size].concat());
    let image = bench.image("card.exr");
    let channel = |name: &str| image.channel(name).expect("a channel");
    for (c, name) in ["R", "G", "B"].into_iter().enumerate() {
        let expected = LINEAR[c] * [0.5, 1.0, 1.0][c] / std::f64::consts::PI;
        let [card, slab] = ["diffuse", "subsurface"].map(|layer| channel(&format!("{layer}.{name}")));
        for (k, (card, slab)) in card.iter().zip(slab).enumerate() {
            let right = k % 16 >= 8;
            let expected = if right { expected } else { 0.0 };
            assert!((f64::from(*card) - expected).abs() < 1e-6, "pixel {k}: {card}, not {expected}");
            assert_eq!(*slab > 0.0, !right, "pixel {k}: {slab}");
        }
    }
    assert!(channel("Z").iter().enumerate().all(|(k, z)| (z - if k % 16 < 8 { 0.5 } else { 0.25 }).abs() < 1e-6));

    // Without the mask the card hides all of the light; the cloud with it is not taken for this scene.
    let whole = bench.slab("whole.gltf", |root| with_card(root, "OPAQUE"));
    bench.refuses(
        "gather",
        &["card.cloud", &whole, "--medium", "marble", "-o", "no.exr"],
        &["its mesh or materials differ"],
    );
    assert_eq!(sample(&bench, &whole), 0.0);
}

#[test]
fn a_picture_that_cannot_be_read() {
    let bench = Bench::new();
    let scene = bench.slab("card.gltf", |root| with_card(root, "MASK"));
    let arguments = [scene.as_str(), "-o", "no.cloud"];
    bench.refuses("sample-surface", &arguments, &["card.gltf", "`Card`", "images[0] `card.png`", "beside it"]);
    bench.write("card.png", &picture(&TEXELS)[..50]);
    bench.refuses("sample-surface", &arguments, &["card.gltf", "`Card`", "images[0] `card.png`", "again"]);
}

/// Holes of a translucent card are ignored, and the program says so once; a texture that cannot be read is no fault there.
#[test]
fn holes_of_a_translucent_surface_are_not_used() {
    let bench = Bench::new();
    bench.write("card.png", picture(&TEXELS));
    let scene = bench.slab("card.gltf", |root| with_card(root, "MASK"));
    let arguments = [&scene, "--translucent", "Card", "-n", "500", "-o", "card.cloud", "--progress", "none"];
    let said = bench.says("sample-surface", &arguments);
    assert_eq!(said.matches("`Card`: not used on a translucent surface: alphaMode").count(), 1);
}

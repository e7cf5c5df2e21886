//! Scenes whose pictures were inspected and stored: a mirrored instance, a node under a stretched parent, two media.

use crate::{
    figure::{FIGURE, Figure},
    picture::{SIZE, SUBSURFACE, channel},
};
use bssrdf::built_in;
use formats::Image;
use gather::Settings;
use serde_json::{Value, json};
use std::{fs, path::Path, slice::from_ref};
use test_support::{
    meshes::World,
    pipeline::{cloud, input, settings, stratified},
};

/// Side of a block, pixels; blocks are compared by their means.
const BLOCK: usize = 4;

/// Tolerance as a share of the brightest block: functions of the mathematics library of the system differ in their
/// last digits.
const TOLERANCE: f64 = 1e-3;

/// Adds an instance of the mesh of the figure with this transform.
fn with_instance(figure: Figure, transform: Value) -> Figure {
    let mut node = transform;
    node["mesh"] = json!(0);
    figure.with_node(node)
}

fn mirrored_instance() -> Figure {
    with_instance(Figure::read(), json!({ "translation": [0.02, 0.0, 0.03], "scale": [-0.5, 0.5, 0.5] }))
}

/// An instance turned about the view axis below a parent that is wider than high: together they shear.
fn nested_parents() -> Figure {
    let mut figure = Figure::read();
    let turned = json!({ "mesh": 0, "rotation": [0.0, 0.0, 0.258_819_05, 0.965_925_83], "scale": [0.4, 0.4, 0.4] });
    let turned = figure.0.push("nodes", turned);
    figure.with_node(json!({ "translation": [0.02, 0.0, 0.03], "scale": [1.5, 0.75, 1.0], "children": [turned] }))
}

/// The mirrored instance in a material of its own.
fn two_media() -> Figure {
    let mut figure = Figure::read();
    let mut material = figure.0.json["materials"][FIGURE].clone();
    material["name"] = json!("Second");
    let material = figure.0.push("materials", material);
    let mut mesh = figure.0.json["meshes"][0].clone();
    mesh["primitives"][0]["material"] = json!(material);
    let mesh = figure.0.push("meshes", mesh);
    figure.with_node(json!({ "mesh": mesh, "translation": [0.02, 0.0, 0.03], "scale": [-0.5, 0.5, 0.5] }))
}

fn picture(world: &World, media: &[&str]) -> Image {
    let cloud = cloud(world, &stratified(20_000, 1));
    assert_eq!(cloud.meta().materials.len(), media.len());
    let media: Vec<_> = media.iter().map(|name| built_in(name).expect("a built-in medium")).collect();
    let camera = &world.scene.cameras[0];
    let input = input(world, from_ref(&cloud), &media, camera);
    let settings = Settings { paths_per_pixel: 4, ..settings(bssrdf::Model::DirectionalDipole, SIZE, SIZE) };
    gather::film::image(&gather::render(&input, &settings, |_| ()).pixels, SIZE, SIZE)
}

/// Means of the subsurface layer over blocks, row after row, red, green, blue.
fn blocks(image: &Image) -> Vec<f64> {
    let across = SIZE / BLOCK;
    let mut means = vec![0.0; 3 * across * across];
    for (k, name) in SUBSURFACE.iter().enumerate() {
        for (pixel, value) in channel(image, name).iter().enumerate() {
            let block = pixel / SIZE / BLOCK * across + pixel % SIZE / BLOCK;
            means[3 * block + k] += f64::from(*value) / (BLOCK * BLOCK) as f64;
        }
    }
    means
}

/// Seen to catch: the winding of mirrored meshes left as it is; the media of two materials exchanged.
#[test]
fn pictures_that_were_looked_at() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("reference/pictures.json");
    let kept: Value = serde_json::from_slice(&fs::read(&path).expect("the pictures")).expect("JSON");
    let scenes: [(&str, Figure, &[&str]); 3] = [
        ("mirrored instance", mirrored_instance(), &["marble"]),
        ("nested parents", nested_parents(), &["marble"]),
        ("two media", two_media(), &["marble", "ketchup"]),
    ];
    for (name, figure, media) in scenes {
        let found = blocks(&picture(&figure.world(), media));
        let expected: Vec<f64> = kept[name].as_array().into_iter().flatten().filter_map(Value::as_f64).collect();
        let brightest = found.iter().fold(0.0f64, |most, x| most.max(*x));
        let rounded: Vec<f64> = found.iter().map(|x| (x * 1e6).round() / 1e6).collect();
        let near = |(x, y): (&f64, &f64)| (x - y).abs() <= TOLERANCE * brightest;
        let same = expected.len() == found.len() && found.iter().zip(&expected).all(near);
        assert!(same, "{name}: not the picture that was kept, but {}", json!(rounded));
    }
}

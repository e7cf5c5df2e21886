//! The same triangles of the same material in one primitive or in many, on one node or on many.

use crate::{
    figure::{FIGURE, Figure, index_of},
    picture::{Shot, assert_multiple, channel},
};
use gather::estimator::{Estimator, Rule};
use serde_json::{Value, json};
use std::ops::Range;
use test_support::meshes::World;

/// Primitives with some of the triangles each, in their order: alternately by indices into the buffers of the figure,
/// and by vertices of their own without indices.
fn portions(figure: &mut Figure, count: usize) -> Vec<Value> {
    let triangles = figure.mesh().triangles.len();
    let range = |k: usize| k * triangles / count..(k + 1) * triangles / count;
    let portion = |k: usize| if k.is_multiple_of(2) { indexed(figure, range(k)) } else { soup(figure, range(k)) };
    (0..count).map(portion).collect()
}

/// A primitive that takes some of the indices.
fn indexed(figure: &mut Figure, triangles: Range<usize>) -> Value {
    let mut primitive = figure.primitives()[0].clone();
    let mut accessor = figure.0.json["accessors"][index_of(&primitive["indices"])].clone();
    accessor["byteOffset"] = json!(12 * triangles.start);
    accessor["count"] = json!(3 * triangles.len());
    primitive["indices"] = json!(figure.0.push("accessors", accessor));
    primitive
}

/// A primitive with three vertices for each triangle.
fn soup(figure: &mut Figure, triangles: Range<usize>) -> Value {
    let corners = figure.mesh().triangles[triangles].concat();
    let mut attributes = figure.primitives()[0]["attributes"].clone();
    for name in ["POSITION", "NORMAL"] {
        let vectors = figure.vectors(index_of(&attributes[name]));
        let own: Vec<[f32; 3]> = corners.iter().map(|i| vectors[*i as usize].to_array()).collect();
        attributes[name] = json!(figure.0.vectors(&own));
    }
    json!({ "attributes": attributes, "material": FIGURE })
}

/// Fails unless the images agree to the last bit: the samples, the tree and the sums must be the same.
fn assert_same_image(what: &str, parts: &World) {
    let whole = Figure::read().world();
    assert_eq!(whole.scene.mesh.triangles.len(), parts.scene.mesh.triangles.len());
    for estimator in [Estimator::Exhaustive, Estimator::Roulette(Rule::Mixture)] {
        let shot = Shot { estimator, ..Shot::new(8) };
        let [a, b] = [shot.of(&whole), shot.of(parts)];
        assert_multiple(what, &a, &b, 1.0);
        for guide in ["N.X", "N.Y", "N.Z", "P.X", "P.Y", "P.Z", "Z"] {
            assert_eq!(channel(&a, guide), channel(&b, guide), "{what}");
        }
    }
}

/// Seen to catch: a primitive's indices not counted from its own first vertex; the byte offset of an accessor
/// left out.
#[test]
fn primitives_of_one_mesh() {
    let mut figure = Figure::read();
    let parts = portions(&mut figure, 7);
    *figure.primitives() = json!(parts);
    assert_same_image("seven primitives", &figure.world());
}

/// Nodes below a node whose scale they undo, with powers of two, which change no digit.
///
/// Seen to catch: the errors of the test above; the transform of a child applied without that of its parent; children
/// visited in reverse order.
#[test]
fn nodes_of_one_material() {
    let mut figure = Figure::read();
    let parts = portions(&mut figure, 5);
    let mut nodes = Vec::new();
    for part in parts {
        let mesh = figure.0.push("meshes", json!({ "primitives": [part] }));
        let node = json!({ "mesh": mesh, "scale": [0.25, 0.25, 0.25] });
        nodes.push(figure.0.push("nodes", node));
    }
    let node = figure.node("Figure");
    *node = json!({ "name": "Figure", "scale": [4.0, 4.0, 4.0], "children": nodes });
    assert_same_image("five nodes", &figure.world());
}

/// A mesh in which no vertex is shared.
///
/// Seen to catch: vertices without indices taken in threes from the second one on.
#[test]
fn a_soup_of_triangles() {
    let mut figure = Figure::read();
    let triangles = figure.mesh().triangles.len();
    let soup = soup(&mut figure, 0..triangles);
    *figure.primitives() = json!([soup]);
    assert_same_image("soup", &figure.world());
}

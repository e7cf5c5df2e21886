//! `make truth` renders a scene by the model and by random walks, and compares both on a page.

use super::{Said, Tree, medium, view};
use serde_json::{Value, json};

#[test]
fn the_truth_is_rendered_beside_the_picture() {
    let tree = Tree::new();
    tree.scene("thing.gltf", 1.0);
    tree.write("s.json", view(0.5));
    tree.write("m.json", medium(1.0));
    let mut near: Value = serde_json::from_str(&view(0.4)).expect("JSON");
    near["name"] = "near".into();
    tree.write("list.json", json!([near]).to_string());
    let before = tree.files();
    let truth = |views: &str| {
        let views = format!("VIEWS={views}");
        tree.make(&["truth", "SCENE=thing.gltf", "MEDIUM=m.json", &views, "WIDTH=6", "ERROR=0.9"])
    };
    let said = truth("s.json");
    assert_eq!(said.made(), ["sample-surface", "gather", "calibrate", "gather"]);
    let [model, reference] = ["half-space", "reference"].map(|of| format!("out/thing/k500-s0/m-{of}-w6"));
    assert!(said.0.contains(&format!("{model}/s.html")) && said.0.contains("relmse="), "{}", said.0);
    let page = String::from_utf8(tree.bytes(&format!("{model}/s.html"))).expect("text");
    assert!(page.contains("<html"));
    assert!(truth("s.json").made().is_empty(), "made without a reason");

    let said = truth("s.json list.json");
    assert_eq!(said.made(), ["gather", "gather"]);
    assert!(said.0.contains(&format!("is {model}.html")), "{}", said.0);
    for image in ["s.exr", "list.near.exr"] {
        assert!([&model, &reference].iter().all(|folder| tree.path(folder).join(image).exists()), "{image}");
    }
    let index = String::from_utf8(tree.bytes(&format!("{model}.html"))).expect("text");
    assert!(index.contains("list.near.html"));

    // Pictures of their own size lie elsewhere, and share the calibration.
    let own = ["SCENE=thing.gltf", "MEDIUM=m.json", "VIEWS=s.json"];
    assert_eq!(tree.make(&own).made(), ["gather"]);
    tree.make(&["clean-images"]);
    assert!(tree.files().iter().all(|name| !name.ends_with(".html")), "{:?}", tree.files());
    tree.make(&["clean"]);
    assert_eq!(tree.files(), before);
    tree.refuses(&mut tree.command(&["truth"]), &["SCENE"]);
}

/// An open mesh has no exact images, and that is said before anything else is rendered.
///
/// Seen to catch: the pictures of the model made first.
#[test]
fn there_is_no_truth_of_an_open_mesh() {
    let tree = Tree::new();
    tree.open_scene("thing.gltf");
    tree.write("s.json", view(0.5));
    tree.write("m.json", medium(1.0));
    let own = ["truth", "SCENE=thing.gltf", "MEDIUM=m.json", "VIEWS=s.json", "WIDTH=6", "ERROR=0.9"];
    let output = tree.command(&own).output().expect("make starts");
    let said = Said(super::said(&output));
    assert_eq!(output.status.code(), Some(2), "{}", said.0);
    assert_eq!(said.made(), ["sample-surface", "gather"]);
    assert!(said.0.contains("through holes of the surface"), "{}", said.0);
}

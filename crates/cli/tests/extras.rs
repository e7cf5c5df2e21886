//! Media that the extras of a material state.

use bssrdf::{Medium, built_in};
use cli::scene_medium;
use scene::Scene;
use serde_json::{Value, json};
use test_support::{
    Bench,
    glb::{OPTIONS, tetrahedron},
};

/// A name or JSON in the extras of a material; a name is never a path.
///
/// Seen to catch: the extensions of the material taken before its extras.
#[test]
fn extras_of_a_material_state_its_medium() {
    let bench = Bench::new();
    let medium = |medium: Value| {
        let mut asset = tetrahedron();
        asset.set("/materials/0/extras", json!({ "medium": medium }));
        let transmission = json!({ "KHR_materials_transmission": { "transmissionFactor": 1 } });
        asset.set("/materials/0/extensions", transmission);
        let path = bench.write("wax.glb", asset.glb());
        let scene = Scene::import(&path, &OPTIONS).expect("imports");
        scene_medium(&scene.materials[0]).map_err(|e| e.to_string())
    };
    let marble = built_in("marble").expect("it is built in");
    assert_eq!(medium("marble".into()), Ok(Some(marble)));
    let own = r#"{"name":"own","unit":"1/m","sigma_a":[1,1,1],"sigma_s":[9,9,9]}"#;
    assert_eq!(medium(own.into()), Ok(Some(Medium::from_json(own).expect("a medium"))));
    for wrong in ["marbel", "/etc/passwd", "data/media/marble.json", "{"] {
        let message = medium(wrong.into()).expect_err("it is no medium");
        assert!(message.contains("`wax` of SCENE: extras.medium") && message.contains("--medium"), "{message}");
    }
}

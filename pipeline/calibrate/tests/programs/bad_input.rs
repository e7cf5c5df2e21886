//! Bad input of every kind is refused with exit code 2 and one message; no file is written.

use crate::{bench, quick, slab};
use serde_json::{Value, json};
use test_support::{Bench, data};

#[test]
fn arguments_that_cannot_be_used() {
    let (bench, slab) = (bench(), slab());
    let refuses = |more: &[&str], words: &[&str]| {
        let own = [&["slab.cloud", &slab, "-o", "a.calibration", "--quiet"], more].concat();
        bench.refuses("calibrate", &own, words);
    };
    // A volume that no light enters is no medium; with transmission it would be clear glass.
    let closed = bench.slab("closed.gltf", |root| {
        root["materials"][0]["extensions"]["KHR_materials_transmission"] = json!({ "transmissionFactor": 0 });
    });
    bench.succeed("sample-surface", &[&closed, "-n", "1000", "-o", "closed.cloud", "--quiet"]);
    let arguments = ["closed.cloud", &closed, "-o", "a.calibration", "--quiet"];
    bench.refuses("calibrate", &arguments, &["--medium", "gather --list-media"]);
    refuses(&["--medium", "marbel"], &["--medium", "`marbel`"]);
    refuses(&["--medium", "Wax=marble"], &["`Wax`", "`Slab`"]);
    refuses(&["--medium", "none.json"], &["none.json", "No such file"]);
    refuses(&["--medium", "marble", "--walks", "0"], &["--walks", "2 to"]);
    refuses(&["--medium", "marble", "--walks", "1e12"], &["--walks"]);
    refuses(&["--medium", "marble", "--walks", "many"], &["--walks"]);
    refuses(&["--medium", "marble", "--bssrdf", "tripole"], &["--bssrdf", "half-space"]);
    refuses(&["--medium", "marble", "--metres-per-unit", "2"], &["--metres-per-unit"]);
    refuses(&["--medium", "marble", "--environment", "1,1,1"], &["slab.cloud", "environment"]);
    refuses(&["--medium", "marble", "--stats", "slab.cloud"], &["--stats would replace"]);
    refuses(&["--medium", "marble", "--stats", "nowhere/a.json"], &["nowhere/a.json", "No such file"]);
    bench.refuses("calibrate", &["slab.cloud", "-o", "a.calibration"], &["CLOUD", "SCENE"]);
    bench.refuses("calibrate", &["slab.cloud", &slab, "--medium", "marble"], &["--output"]);
}

#[test]
fn clouds_that_do_not_fit() {
    let (bench, slab) = (bench(), slab());
    let sphere = data("scenes/sphere.glb");
    bench.refuses("calibrate", &quick(&sphere, "a.calibration", &[]), &["slab.cloud", "sphere.glb", "mesh"]);
    let good = bench.read("slab.cloud");
    bench.write("slab.cloud", &good[..good.len() / 2]);
    bench.refuses("calibrate", &quick(&slab, "a.calibration", &[]), &["slab.cloud", "truncated"]);
}

/// A scene whose surface is changed, and what calibrating it says; it must be refused.
fn refused(change: impl FnOnce(&mut Value)) -> String {
    let bench = Bench::new();
    let scene = bench.slab("open.gltf", change);
    bench.succeed("sample-surface", &[&scene, "-n", "500", "-o", "slab.cloud", "--quiet"]);
    let message = bench.refuses("calibrate", &quick(&scene, "a.calibration", &["--quiet"]), &["open.gltf", "`Slab`"]);
    assert_eq!(message.lines().count(), 1, "{message}");
    message
}

/// The accessor of the triangles of the slab.
fn triangles(root: &mut Value) -> &mut Value {
    let index = root["meshes"][0]["primitives"][0]["indices"].as_u64().expect("an index") as usize;
    &mut root["accessors"][index]
}

#[test]
fn open_surfaces_are_refused() {
    let half = refused(|root| {
        let count = triangles(root)["count"].as_u64().expect("a count");
        triangles(root)["count"] = (count / 6 * 3).into();
    });
    assert!(half.contains("% of the random walks left through holes"), "{half}");
    let one = refused(|root| {
        // A triangle of the upper side, which is lit.
        let upper = triangles(root)["count"].as_u64().expect("a count") / 6 * 3 * 4;
        (triangles(root)["count"], triangles(root)["byteOffset"]) = (3.into(), upper.into());
    });
    assert!(one.contains("closed surface"), "{one}");
}

//! Bad input of every kind is refused with exit code 2 and one message that names the file, the field and the way out;
//! no file is written.

use serde_json::json;
use std::path::Path;
use test_support::{Bench, data};

/// A folder that contains a small cloud of the slab.
fn bench() -> (Bench, String) {
    let bench = Bench::new();
    let slab = data("scenes/slab.glb");
    bench.succeed("sample-surface", &[&slab, "-n", "1000", "-o", "slab.cloud", "--quiet"]);
    (bench, slab)
}

fn medium(fields: &str) -> String {
    format!(r#"{{"name":"test","unit":"1/mm","sigma_a":[0.1,0.1,0.1],"sigma_s":[1,1,1]{fields}}}"#)
}

#[test]
fn media_and_cameras() {
    let (bench, slab) = bench();
    let refuses = |more: &[&str], words: &[&str]| {
        let arguments = [&["slab.cloud", &slab, "-o", "out.exr", "--quiet"], more].concat();
        bench.refuses("gather", &arguments, words);
    };
    // A volume that no light enters is no medium; with transmission it would be clear glass.
    let closed = bench.slab("closed.gltf", |root| {
        root["materials"][0]["extensions"]["KHR_materials_transmission"] = json!({ "transmissionFactor": 0 });
    });
    bench.succeed("sample-surface", &[&closed, "-n", "1000", "-o", "closed.cloud", "--quiet"]);
    let arguments = ["closed.cloud", &closed, "-o", "out.exr", "--quiet"];
    bench.refuses("gather", &arguments, &["--medium", "--list-media"]);
    refuses(&["--medium", "marbel"], &["--medium", "`marbel`", "--list-media"]);
    refuses(&["--medium", "skim"], &["skimmilk"]);
    refuses(&["--medium", "Wax=marble"], &["`Wax`", "`Slab`"]);
    refuses(&["--medium", "Slab=marble", "--medium", "Slab=skin1"], &["twice"]);
    refuses(&["--medium", "none.json"], &["none.json", "No such file"]);
    refuses(&["--medium", "marble", "--camera", "Nowhere"], &["--camera", "`Nowhere`", "`Top`"]);
    refuses(&["--medium", "marble", "--camera", "7"], &["--camera", "`7`"]);
    refuses(&["--medium", "marble", "--view", "none.json"], &["none.json"]);
    refuses(&["--medium", "marble", "--estimator", "exhaustive", "--accuracy", "0.1"], &["--accuracy"]);
    refuses(&["--medium", "marble", "--width", "0"], &["--width"]);
    refuses(&["--medium", "marble", "--width", "60000", "--height", "60000"], &["--width", "pixels"]);
    refuses(&["--medium", "marble", "--spp", "0"], &["--spp"]);
    refuses(&["--medium", "marble", "--samples", "3"], &["--samples"]);
}

#[test]
fn fields_of_a_medium_file() {
    let (bench, slab) = bench();
    let cases = [
        (medium(r#","eta":0.3"#), "eta"),
        (medium(r#","eta":0.4"#), "eta"),
        (medium(r#","eta":2.6"#), "eta"),
        (medium(r#","g":1.0"#), "g"),
        (medium(r#","g":[0,0]"#), "not a medium"),
        (medium(r#","colour":1"#), "colour"),
        (medium("").replace("[1,1,1]", "[1,-1,1]"), "negative"),
        (medium("").replace("[1,1,1]", "[1,1]"), "not a medium"),
        (medium("").replace("1/mm", "1/inch"), "1/mm"),
        (medium("").replace("[1,1,1]", "[1,1e30,1]"), "sigma_s"),
        (medium("").replace("[1,1,1]", "[1,NaN,1]"), "not a medium"),
        ("{".into(), "not a medium"),
    ];
    for (text, word) in cases {
        bench.write("bad.json", &text);
        let arguments = ["slab.cloud", &slab, "--medium", "bad.json", "-o", "out.exr", "--quiet"];
        bench.refuses("gather", &arguments, &["bad.json", word]);
    }
    let view = r#"{"eye":[0,1,0],"target":[0,0,0],"up":[0,1,0],"yfov":20}"#;
    for (text, word) in [(view.to_owned(), "up"), (view.replace("20", "200"), "yfov"), ("[]".into(), "not a view")] {
        bench.write("view.json", &text);
        let arguments = ["slab.cloud", &slab, "--medium", "marble", "--view", "view.json", "-o", "out.exr"];
        bench.refuses("gather", &arguments, &["view.json", word]);
    }
}

#[test]
fn clouds_that_do_not_fit() {
    let (bench, slab) = bench();
    let render = |cloud: &str, scene: &str, more: &[&str], words: &[&str]| {
        let arguments = [&[cloud, scene, "--medium", "marble", "-o", "out.exr", "--quiet"], more].concat();
        bench.refuses("gather", &arguments, words);
    };
    render("slab.cloud", &data("scenes/sphere.glb"), &[], &["slab.cloud", "sphere.glb", "mesh", "sample"]);
    render("slab.cloud", &slab, &["--metres-per-unit", "2"], &["--metres-per-unit is 2", "1"]);
    render("slab.cloud", &slab, &["--light-unit", "photometric"], &["--light-unit"]);
    render("none.cloud", &slab, &[], &["none.cloud", "No such file"]);
    render(&slab, &slab, &[], &["not a cloud"]);
    let good = bench.read("slab.cloud");
    bench.write("cut.cloud", &good[..good.len() / 2]);
    render("cut.cloud", &slab, &[], &["cut.cloud", "truncated"]);
    bench.write("empty.cloud", "");
    render("empty.cloud", &slab, &[], &["empty.cloud"]);
    for at in [9, 60, 100, good.len() / 2, good.len() - 100] {
        let mut bad = good.clone();
        bad[at] ^= 0x10;
        bench.write("bad.cloud", &bad);
        render("bad.cloud", &slab, &[], &["bad.cloud", "sample"]);
    }
}

#[test]
fn outputs_that_cannot_be_written() {
    let (bench, slab) = bench();
    let arguments = |output| ["slab.cloud", &slab, "--medium", "marble", "--width", "4", "--quiet", "-o", output];
    bench.refuses("gather", &arguments("no/folder/out.exr"), &["no/folder/out.exr"]);
    bench.refuses("gather", &arguments("."), &["folder"]);
    if Path::new("/dev/full").exists() {
        bench.refuses("gather", &arguments("/dev/full"), &["/dev/full", "No space left"]);
    }
    bench.refuses("gather", &["slab.cloud", &slab, "--medium", "marble"], &["--output"]);
    bench.refuses("gather", &["-o", "out.exr"], &["CLOUD"]);
}

#[test]
fn lists_are_printed_to_stdout() {
    let bench = Bench::new();
    assert_eq!(bench.succeed("gather", &["--list-media"]).lines().count(), 48);
    let cameras = bench.succeed("gather", &["--list-cameras", &data("scenes/figure.glb")]);
    let rows: Vec<Vec<&str>> = cameras.lines().map(|l| l.split_whitespace().collect()).collect();
    assert_eq!((rows.len(), rows[3][0]), (4, "translucent"), "{cameras}");
    assert_eq!((rows[0][0], &rows[1][..4]), ("index", &["0", "Front", "perspective", "yfov"][..]));
    for program in ["gather", "sample-surface"] {
        let materials = bench.succeed(program, &["--list-materials", &data("scenes/figure.glb")]);
        let rows: Vec<Vec<&str>> = materials.lines().map(|l| l.split_whitespace().collect()).collect();
        assert_eq!((rows.len(), rows[3][0], rows[4][0]), (5, "translucent", "media:"), "{materials}");
        assert_eq!(rows[1][..4], ["0", "Figure", "translucent", "38036"]);
        assert_eq!(rows[2], ["1", "Floor", "opaque", "2", "1.6000e1", "-"]);
    }
}

//! A list of views: one call, an image for each, the same bytes as one by one. Planted errors seen: the first view's
//! size for all; files numbered from one; outputs looked at one by one.

use std::fs;
use test_support::{Bench, data};

const VIEWS: [&str; 3] = [
    r#"{"eye":[0.002,0.08,0.178],"target":[0.002,0.028,0.002],"yfov":25,"width":24,"height":16}"#,
    r#"{"eye":[0.178,0.08,0.002],"target":[0.002,0.028,0.002],"yfov":20,"width":16}"#,
    r#"{"eye":[0.002,0.08,0.178],"target":[0.002,0.028,0.002],"yfov":30,"height":20}"#,
];

#[test]
fn a_list_of_views_makes_the_images_of_its_views() {
    let bench = Bench::new();
    let scene = data("scenes/figure.glb");
    bench.succeed("sample-surface", &[&scene, "-n", "5k", "-o", "figure.cloud", "--quiet"]);
    let gather = |view: &str, output: &str, stats: &str, preview: &str| {
        let own =
            ["figure.cloud", &scene, "--medium", "skin1", "--spp", "2", "--no-timings", "--quiet", "--view", view];
        bench.succeed("gather", &[&own[..], &["-o", output, "--stats", stats, "--preview", preview]].concat());
    };
    for (k, view) in VIEWS.iter().enumerate() {
        bench.write("one.json", view);
        gather("one.json", &format!("{k}.exr"), &format!("{k}.json"), &format!("{k}.png"));
    }
    let named = VIEWS[1].replace("{\"eye\"", "{\"name\":\"side\",\"eye\"");
    bench.write("list.json", format!("[{},{named},{}]", VIEWS[0], VIEWS[2]));
    gather("list.json", "all.exr", "all.json", "all.png");
    let bytes = |name: String| bench.read(&name);
    for (k, tag) in ["0000", "side", "0002"].into_iter().enumerate() {
        for ending in ["exr", "json", "png"] {
            assert!(bytes(format!("all.{tag}.{ending}")) == bytes(format!("{k}.{ending}")), "{tag}.{ending}");
        }
    }
    assert!(!bench.path("all.exr").exists() && !bench.path("all.0001.exr").exists());
    let files = fs::read_dir(bench.path("")).expect("lists").count();
    bench.write("views.json", format!("{{\"views\":[{}]}}", VIEWS[0]));
    gather("views.json", "object.exr", "object.json", "object.png");
    assert!(bytes("object.0000.exr".into()) == bytes("0.exr".into()));
    assert_eq!(fs::read_dir(bench.path("")).expect("lists").count(), files + 4);
}

#[test]
fn lists_that_say_too_much_are_refused() {
    let bench = Bench::new();
    let scene = data("scenes/figure.glb");
    bench.succeed("sample-surface", &[&scene, "-n", "1k", "-o", "figure.cloud", "--quiet"]);
    let own = ["figure.cloud", &scene, "--medium", "skin1", "-o", "x.exr", "--view", "list.json"];
    bench.write("list.json", format!("[{},{}]", VIEWS[0], VIEWS[1]));
    bench.refuses("gather", &[&own[..], &["--orbit", "3"]].concat(), &["list.json", "--orbit"]);
    bench.refuses("gather", &[&own[..], &["--crop", "16,0,8,1"]].concat(), &["--crop"]);
    bench.write("list.json", format!("[{},{{}}]", VIEWS[0]));
    bench.refuses("gather", &own, &["list.json", "view 1", "eye"]);
}

/// A fault that all views of a list may share is reported once.
///
/// Seen to fail: said of each view.
#[test]
fn a_list_is_warned_of_once() {
    let bench = Bench::new();
    let scene = data("scenes/figure.glb");
    bench.succeed("sample-surface", &[&scene, "-n", "1k", "-o", "figure.cloud", "--quiet"]);
    bench.write("list.json", format!("[{0},{0},{0}]", VIEWS[0]));
    let own = ["figure.cloud", &scene, "--medium", "skin1", "--spp", "1", "--view", "list.json", "-o", "x.exr"];
    let said = bench.says("gather", &[&own[..], &["--width", "8", "--height", "8"]].concat());
    assert_eq!(said.matches("aspect is 1.500, the image's 1.000").count(), 1, "{said}");
}

/// A fault of one view is reported with its name, before any view is rendered.
#[test]
fn faults_of_one_view_name_it_and_come_first() {
    let bench = Bench::new();
    let scene = data("scenes/figure.glb");
    bench.succeed("sample-surface", &[&scene, "-n", "1k", "-o", "figure.cloud", "--quiet"]);
    let own = ["figure.cloud", &scene, "--medium", "skin1", "--spp", "1", "--view", "list.json", "-o", "x.exr"];
    let wide = VIEWS[0].replace("24", "70000").replace("{\"eye\"", "{\"name\":\"wide\",\"eye\"");
    bench.write("list.json", format!("[{},{wide}]", VIEWS[0]));
    bench.refuses("gather", &own, &["view wide", "70000"]);
    let large = wide.replace("70000", "16000").replace("16,", "16000,").replace(":16}", ":16000}");
    bench.write("list.json", format!("[{},{large}]", VIEWS[0]));
    bench.refuses("gather", &own, &["view wide", "GiB"]);
    bench.write("list.json", format!("[{},{}]", VIEWS[0], VIEWS[1]));
    fs::create_dir(bench.path("x.0001.exr")).expect("makes");
    bench.refuses("gather", &own, &["x.0001.exr", "folder"]);
    for missing in ["--preview", "--stats"] {
        bench.refuses("gather", &[&own[..8], &["-o", "y.exr", missing, "none/y"]].concat(), &["none/y.0000"]);
    }
}

/// Nothing that was read is replaced, and no output by another.
#[test]
fn outputs_are_files_of_their_own() {
    let bench = Bench::new();
    let scene = data("scenes/figure.glb");
    bench.succeed("sample-surface", &[&scene, "-n", "1k", "-o", "a.cloud", "--quiet"]);
    let cloud = bench.read("a.cloud");
    bench.write("view.json", VIEWS[0]);
    let own = ["a.cloud", &scene, "--medium", "skin1", "--spp", "1", "--view", "view.json", "-o"];
    bench.refuses("gather", &[&own[..], &["./a.cloud"]].concat(), &["a.cloud", "--output would replace CLOUD"]);
    bench.refuses(
        "gather",
        &[&own[..], &["x.exr", "--stats", "view.json"]].concat(),
        &["view.json", "--stats would replace --view"],
    );
    bench.refuses(
        "gather",
        &[&own[..], &["x.exr", "--preview", "x.exr"]].concat(),
        &["x.exr", "--preview would replace --output"],
    );
    assert!(bench.read("a.cloud") == cloud);
    bench.succeed(
        "gather",
        &[&own[..], &["x.exr", "--preview", "/dev/null", "--stats", "/dev/null", "--quiet"]].concat(),
    );
}

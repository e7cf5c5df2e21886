//! What a user asks of a run while it runs, and what it says.

use std::{
    process::Command,
    thread::sleep,
    time::{Duration, Instant},
};
use test_support::{Bench, data};

/// The sphere at 48 x 48 pixels.
fn sphere(bench: &Bench) -> Vec<String> {
    bench.succeed("sample-surface", &[&data("scenes/sphere.glb"), "-n", "20k", "-o", "sphere.cloud", "--quiet"]);
    let (scene, view) = (data("scenes/sphere.glb"), data("views/sphere/front.json"));
    let words =
        ["sphere.cloud", &scene, "--view", &view, "--medium", "marble", "--width", "48", "--height", "48", "-j", "1"];
    words.map(str::to_owned).to_vec()
}

fn with<'a>(own: &'a [String], more: &[&'a str]) -> Vec<&'a str> {
    own.iter().map(String::as_str).chain(more.iter().copied()).collect()
}

/// The image has the bits of one with as many paths, without a calibration, which may have fewer walks in less time.
///
/// Seen to catch: a limit that is looked at after all paths, the number of paths that were asked for in the header.
#[test]
fn a_time_limit_leaves_an_image_of_the_paths_that_were_done() {
    let bench = Bench::new();
    let own = sphere(&bench);
    let start = Instant::now();
    let alike = with(&own, &["--calibration", "none"]);
    let more = ["--spp", "1000000", "--time-limit", "3s", "--stats", "a.json", "-o", "a.exr"];
    let said = bench.says("gather", &[&alike[..], &more].concat());
    assert!(start.elapsed() < Duration::from_secs(20), "{said}");
    assert!(said.contains("--time-limit: stopped with ") && said.contains(" of 1M paths per pixel"), "{said}");
    let stats = bench.json("a.json");
    assert_eq!(stats["ended_by"], "time limit");
    let paths = stats["paths_per_pixel"].as_u64().expect("a number");
    assert!((2..1_000_000).contains(&paths) && stats["paths"] == paths * 48 * 48, "{stats}");
    bench.succeed("gather", &[&alike[..], &["--spp", &paths.to_string(), "--quiet", "-o", "b.exr"]].concat());
    let [a, b] = ["a.exr", "b.exr"].map(|name| bench.image(name));
    assert!(a.channels == b.channels && a.attributes["samplesPerPixel"] == b.attributes["samplesPerPixel"]);
    // What there is time for is rendered, two paths at least, also of several images and several clouds.
    bench.succeed("sample-surface", &[&own[1], "-n", "20k", "--seed", "1", "-o", "more.cloud", "--quiet"]);
    let several = with(&own, &["more.cloud"]);
    let several: Vec<&str> = several[12..].iter().chain(&several[..12]).copied().collect();
    let more = ["--spp", "1000000", "--time-limit", "0.001s", "--orbit", "2", "-o", "o.exr", "--stats", "o.json"];
    bench.succeed("gather", &[&several[..], &more].concat());
    assert_eq!(bench.json("o.0001.json")["paths_per_pixel"], 4);
    // No cloud puts this target out of the reach of random walks.
    let target = ["--reference", "--target-error", "0.0001", "--time-limit", "1s", "-o", "t.exr", "--stats", "t.json"];
    bench.succeed("gather", &with(&own, &target));
    assert_eq!(bench.json("t.json")["ended_by"], "time limit");
    bench.succeed("gather", &with(&own, &["--spp", "2", "--time-limit", "1h", "-o", "c.exr", "--stats", "c.json"]));
    assert_eq!(bench.json("c.json")["ended_by"], "paths");
}

/// Seen to catch: the signal's own action, which ends the process; the number of paths of the whole run.
#[test]
fn a_signal_writes_the_image_as_it_is_and_the_run_goes_on() {
    let bench = Bench::new();
    let own = sphere(&bench);
    let more = ["--spp", "1000000", "--time-limit", "30s", "--stats", "a.json", "-o", "a.exr", "--keep-sums"];
    let mut child = bench.start("gather", &with(&own, &more));
    let start = Instant::now();
    let is_there = |name: &str| bench.path(name).exists();
    while !is_there("a.json") {
        assert!(start.elapsed() < Duration::from_secs(20), "no image was written");
        // Before it listens, the signal would end it.
        if start.elapsed() > Duration::from_millis(700) {
            let status = Command::new("kill").args(["-USR1", &child.id().to_string()]).status();
            assert!(status.expect("there is kill").success(), "the run has ended");
        }
        sleep(Duration::from_millis(100));
    }
    assert!(is_there("a.exr") && is_there("a.sums") && child.try_wait().expect("can be waited for").is_none());
    let first = bench.json("a.json");
    assert_eq!(first["ended_by"], "not finished");
    assert_eq!(bench.image("a.exr").channels[0].samples.len(), 48 * 48);
    child.kill().expect("ends");
    child.wait().expect("ended");
    // It can be continued.
    bench.succeed("gather", &with(&own, &["--spp", "2", "--continue", "a.exr", "-o", "b.exr"]));
}

/// Without --verbose a material takes three lines at most, and what sample-surface said is not said again.
#[test]
fn little_is_said_and_nothing_twice() {
    let bench = Bench::new();
    let name = "open.gltf";
    bench.slab(name, |root| {
        let indices = root["meshes"][0]["primitives"][0]["indices"].as_u64().expect("an index") as usize;
        let count = root["accessors"][indices]["count"].as_u64().expect("a count");
        root["accessors"][indices]["count"] = (count - 3).into();
        root["materials"][0]["emissiveTexture"] = serde_json::json!({"index": 0});
        root["textures"] = serde_json::json!([{}]);
    });
    let warned = bench.says("sample-surface", &[name, "-n", "2k", "-o", "open.cloud"]);
    let warnings: Vec<&str> = warned.lines().filter(|line| line.starts_with("warning: ")).collect();
    assert!(!warnings.is_empty(), "{warned}");
    let own =
        ["open.cloud", name, "--medium", "marble", "--width", "8", "--spp", "2", "-o", "a.exr", "--view", "v.json"];
    bench.write("v.json", r#"{"eye":[0,0.2,0.3],"target":[0,0,0],"yfov":20,"width":4,"height":4}"#);
    let said = bench.says("gather", &own);
    assert!(warnings.iter().all(|warning| !said.contains(warning)), "{said}");
    assert!(said.lines().take_while(|line| !line.starts_with("gathering")).count() <= 3, "{said}");
    let verbose = bench.says("gather", &[&own[..], &["--verbose"]].concat());
    assert!(warnings.iter().all(|warning| verbose.contains(warning)) && verbose.contains("1/sigma_tr"), "{verbose}");
}

/// The layers for compositors: the color of marble and the number of its material where the sphere is, 0 elsewhere.
#[test]
fn layers_for_compositors_are_there_if_asked_for() {
    let bench = Bench::new();
    let own = sphere(&bench);
    bench.succeed("gather", &with(&own, &["--spp", "2", "--quiet", "-o", "plain.exr"]));
    bench.succeed("gather", &with(&own, &["--spp", "2", "--quiet", "--layers", "albedo,id", "-o", "layers.exr"]));
    let [plain, layers] = ["plain.exr", "layers.exr"].map(|name| bench.image(name));
    let added: Vec<&str> =
        layers.channels.iter().map(|c| c.name.as_str()).filter(|name| plain.channel(name).is_none()).collect();
    assert_eq!(added, ["albedo.B", "albedo.G", "albedo.R", "id"]);
    assert!(plain.channels.iter().all(|c| layers.channel(&c.name) == Some(&c.samples[..])));
    let ids = layers.attributes["pcsss/ids"].clone();
    let formats::Attribute::Texts(ids) = ids else { panic!("{ids:?}") };
    let sphere = ids.iter().find_map(|line| line.strip_suffix(" Sphere")?.parse::<f32>().ok()).expect("its number");
    let [id, red, depth] = ["id", "albedo.R", "Z"].map(|name| layers.channel(name).expect("a channel"));
    for ((id, red), depth) in id.iter().zip(red).zip(depth) {
        let met = *depth > 0.0;
        assert!(
            *id == 0.0 && *red == 0.0 && !met || *id == sphere && (0.5..1.0).contains(red) && met,
            "{id} {red} {depth}"
        );
    }
    assert!(id.contains(&sphere) && id.contains(&0.0));
    bench.refuses("gather", &with(&own, &["--layers", "depth", "-o", "no.exr"]), &["albedo", "id"]);
}

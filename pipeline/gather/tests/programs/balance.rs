//! The default accuracy of the cut, which the noise of the paths decides in images of 8,192 pixels or more.
//!
//! Seen to catch: the accuracy not in proportion to the root of the paths; files that state the accuracy of the settings in place of
//! the chosen one.

use test_support::{Bench, data};

fn gather(name: &str, bench: &Bench, output: &str, more: &[&str]) {
    let (scene, view) = (data(&format!("scenes/{name}.glb")), data(&format!("views/{name}/front.json")));
    let (cloud, stats) = (format!("{name}.cloud"), output.replace("exr", "json"));
    let own = [&cloud, &scene, "--view", &view, "--medium", "skin1", "-o", output, "--stats", &stats];
    bench.succeed("gather", &[&own[..], &["--calibration", "none", "--no-timings", "--quiet"], more].concat());
}

/// A cloud of few samples of a figure with sharp features, and of many of a sphere.
fn bench(of_sphere: &str) -> Bench {
    let bench = Bench::new();
    for (name, count) in [("figure", "5k"), ("sphere", of_sphere)] {
        let (scene, cloud) = (data(&format!("scenes/{name}.glb")), format!("{name}.cloud"));
        bench.succeed("sample-surface", &[&scene, "-n", count, "-o", &cloud, "--quiet"]);
    }
    bench
}

/// The relative error that the cut may add to a pixel, as the statistics state it.
fn accuracy(bench: &Bench, stats: &str) -> f64 {
    let estimator = bench.json(stats)["estimator"].as_str().expect("a text").to_owned();
    estimator.strip_prefix("cut ").expect("the cut").parse().expect("a number")
}

const SIZE: [&str; 4] = ["--width", "100", "--height", "90"];

#[test]
fn it_follows_the_noise_of_the_paths() {
    let bench = bench("100k");
    let of = |scene: &str, more: &[&str]| {
        gather(scene, &bench, "x.exr", more);
        accuracy(&bench, "x.json")
    };
    let fixed = of("figure", &["--width", "40", "--height", "30"]);
    assert_eq!(fixed, 0.005);
    let [smooth, rough] = ["sphere", "figure"].map(|scene| of(scene, &SIZE));
    // Less than what the cut adds while the noise is measured; the squared error times the time is the least at 0.002.
    assert!((0.00125..0.003).contains(&smooth), "{smooth}");
    assert!(rough > 2.0 * fixed, "{rough}");
    assert_eq!(of("figure", &[&SIZE[..], &["--accuracy", "0.013"]].concat()), 0.013);
    assert_eq!(of("figure", &[&SIZE[..], &["--target-error", "0.08"]].concat()), 0.06);
}

/// A gather is as accurate whatever the number of paths, in a crop, and where an image goes on.
#[test]
fn it_is_the_same_for_all_paths_of_an_image_and_its_crops() {
    let bench = bench("20k");
    let all = [&SIZE[..], &["--crop", "30,20,20,20"]].concat();
    let render = |output: &str, more: &[&str]| gather("sphere", &bench, output, &[&all[..], more].concat());
    render("whole.exr", &["--spp", "16", "--keep-sums"]);
    render("first.exr", &["--spp", "4", "--keep-sums"]);
    render("on.exr", &["--spp", "12", "--continue", "first.exr"]);
    assert!(bench.read("on.exr") == bench.read("whole.exr"));
    let [few, many] = ["first.json", "whole.json"].map(|stats| accuracy(&bench, stats));
    assert!((few / many - 2.0).abs() < 1e-9, "{few}, {many}");
    gather("sphere", &bench, "uncropped.exr", &[&SIZE[..], &["--spp", "16"]].concat());
    assert_eq!(accuracy(&bench, "uncropped.json"), many);
}

//! `--continue`: paths are added to an image as if it had been rendered at once.
//!
//! Seen to catch: the accuracy of a gather by the number of paths of each run; the paths of the second run numbered from 0;
//! the sums of edge pixels not kept; sums in float32.

use test_support::{Bench, data};

const CLOUD: &str = "figure.cloud";

/// Renders the figure at 24 x 24 pixels.
fn arguments<'a>(scene: &'a str, view: &'a str, output: &'a str, more: &[&'a str]) -> Vec<&'a str> {
    let own = [CLOUD, scene, "--view", view, "-o", output, "--width", "24", "--height", "24", "--quiet"];
    let medium = if more.contains(&"--medium") { &[][..] } else { &["--medium", "skin1"][..] };
    [&own[..], medium, more].concat()
}

fn bench() -> (Bench, String, String) {
    let bench = Bench::new();
    let scene = data("scenes/figure.glb");
    bench.succeed("sample-surface", &[&scene, "-n", "5k", "-o", CLOUD, "--quiet"]);
    (bench, scene, data("views/figure/front.json"))
}

/// 16 + 48 = 64, 5 + 7 + 4 = 16, with each estimator, with walks, and with a crop.
#[test]
fn parts_are_the_whole_bit_for_bit() {
    let (bench, scene, view) = bench();
    let reference = ["--reference"];
    for (how, parts) in [
        (&[][..], &["16", "48"][..]),
        (&["--estimator", "roulette"], &["5", "7", "4"]),
        (&["--estimator", "exhaustive", "--crop", "5,3,17,9"], &["2", "3"]),
        (&["--layers", "id,albedo", "--filter", "point"], &["4", "5"]),
        (&reference, &["3", "5"]),
    ] {
        let all: u32 = parts.iter().map(|part| part.parse::<u32>().expect("a number")).sum();
        let all = all.to_string();
        let render = |output: &str, spp: &str, more: &[&str]| {
            bench.succeed("gather", &arguments(&scene, &view, output, &[&["--spp", spp], how, more].concat()));
        };
        render("whole.exr", &all, &["--keep-sums"]);
        render("part0.exr", parts[0], &["--keep-sums"]);
        let last = parts[1..].iter().enumerate().fold("part0.exr".to_owned(), |before, (k, spp)| {
            let name = format!("part{}.exr", k + 1);
            render(&name, spp, &["--continue", &before]);
            name
        });
        assert!(bench.read(&last) == bench.read("whole.exr"), "{how:?}");
        let sums = |image: &str| bench.image(&image.replace(".exr", ".sums")).channels;
        let bits =
            |image: &str| sums(image).iter().flat_map(|c| c.samples.clone()).map(f32::to_bits).collect::<Vec<_>>();
        assert!(bits(&last) == bits("whole.exr"), "{how:?}");
    }
}

/// The image that was stopped goes on too, and one of a given accuracy keeps that of its gathers.
#[test]
fn the_accuracy_of_gathers_is_kept() {
    let (bench, scene, view) = bench();
    let render = |output: &str, more: &[&str]| bench.succeed("gather", &arguments(&scene, &view, output, more));
    render("whole.exr", &["--spp", "64", "--accuracy", "0.002"]);
    render("first.exr", &["--spp", "16", "--accuracy", "0.004", "--keep-sums"]);
    render("all.exr", &["--spp", "48", "--continue", "first.exr"]);
    assert!(bench.read("all.exr") == bench.read("whole.exr"));
    render("same.exr", &["--spp", "48", "--continue", "first.exr", "--accuracy", "0.002"]);
    assert!(bench.read("same.exr") == bench.read("whole.exr"));
    let other = ["--spp", "48", "--continue", "first.exr", "--accuracy", "0.004"];
    bench.refuses("gather", &arguments(&scene, &view, "no.exr", &other), &["--accuracy", "0.002 of 64 paths"]);
}

#[test]
fn an_image_of_other_settings_is_refused_by_their_name() {
    let (bench, scene, view) = bench();
    let first = arguments(&scene, &view, "first.exr", &["--spp", "4", "--keep-sums"]);
    bench.succeed("gather", &first);
    let back = data("views/figure/back.json");
    let other_view = if std::path::Path::new(&back).exists() { back } else { view.replace("front", "side") };
    for (more, name) in [
        (&["--seed", "1"][..], "--seed differs: 0 there, 1 here"),
        (&["--medium", "marble"], "--medium differs"),
        (&["--filter", "point"], "--filter differs"),
        (&["--max-depth", "3"], "--max-depth differs"),
        (&["--bssrdf", "directional-dipole"], "--bssrdf differs: half-space there, directional-dipole here"),
        (&["--estimator", "exhaustive"], "--estimator differs"),
        (&["--crop", "0,0,8,8"], "--crop differs: none there"),
        (&["--reference"], "--reference differs: false there, true here"),
    ] {
        let more = [&["--continue", "first.exr"][..], more].concat();
        bench.refuses("gather", &arguments(&scene, &view, "no.exr", &more), &["first.exr", name]);
    }
    if std::path::Path::new(&other_view).exists() {
        let more = ["--continue", "first.exr"];
        bench.refuses("gather", &arguments(&scene, &other_view, "no.exr", &more), &["--camera differs"]);
    }
    bench.succeed("sample-surface", &[&scene, "-n", "5k", "--seed", "1", "-o", "other.cloud", "--quiet"]);
    let mut of_other = arguments(&scene, &view, "no.exr", &["--continue", "first.exr"]);
    of_other[0] = "other.cloud";
    bench.refuses("gather", &of_other, &["CLOUD differs"]);
}

/// Sums that are missing, of another image, damaged, or of one path alone.
#[test]
fn sums_that_will_not_do_are_refused() {
    let (bench, scene, view) = bench();
    let one = arguments(&scene, &view, "no.exr", &["--spp", "1", "--keep-sums"]);
    bench.refuses("gather", &one, &["--spp", "no second half"]);
    bench.succeed("gather", &arguments(&scene, &view, "first.exr", &["--spp", "4", "--keep-sums"]));
    bench.succeed("gather", &arguments(&scene, &view, "plain.exr", &["--spp", "4"]));
    let refuses = |image: &str, words: &[&str]| {
        bench.refuses("gather", &arguments(&scene, &view, "no.exr", &["--continue", image]), words);
    };
    refuses("plain.exr", &["plain.sums", "--keep-sums"]);
    refuses("gone.exr", &["gone.exr", "cannot read"]);
    let sums = bench.read("first.sums");
    bench.write("plain.sums", &sums);
    // The images are the same, and their sums too.
    bench.succeed("gather", &arguments(&scene, &view, "more.exr", &["--continue", "plain.exr"]));
    bench.succeed("gather", &arguments(&scene, &view, "plain.exr", &["--spp", "5"]));
    refuses("plain.exr", &["the sums of another image"]);
    bench.write("first.sums", &sums[..sums.len() / 2]);
    refuses("first.exr", &["first.sums", "damaged or truncated"]);
    bench.write("first.sums", bench.read("plain.exr"));
    refuses("first.exr", &["first.sums", "no sums"]);
    let itself = arguments(&scene, &view, "first.exr", &["--continue", "first.exr"]);
    bench.refuses("gather", &itself, &["would replace"]);
}

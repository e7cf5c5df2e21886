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

/// A view with a lens that is focused before its target.
fn with_lens(view: &str) -> String {
    let text = std::fs::read_to_string(view).expect("reads");
    let mut view: serde_json::Value = serde_json::from_str(&text).expect("a view");
    (view["aperture"], view["focus"]) = ("f/2.8".into(), 0.16.into());
    view.to_string()
}

/// The same with a lens, which blurs silhouettes. A lens without an opening is none.
///
/// Seen to catch: the places on the lens numbered from 0 by each run.
#[test]
fn images_through_a_lens_are_continued_and_cropped() {
    let (bench, scene, view) = bench();
    let text = with_lens(&view);
    let lens = bench.write("lens.json", &text).to_string_lossy().into_owned();
    let closed = bench.write("closed.json", text.replace("\"f/2.8\"", "0")).to_string_lossy().into_owned();
    let render = |view: &str, output: &str, more: &[&str]| {
        bench.succeed("gather", &arguments(&scene, view, output, more));
        bench.read(output)
    };
    let whole = render(&lens, "whole.exr", &["--spp", "8"]);
    render(&lens, "first.exr", &["--spp", "4", "--keep-sums", "--threads", "1"]);
    assert!(render(&lens, "all.exr", &["--spp", "4", "--continue", "first.exr"]) == whole);
    let sharp = render(&view, "sharp.exr", &["--spp", "8"]);
    assert!(render(&closed, "closed.exr", &["--spp", "8"]) == sharp && sharp != whole);
    render(&lens, "crop.exr", &["--spp", "8", "--crop", "5,3,17,9"]);
    let [whole, crop] = ["whole.exr", "crop.exr"].map(|name| bench.image(name));
    let [all, part] = [&whole, &crop].map(|image| image.channel("R").expect("a channel"));
    for (k, value) in part.iter().enumerate() {
        let (x, y) = (5 + k % 17, 3 + k / 17);
        assert_eq!(value.to_bits(), all[y * 24 + x].to_bits(), "{x},{y}");
    }
    let number = |name: &str| match whole.attributes.get(name) {
        Some(formats::Attribute::Float(value)) => *value,
        other => panic!("{name}: {other:?}"),
    };
    assert!((number("aperture") - 2.8).abs() < 1e-6 && (number("focus") - 0.16).abs() < 1e-6);
    bench.succeed("gather", &arguments(&scene, &lens, "turn.exr", &["--spp", "2", "--orbit", "2"]));
    let turned = bench.image("turn.0001.exr");
    assert_eq!(turned.attributes.get("focus"), whole.attributes.get("focus"));
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

/// Paths that pixels share by the noise of their neighbors are continued with the same shares, 10 + 14 = 24, with and
/// without a target error and with any number of threads. Sums without shares, of an image of `--spp` as those of older
/// versions are, are continued to a target error too.
///
/// Seen to catch: shares not kept, and shares of the sums so far; the same number of paths taken for all pixels of the
/// sums; another rounding where paths go on; sums without shares refused.
#[test]
fn shared_paths_are_continued_with_their_shares() {
    let (bench, scene, view) = bench();
    let render = |output: &str, more: &[&str]| {
        let own = ["--calibration", "none", "--stats", "stats.json"];
        bench.succeed("gather", &arguments(&scene, &view, output, &[&own[..], more].concat()));
        let stats = bench.json("stats.json");
        let number = |name: &str| stats[name].as_u64().expect("a number");
        let paths = ["fewest_paths_of_a_pixel", "paths_per_pixel", "most_paths_of_a_pixel"].map(number);
        (stats["ended_by"].as_str().expect("a word").to_owned(), paths)
    };
    // The sum over all samples does not depend on what is planned, as the accuracy of a cut does.
    let all = ["--estimator", "exhaustive"];
    let target = [&all[..], &["--target-error", "0.005"]].concat();
    let (end, [fewest, mean, most]) = render("whole.exr", &[&target[..], &["--spp", "24"]].concat());
    assert!(end == "paths" && mean == 24 && fewest < 20 && 40 < most, "{end}: {fewest}, {mean}, {most}");
    render("first.exr", &[&target[..], &["--spp", "10", "--keep-sums", "--threads", "1"]].concat());
    let more = ["--spp", "14", "--continue", "first.exr"];
    assert_eq!(render("more.exr", &[&target[..], &more].concat()), (end, [fewest, mean, most]));
    assert!(bench.read("more.exr") == bench.read("whole.exr"));
    assert_eq!(render("plain.exr", &[&all[..], &more].concat()).1, [fewest, mean, most]);
    let bits = |image: &str| -> Vec<u32> {
        bench.image(image).channels.iter().flat_map(|c| c.samples.iter().map(|x| x.to_bits())).collect()
    };
    assert!(bits("plain.exr") == bits("whole.exr"));

    render("first.exr", &["--spp", "6", "--keep-sums"]);
    assert!(!bench.image("first.sums").attributes.contains_key("pcsss/pathsBeforeSharing"));
    let (end, [fewest, mean, most]) = render("met.exr", &["--continue", "first.exr", "--target-error", "0.03"]);
    assert!(end == "target error" && 6 <= fewest && fewest < mean && mean < most, "{end}: {fewest}, {mean}, {most}");
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
    let lens = bench.write("lens.json", with_lens(&view)).to_string_lossy().into_owned();
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
    for other in [data("views/figure/back-left.json"), lens] {
        let more = ["--continue", "first.exr"];
        bench.refuses("gather", &arguments(&scene, &other, "no.exr", &more), &["--camera differs"]);
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

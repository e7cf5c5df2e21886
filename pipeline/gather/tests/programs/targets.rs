//! `--target-error` of both programs: the target is met, or the program says why it is not.

use test_support::{Bench, data};

/// Mean square of the difference of two images over the mean square of the first.
fn relative_error(bench: &Bench, reference: &str, test: &str) -> f64 {
    let (reference, test) = (bench.image(reference), bench.image(test));
    let (mut difference, mut power) = (0.0, 0.0);
    for channel in ["R", "G", "B"] {
        let planes = [&reference, &test].map(|image| image.channel(channel).expect("beauty"));
        for (r, t) in planes[0].iter().zip(planes[1]) {
            difference += f64::from(t - r).powi(2);
            power += f64::from(*r).powi(2);
        }
    }
    (difference / power).sqrt()
}

fn gather(bench: &Bench, cloud: &str, output: &str, more: &[&str]) -> String {
    let (scene, view) = (data("scenes/sphere.glb"), data("views/sphere/front.json"));
    let arguments = [cloud, &scene, "--view", &view, "--medium", "skimmilk", "-o", output, "--stats", "stats.json"];
    let size: &[&str] = if more.contains(&"--width") { &[] } else { &["--width", "32", "--height", "32"] };
    let run = bench.run("gather", &[&arguments[..], size, more].concat());
    let message = run.stderr;
    assert_eq!(run.status.code(), Some(0), "{message}");
    message
}

/// However loose the target is, noisy pixels have more paths than the first two.
///
/// Seen to catch: an image that ends as soon as it meets its target.
#[test]
fn pixels_share_paths_once_at_least() {
    let bench = Bench::new();
    bench.succeed("sample-surface", &[&data("scenes/sphere.glb"), "-n", "20k", "-o", "x.cloud"]);
    gather(&bench, "x.cloud", "x.exr", &["--target-error", "0.9"]);
    let number = |name: &str| bench.json("stats.json")[name].as_u64().expect("a number");
    let paths = ["fewest_paths_of_a_pixel", "paths_per_pixel", "most_paths_of_a_pixel"].map(number);
    assert!(paths[..2] == [2, 3] && paths[2] >= 4, "{paths:?}");
}

/// Seen to fail with a target taken ten times too large in either program.
#[test]
fn targets_are_met_or_the_cloud_is_named() {
    let bench = Bench::new();
    let sphere = data("scenes/sphere.glb");
    let chosen =
        ["--for-medium", "skimmilk", "--target-error", "0.01", "-o", "chosen.cloud", "--stats", "samples.json"];
    bench.succeed("sample-surface", &[&[sphere.as_str()], &chosen[..]].concat());
    let drawn = bench.json("samples.json")["samples_drawn"].as_u64().expect("a count");
    bench.succeed("sample-surface", &[&sphere, "-n", "4M", "--seed", "5", "-o", "fine.cloud"]);
    bench.succeed("sample-surface", &[&sphere, "-n", "1k", "-o", "coarse.cloud"]);

    gather(&bench, "fine.cloud", "fine.exr", &["--spp", "256", "--seed", "5", "--accuracy", "0.002"]);
    let met = gather(&bench, "chosen.cloud", "chosen.exr", &["--target-error", "0.04"]);
    let stated = bench.json("stats.json")["estimated_relative_error"].as_f64().expect("an error");
    let actual = relative_error(&bench, "fine.exr", "chosen.exr");
    assert!(!met.contains("warning: the cloud"), "{drawn} samples: {met}");
    assert!(stated <= 0.04 && actual <= 0.05, "{drawn} samples: {stated} stated, {actual} found");

    // With enough paths, the remaining error is that of the cloud, whose target is 0.01, and of the reference.
    gather(&bench, "chosen.cloud", "deep.exr", &["--spp", "128", "--accuracy", "0.002"]);
    let remains = relative_error(&bench, "fine.exr", "deep.exr");
    assert!(remains <= 0.015, "{drawn} samples: {remains}");

    let limited = gather(&bench, "coarse.cloud", "coarse.exr", &["--target-error", "0.001"]);
    assert!(limited.contains("warning: the cloud alone"), "{limited}");
    assert!(relative_error(&bench, "fine.exr", "coarse.exr") > 0.01);

    // The existing cloud is kept, though its number of samples was not given.
    bench.succeed("sample-surface", &[&[sphere.as_str()], &chosen[..]].concat());
    assert_eq!(bench.json("samples.json")["kept"], true);
}

/// The halves of sixteen pixels sometimes agree by chance, and differ by chance as often. The images have many seeds,
/// and clouds whose own error is a thirtieth of the target: at most 5 % of the images exceed twice the target, none
/// claims to have no error, and none blames the cloud. None of 200 seeds exceeded twice the target, so that new seeds
/// would fail less than once in a hundred times.
///
/// Seen to catch: the first small difference between halves taken for the error, which gave images with more than twice
/// the target, and clouds with a claimed error of 3 to 20 %.
#[test]
fn sixteen_pixels_do_not_meet_a_target_by_luck() {
    const TARGET: f64 = 0.05;
    let seeds = if cfg!(feature = "slow") { 200 } else { 12 };
    let bench = Bench::new();
    let sphere = data("scenes/sphere.glb");
    let size = ["--width", "4", "--height", "4"];
    bench.succeed("sample-surface", &[&sphere, "-n", "1M", "--seed", "999", "-o", "fine.cloud"]);
    gather(&bench, "fine.cloud", "fine.exr", &[&size[..], &["--spp", "2048", "--accuracy", "0.005"]].concat());
    let (mut beyond, mut blamed, mut squares, mut paths) = (0, 0, 0.0, 0.0);
    for seed in 0..seeds {
        // Without the feature `slow`, some seeds share a cloud.
        let (cloud, seed) = (if seeds < 200 { seed / 4 } else { seed }.to_string(), seed.to_string());
        bench.succeed("sample-surface", &[&sphere, "-n", "200k", "--seed", &cloud, "-o", "own.cloud"]);
        let own = ["--target-error", "0.05", "--seed", &seed];
        let message = gather(&bench, "own.cloud", "own.exr", &[&size[..], &own].concat());
        let error = relative_error(&bench, "fine.exr", "own.exr");
        let statistics = bench.json("stats.json");
        let stated = statistics["estimated_relative_error"].as_f64().expect("an error");
        assert!(stated > 0.0 && !message.contains(" 0.00 %"), "seed {seed}: {message}");
        beyond += usize::from(error > 2.0 * TARGET);
        blamed += usize::from(message.contains("warning: the cloud"));
        squares += error * error / f64::from(seeds);
        paths += statistics["paths"].as_f64().expect("a count") / 16.0 / f64::from(seeds);
    }
    println!(
        "{beyond} of {seeds} beyond twice the target, {blamed} blame the cloud; error {:.4}, {paths:.1} paths",
        squares.sqrt()
    );
    assert!(20 * beyond <= seeds as usize && squares.sqrt() <= TARGET, "{beyond} of {seeds}, error {}", squares.sqrt());
    assert_eq!(blamed, 0, "the error of the cloud is far below the target");
}

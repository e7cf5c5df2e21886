//! Clouds in several files. Seen to catch: clouds in the order of the command line; a shard that does not change the
//! random numbers; seed and shard not checked; picks of shards without weights.

use formats::Attribute;
use test_support::{Bench, data};

const SIZE: [&str; 7] = ["--width", "32", "--height", "32", "--no-timings", "--quiet", "--seed"];

fn sample(bench: &Bench, scene: &str, output: &str, more: &[&str]) {
    bench.succeed("sample-surface", &[&[scene, "-o", output, "--quiet"], more].concat());
}

/// The image has the same bytes for any order of the files; its hash of the clouds is that of all of them, and not that
/// of one.
#[test]
fn the_order_of_files_does_not_matter() {
    let bench = Bench::new();
    let (scene, view) = (data("scenes/sphere.glb"), data("views/sphere/front.json"));
    for (name, samples, shard, seed) in
        [("a", "3k", "0/3", "0"), ("b", "10k", "1/3", "0"), ("c", "1k", "2/3", "0"), ("d", "2k", "0/1", "5")]
    {
        let output = format!("{name}.cloud");
        sample(&bench, &scene, &output, &["-n", samples, "--shard", shard, "--seed", seed]);
    }
    for estimator in ["cut", "roulette", "exhaustive"] {
        let image = |first: &str, others: &[&str]| {
            let output = format!("{first}.exr");
            let how = [&scene, "--view", &view, "--medium", "skin1", "--estimator", estimator, "--stats", "s.json"];
            bench.succeed("gather", &[&[first], others, &how, &["-o", &output], &SIZE, &["3"]].concat());
            (bench.read(&output), bench.json("s.json"))
        };
        let one = image("a.cloud", &["b.cloud", "c.cloud", "d.cloud"]);
        assert!(one == image("c.cloud", &["d.cloud", "a.cloud", "b.cloud"]), "{estimator}");
        assert!(one == image("d.cloud", &["c.cloud", "b.cloud", "a.cloud"]), "{estimator}");
        assert_eq!((&one.1["samples_drawn"], &one.1["clouds"]), (&16_000.into(), &4.into()));
        let attributes = bench.image("a.cloud.exr").attributes;
        let Some(Attribute::Texts(lines)) = attributes.get("pcsss/clouds") else { panic!("{attributes:?}") };
        assert_eq!(lines.len(), 4);
        assert!(lines.iter().any(|line| line.ends_with("shard 1/3 seed 0 samples 10000")), "{lines:?}");
        let all = one.1["cloud"].as_str().expect("a hash");
        assert!(lines.iter().all(|line| !line.starts_with(all)));
        assert_eq!(attributes.get("pcsss/cloud"), Some(&Attribute::Text(all.into())));
    }
}

/// Clouds of one sample each have no second half from which to estimate their error, however many clouds there are.
///
/// Seen to fail: the samples of all clouds counted instead of those of their second halves.
#[test]
fn one_sample_each_is_no_measure_of_the_clouds() {
    let bench = Bench::new();
    let (scene, view) = (data("scenes/sphere.glb"), data("views/sphere/front.json"));
    let covered = |samples: &str| {
        for k in ["0", "1"] {
            sample(&bench, &scene, &format!("{k}.cloud"), &["-n", samples, "--shard", &format!("{k}/2")]);
        }
        let own = ["0.cloud", "1.cloud", &scene, "--view", &view, "--medium", "skin1", "-o", "x.exr"];
        bench.succeed("gather", &[&own[..], &["--spp", "4", "--stats", "s.json"], &SIZE, &["0"]].concat());
        bench.json("s.json")["estimated_relative_error_covers"].as_str().expect("words").to_owned()
    };
    assert_eq!(covered("1"), "camera paths, not the one sample");
    assert_eq!(covered("2"), "cloud, gather and camera paths");
}

/// Once each cloud was picked, the paths of a pixel weight the clouds by their samples: where all paths are alike, the
/// image of the cut is that of the whole sum, within the accuracy of 0.1 %. Picks without weights are off by 9 %.
#[test]
fn turns_make_the_whole_sum() {
    let bench = Bench::new();
    let (scene, view) = (data("scenes/sphere.glb"), data("views/sphere/front.json"));
    for (k, samples) in ["3k", "4k", "5k"].into_iter().enumerate() {
        sample(&bench, &scene, &format!("{k}.cloud"), &["-n", samples, "--shard", &format!("{k}/3")]);
    }
    // The samples are closer than a thirtieth of a mean free path, so that they alone are summed.
    bench.write(
        "thin.json",
        r#"{"name":"thin","unit":"1/mm","sigma_a":[0.001,0.001,0.001],"sigma_s":[0.02,0.02,0.02],"source":"made up"}"#,
    );
    let subsurface = |estimator: &str, paths: &str| {
        let own = ["0.cloud", "1.cloud", "2.cloud", &scene, "--medium", "thin.json", "--view", &view, "-o", "x.exr"];
        let how = ["--filter", "point", "--accuracy", "0.001", "--spp", paths];
        let how = if estimator == "cut" { &how[..] } else { &["--filter", "point", "--spp", "1"] };
        bench.succeed("gather", &[&own[..], &["--estimator", estimator], how, &SIZE, &["3"]].concat());
        bench.image("x.exr").channel("subsurface.G").expect("a layer").to_vec()
    };
    let whole = subsurface("exhaustive", "1");
    let power: f32 = whole.iter().map(|x| x * x).sum();
    for paths in ["8", "14", "16"] {
        let turns = subsurface("cut", paths);
        let error: f32 = whole.iter().zip(&turns).map(|(a, b)| (a - b).powi(2)).sum();
        println!("{paths} paths: {}", (error / power).sqrt());
        assert!(error < 1e-4 * power, "{paths} paths: {}", (error / power).sqrt());
    }
}

#[test]
fn clouds_that_do_not_belong_together_are_refused() {
    let bench = Bench::new();
    let (sphere, view) = (data("scenes/sphere.glb"), data("views/sphere/front.json"));
    let few = ["-n", "1k", "--shard"];
    sample(&bench, &sphere, "a.cloud", &[&few[..], &["0/2"]].concat());
    sample(&bench, &sphere, "same.cloud", &["-n", "2k", "--shard", "0/2"]);
    sample(&bench, &sphere, "sky.cloud", &[&few[..], &["1/2", "--environment", "1,1,1"]].concat());
    sample(&bench, &sphere, "flat.cloud", &[&few[..], &["1/2", "--normals", "geometric"]].concat());
    sample(&bench, &sphere, "large.cloud", &[&few[..], &["1/2", "--metres-per-unit", "2"]].concat());
    sample(&bench, &data("scenes/slab.glb"), "slab.cloud", &[&few[..], &["1/2"]].concat());
    let refused = |other: &str, words: &[&str]| {
        let arguments = ["a.cloud", other, &sphere, "--medium", "skin1", "--view", &view, "-o", "x.exr"];
        bench.refuses("gather", &arguments, &[&["a.cloud", other], words].concat());
    };
    refused("a.cloud", &["shard 0/2 of seed 0", "leave one out"]);
    refused("same.cloud", &["shard 0/2 of seed 0"]);
    refused("sky.cloud", &["their environments differ"]);
    refused("flat.cloud", &["their normals differ"]);
    refused("large.cloud", &["their metres per unit differ"]);
    refused("slab.cloud", &["meshes"]);
    for (files, word) in [
        (&["a.cloud", "none.cloud", &sphere][..], "none.cloud"),
        (&["a.cloud", "slab.cloud"], "slab.cloud: this is a cloud; give SCENE after all clouds"),
        (&["a.cloud", &sphere, "slab.cloud"], "sphere.glb: not a cloud"),
    ] {
        bench.refuses("gather", &[files, &["--medium", "skin1", "--view", &view, "-o", "x.exr"]].concat(), &[word]);
    }
    for shard in ["2/2", "0/0", "1", "a/b", "-1/2", "0/65537"] {
        let shard = format!("--shard={shard}");
        let arguments = [sphere.as_str(), "-n", "1k", "-o", "x.cloud", &shard];
        bench.refuses("sample-surface", &arguments, &["--shard"]);
    }
}

/// An existing cloud is kept if it is the shard that is asked for, and only then.
#[test]
fn a_shard_is_kept_and_another_is_not() {
    let bench = Bench::new();
    let sphere = data("scenes/sphere.glb");
    let kept = |shard: &[&str]| {
        let own = [sphere.as_str(), "-n", "1k", "-o", "a.cloud", "--stats", "s.json", "--quiet"];
        bench.succeed("sample-surface", &[&own, shard].concat());
        (bench.json("s.json")["kept"].as_bool().expect("a flag"), bench.json("s.json")["mean_flux_w"].clone())
    };
    let alone = kept(&[]);
    assert!(kept(&["--shard", "0/1"]).0, "0/1 is no shard");
    let first = kept(&["--shard", "0/2"]);
    let second = kept(&["--shard", "1/2"]);
    assert!(!first.0 && !second.0 && kept(&["--shard", "1/2"]).0);
    assert!(first.1 != second.1 && first.1 != alone.1 && kept(&["--shard", "0/3"]).1 != first.1);
}

/// The difference between clouds is not taken for their error before each was picked. Seen to fail: errors of 23 and 28
/// %.
#[test]
fn a_target_waits_for_all_clouds_to_have_a_turn() {
    let bench = Bench::new();
    let (scene, view) = (data("scenes/figure.glb"), data("views/figure/front.json"));
    let files: Vec<String> = (0..40).map(|k| format!("{k}.cloud")).collect();
    for (k, file) in files.iter().enumerate() {
        sample(&bench, &scene, file, &["-n", "1k", "--shard", &format!("{k}/40")]);
    }
    let mut own: Vec<&str> = files.iter().map(String::as_str).collect();
    own.extend([&scene, "--medium", "skin1", "--view", &view, "-o", "x.exr", "--stats", "s.json"]);
    own.extend(["--target-error", "0.2", "--spp", "1024"]);
    for seed in ["0", "2"] {
        bench.succeed("gather", &[&own[..], &SIZE, &[seed]].concat());
        let statistics = bench.json("s.json");
        let error = statistics["estimated_relative_error"].as_f64().expect("a number");
        println!("seed {seed}: {error}, {} paths", statistics["paths"]);
        assert!(error <= 0.2, "seed {seed}: {error}");
    }
}

/// Four shards of 250k samples and a cloud of 1M give the same image within their estimated errors: the mean of the
/// squared differences is the sum of the variances. Each variance is an estimate with one degree of freedom over
/// thousands of pixels that share clouds; a factor of 1.5 either way is beyond their scatter, and an error of 3 % is
/// seen.
#[test]
fn four_shards_agree_with_one_cloud_within_their_error() {
    let bench = Bench::new();
    let (scene, view) = (data("scenes/figure.glb"), data("views/figure/front.json"));
    sample(&bench, &scene, "one.cloud", &["-n", "1M", "--seed", "7"]);
    for k in 0..4 {
        sample(&bench, &scene, &format!("{k}.cloud"), &["-n", "250k", "--shard", &format!("{k}/4")]);
    }
    let gather = |clouds: &[&str], output: &str| {
        let own = [&scene, "--view", &view, "--medium", "skin1", "-o", output, "--spp", "8"];
        bench.succeed("gather", &[clouds, &own, &SIZE[..], &[output.split('.').next().expect("a digit")]].concat());
    };
    gather(&["one.cloud"], "1.exr");
    gather(&["0.cloud", "1.cloud", "2.cloud", "3.cloud"], "2.exr");
    let images = ["1.exr", "2.exr"].map(|name| bench.image(name));
    let (mut squares, mut variances, mut sums) = (0.0, 0.0, [0.0; 2]);
    for c in ["R", "G", "B"] {
        let plane = |k: usize, name: &str| images[k].channel(name).expect("a channel").to_vec();
        let [a, b] = [0, 1].map(|k| plane(k, c));
        let [va, vb] = [0, 1].map(|k| plane(k, &format!("variance.{c}")));
        for k in 0..a.len() {
            squares += f64::from(a[k] - b[k]).powi(2);
            variances += f64::from(va[k] + vb[k]);
            (sums[0], sums[1]) = (sums[0] + f64::from(a[k]), sums[1] + f64::from(b[k]));
        }
    }
    let (worse, ratio) = (squares / variances, sums[1] / sums[0]);
    println!("squares of differences over variances {worse:.3}, brightness {ratio:.4}");
    assert!((1.0 / 1.5..1.5).contains(&worse) && (ratio - 1.0).abs() < 0.01, "{worse} {ratio}");
}

//! The program as scripts see it: exit code, the last line of stdout, one line of stderr.
//!
//! Planted errors that these tests caught: a gate written as `!(value > limit)`, the worst channel found with
//! `>`, infinity counted as finite, gates on the channels of a layer together, each structure check left out,
//! exit code 0 whatever the verdict, a limit that may be NaN.

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use formats::image::{Attribute, Channel, Image};

const WIDTH: usize = 24;
const HEIGHT: usize = 16;

/// A folder with `reference.exr` in it.
struct Bench {
    folder: tempfile::TempDir,
}

/// What a run gave.
struct Run {
    code: Option<i32>,
    stdout: String,
    stderr: String,
}

/// Colours, one more layer, depth, and the hash of a scene.
fn picture() -> Image {
    let plane = |shift: usize| (0..WIDTH * HEIGHT).map(|i| 0.25 + ((i * 7 + shift) % 13) as f32 / 8.0).collect();
    let names = ["R", "G", "B", "Z", "variance.R"];
    let channels = names.iter().enumerate().map(|(i, name)| Channel { name: (*name).to_owned(), samples: plane(i) });
    Image {
        width: WIDTH,
        height: HEIGHT,
        channels: channels.collect(),
        attributes: [("pcsss/scene".to_owned(), Attribute::Text("5ce4e".to_owned()))].into(),
        window: [0, 0],
    }
}

impl Bench {
    fn new() -> Bench {
        let bench = Bench { folder: tempfile::tempdir().unwrap() };
        bench.write("reference.exr", &picture());
        bench
    }

    fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    fn write(&self, name: &str, image: &Image) {
        std::fs::write(self.path(name), image.encode().unwrap()).unwrap();
    }

    /// Compares the reference with a changed copy of itself.
    fn compare(&self, change: impl FnOnce(&mut Image), options: &[&str]) -> Run {
        let mut image = picture();
        change(&mut image);
        self.write("test.exr", &image);
        self.run("test.exr", options)
    }

    fn run(&self, test: &str, options: &[&str]) -> Run {
        run(Command::new(env!("CARGO_BIN_EXE_compare"))
            .args([self.path("reference.exr"), self.path(test)])
            .args(options))
    }
}

fn run(command: &mut Command) -> Run {
    let Output { status, stdout, stderr } = command.output().unwrap();
    let text = |bytes| String::from_utf8(bytes).unwrap();
    Run { code: status.code(), stdout: text(stdout), stderr: text(stderr) }
}

impl Run {
    fn verdict(&self) -> &str {
        self.stdout.lines().last().unwrap_or_default()
    }

    #[track_caller]
    fn passes(&self) {
        assert_eq!((self.code, self.stderr.as_str()), (Some(0), ""), "{}", self.stdout);
        assert!(self.verdict().starts_with("PASS test.exr relmse="), "{}", self.stdout);
    }

    #[track_caller]
    fn fails(&self, gates: &str) {
        assert_eq!((self.code, self.stderr.as_str()), (Some(1), ""), "{}", self.stdout);
        assert!(self.verdict().starts_with(&format!("FAIL {gates}")), "{}", self.stdout);
    }

    #[track_caller]
    fn cannot_judge(&self, words: &[&str]) {
        assert_eq!((self.code, self.stdout.as_str()), (Some(2), ""), "{}", self.stderr);
        assert_eq!(self.stderr.lines().count(), 1, "{}", self.stderr);
        for word in words {
            assert!(self.stderr.contains(word), "`{word}` is not in: {}", self.stderr);
        }
    }
}

fn scale(image: &mut Image, factor: f32) {
    image.channels.iter_mut().flat_map(|channel| &mut channel.samples).for_each(|sample| *sample *= factor);
}

const ALL_GATES: [&str; 11] =
    ["--max-bias", "0", "--max-relmse", "0", "--max-rmse", "0", "--max-abs", "0", "--max-outliers", "0@0", "--exact"];

#[test]
fn identical_images_pass_every_gate() {
    let bench = Bench::new();
    bench.compare(|_| (), &[]).passes();
    bench.compare(|_| (), &ALL_GATES).passes();
    bench.compare(|_| (), &[&ALL_GATES[..], &["--layer", "all"]].concat()).passes();
}

#[test]
fn one_per_cent_brighter_is_a_bias() {
    let bench = Bench::new();
    let brighter = |image: &mut Image| scale(image, 1.01);
    bench.compare(brighter, &[]).passes();
    bench.compare(brighter, &["--max-bias", "0.02"]).passes();
    bench.compare(brighter, &["--max-bias", "0.005"]).fails("max-bias 0.0");
    bench.compare(|image| scale(image, 0.99), &["--max-bias", "0.005"]).fails("max-bias 0.0");
}

/// Red up and blue down keeps the mean of the layer.
#[test]
fn a_shift_of_colour_is_a_bias() {
    let shift = |image: &mut Image| {
        image.channels[0].samples.iter_mut().for_each(|sample| *sample += 0.1);
        image.channels[2].samples.iter_mut().for_each(|sample| *sample -= 0.1);
    };
    Bench::new().compare(shift, &["--max-bias", "0.01"]).fails("max-bias");
}

#[test]
fn noise_without_bias_is_found() {
    let noisy = |image: &mut Image| {
        for channel in &mut image.channels {
            channel
                .samples
                .iter_mut()
                .enumerate()
                .for_each(|(i, sample)| *sample += if i % 2 == 0 { 0.5 } else { -0.5 });
        }
    };
    let bench = Bench::new();
    bench.compare(noisy, &["--max-bias", "1e-6"]).passes();
    bench.compare(noisy, &["--max-rmse", "0.4"]).fails("max-rmse 0.5 > ");
    bench.compare(noisy, &["--max-rmse", "0.5"]).passes();
    bench.compare(noisy, &["--max-relmse", "0.01"]).fails("max-relmse");
}

#[test]
fn values_that_are_no_numbers_fail() {
    let bench = Bench::new();
    let one = |image: &mut Image| image.channels[4].samples[5] = f32::NAN;
    bench.compare(one, &[]).fails("nonfinite 1 > 0");
    bench.compare(one, &["--allow-nonfinite"]).passes();
    bench.compare(|image| image.channels[0].samples[0] = f32::INFINITY, &[]).fails("nonfinite 1 > 0");
    let all = |image: &mut Image| scale(image, f32::NAN);
    bench.compare(all, &[]).fails("nonfinite 1920 > 0");
    for gate in [["--max-bias", "9"], ["--max-relmse", "9"], ["--max-rmse", "9"], ["--max-abs", "9"]] {
        bench.compare(all, &[&gate[..], &["--allow-nonfinite"]].concat()).fails(&format!("{} NaN > 9", &gate[0][2..]));
    }
    bench.compare(all, &["--allow-nonfinite", "--max-outliers", "383@1e30"]).fails("max-outliers 384 > 383");
}

#[test]
fn equal_nans_do_not_cancel() {
    let bench = Bench::new();
    let mut image = picture();
    image.channels[1].samples[3] = f32::NAN;
    bench.write("reference.exr", &image);
    bench.write("test.exr", &image);
    bench.run("test.exr", &[]).fails("nonfinite 2 > 0");
    bench.run("test.exr", &["--allow-nonfinite", "--max-bias", "1"]).fails("max-bias NaN > 1");
}

#[test]
fn one_bright_pixel_is_an_outlier() {
    let bench = Bench::new();
    let firefly = |image: &mut Image| image.channels[1].samples[2 * WIDTH + 3] = 1e4;
    let run = bench.compare(firefly, &["--max-abs", "100"]);
    run.fails("max-abs 9");
    assert!(run.stdout.contains(" 3,2 "), "{}", run.stdout);
    bench.compare(firefly, &["--max-outliers", "0@1"]).fails("max-outliers 1 > 0");
    bench.compare(firefly, &["--max-outliers", "1@1"]).passes();
}

#[test]
fn one_bit_fails_the_bitwise_gate_in_any_layer() {
    let bench = Bench::new();
    let flip = |image: &mut Image| {
        let sample = &mut image.channels[4].samples[0];
        *sample = f32::from_bits(sample.to_bits() ^ 1);
    };
    bench.compare(flip, &["--exact"]).fails("exact 1 > 0 (variance)");
    bench.compare(flip, &["--exact", "--layer", "beauty"]).passes();
}

#[test]
fn gates_look_at_beauty_unless_told_otherwise() {
    let bench = Bench::new();
    let deeper = |image: &mut Image| image.channels[3].samples.iter_mut().for_each(|sample| *sample *= 2.0);
    bench.compare(deeper, &["--max-bias", "0.1"]).passes();
    bench.compare(deeper, &["--max-bias", "0.1", "--layer", "Z"]).fails("max-bias 1 > 0.1 (Z Z)");
    bench.compare(deeper, &["--max-bias", "0.1", "--layer", "all"]).fails("max-bias 1 > 0.1 (Z Z)");
    bench.compare(deeper, &["--layer", "diffuse"]).cannot_judge(&["`diffuse`", "beauty, Z, variance", "--layer"]);
}

#[test]
fn images_of_different_structure_cannot_be_judged() {
    let bench = Bench::new();
    let smaller = Image { width: 1, height: 1, channels: vec![], ..picture() };
    let one = |name: &str| Channel { name: name.to_owned(), samples: vec![1.0] };
    let smaller = Image { channels: ["R", "G", "B", "Z", "variance.R"].map(one).to_vec(), ..smaller };
    bench.compare(|image| *image = smaller, &[]).cannot_judge(&["test.exr", "1 x 1", "24 x 16", "reference.exr"]);
    bench.compare(|image| image.window = [1, 0], &[]).cannot_judge(&["test.exr", "[1, 0]", "[0, 0]"]);
    bench.compare(|image| image.channels[3].name = "depth".to_owned(), &[]).cannot_judge(&["missing: Z", "depth"]);
    let other = |image: &mut Image| {
        image.attributes.insert("pcsss/scene".to_owned(), Attribute::Text("07435".to_owned()));
    };
    bench.compare(other, &[]).cannot_judge(&["pcsss/scene", "07435", "5ce4e", "--ignore-meta"]);
    bench.compare(other, &["--ignore-meta"]).passes();
    bench.compare(|image| image.attributes.clear(), &[]).passes();
}

#[test]
fn files_that_are_no_images_cannot_be_judged() {
    let bench = Bench::new();
    bench.run("missing.exr", &[]).cannot_judge(&["missing.exr"]);
    std::fs::write(bench.path("garbage.exr"), "garbage").unwrap();
    bench.run("garbage.exr", &[]).cannot_judge(&["garbage.exr", "not an OpenEXR file"]);
    let bytes = std::fs::read(bench.path("reference.exr")).unwrap();
    std::fs::write(bench.path("half.exr"), &bytes[..bytes.len() / 2]).unwrap();
    bench.run("half.exr", &[]).cannot_judge(&["half.exr", "truncated"]);
    bench.run(".", &[]).cannot_judge(&["not a regular file"]);
}

#[test]
fn wrong_usage_cannot_be_judged() {
    let bench = Bench::new();
    for options in
        [&["--max-baas", "1"][..], &["--max-bias", "NaN"], &["--max-abs=-1"], &["--max-outliers", "3"], &["third.exr"]]
    {
        let run = bench.compare(|_| (), options);
        assert_eq!((run.code, run.stdout.as_str()), (Some(2), ""), "{options:?}");
        assert!(run.stderr.contains(options[0].split('=').next().unwrap()), "{}", run.stderr);
    }
    assert_eq!(run(&mut Command::new(env!("CARGO_BIN_EXE_compare"))).code, Some(2));
}

#[test]
fn quiet_leaves_the_verdict() {
    let bench = Bench::new();
    let run = bench.compare(|_| (), &["--quiet"]);
    run.passes();
    assert_eq!(run.stdout.lines().count(), 1);
    assert!(bench.compare(|_| (), &[]).stdout.contains("relMSE"));
}

#[test]
fn output_is_the_same_for_any_number_of_threads() {
    let bench = Bench::new();
    let brighter = |image: &mut Image| scale(image, 1.37);
    let json = bench.path("report.json").display().to_string();
    let run = |threads: &str| {
        let run = bench.compare(
            brighter,
            &["--max-abs", "9", "--json", &json, "-j", threads, "--seed", "3", "--progress", "none"],
        );
        run.passes();
        (run.stdout, std::fs::read(&json).unwrap())
    };
    assert_eq!(run("1"), run("5"));
}

#[test]
fn json_holds_metrics_and_gates_also_on_failure() {
    let bench = Bench::new();
    let json = bench.path("report.json");
    let change = |image: &mut Image| image.channels[0].samples[WIDTH] += 2.0;
    let options = ["--max-abs", "1", "--max-outliers", "2@1.5", "--json", json.to_str().unwrap()];
    bench.compare(change, &options).fails("max-abs 2 > 1 (beauty R)");
    let report = read_json(&json);
    assert_eq!(report["schema"], 1);
    assert_eq!(report["pass"], false);
    assert_eq!(report["verdict"], "FAIL max-abs 2 > 1 (beauty R)");
    assert_eq!(report["relmse_epsilon"], 0.01);
    assert_eq!(report["nonfinite"]["test"], 0);
    let red = &report["layers"][0]["channels"][0];
    assert_eq!((&red["name"], &red["max"]["error"]), (&"R".into(), &2.0.into()));
    assert_eq!(red["max"]["pixel"], serde_json::json!([0, 1]));
    assert_eq!(red["mae"], 2.0 / (WIDTH * HEIGHT) as f64);
    let gates: Vec<_> = report["gates"].as_array().unwrap().iter().map(|gate| (&gate["gate"], &gate["ok"])).collect();
    let expected = [("nonfinite", true), ("max-abs", false), ("max-outliers", true)];
    assert_eq!(
        gates,
        expected.map(|(gate, ok)| (serde_json::Value::from(gate), ok.into())).each_ref().map(|(a, b)| (a, b))
    );
    assert_eq!((&report["gates"][1]["value"], &report["gates"][1]["limit"]), (&2.0.into(), &1.0.into()));
}

#[test]
fn json_never_replaces_an_image_and_needs_its_folder() {
    let bench = Bench::new();
    let bytes = std::fs::read(bench.path("reference.exr")).unwrap();
    let options = |name: &str| ["--json".to_owned(), bench.path(name).display().to_string()];
    let run = |name: &str| bench.compare(|_| (), &options(name).each_ref().map(String::as_str));
    run("reference.exr").cannot_judge(&["reference.exr", "--json"]);
    assert_eq!(std::fs::read(bench.path("reference.exr")).unwrap(), bytes);
    run("no/report.json").cannot_judge(&["no"]);
}

fn read_json(path: &Path) -> serde_json::Value {
    serde_json::from_slice(&std::fs::read(path).unwrap()).unwrap()
}

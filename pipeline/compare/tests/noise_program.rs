//! Tests of `compare --replicates` and `--summarise` as programs.
//!
//! Seen to catch: one tail of t only, a gate written as `!(p < level)`, samples that are not finite passing because no statistic
//! holds them, a layer that is no longer black passing, a cloud twice, a cloud of the reference, too few replicates, another
//! scene, a reference that is not finite, logarithms of one side only.

use std::path::{Path, PathBuf};
use std::process::Command;

use formats::image::{Attribute, Image};

mod synthetic;
use synthetic::{Fault, SOUND, replicate};

/// The folders `reference` with twelve replicates and `test` with eight.
struct Bench {
    folder: tempfile::TempDir,
}

/// The exit code, standard output and standard error of a run.
struct Run(Option<i32>, String, String);

impl Bench {
    fn new(fault: Fault) -> Bench {
        let bench = Bench { folder: tempfile::tempdir().unwrap() };
        (0..12).for_each(|seed| bench.write("reference", seed, &replicate(seed + 1, SOUND)));
        (0..8).for_each(|seed| bench.write("test", seed, &replicate(seed + 101, fault)));
        bench
    }

    /// A bench without a fault, but with one of the test images changed.
    fn with(change: impl FnOnce(&mut Image)) -> Bench {
        let bench = Bench::new(SOUND);
        let mut image = replicate(101, SOUND);
        change(&mut image);
        bench.write("test", 0, &image);
        bench
    }

    fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    fn write(&self, folder: &str, number: u64, image: &Image) {
        std::fs::create_dir_all(self.path(folder)).unwrap();
        std::fs::write(self.path(folder).join(format!("{number}.exr")), image.encode().unwrap()).unwrap();
    }

    fn run(&self, mode: &str, folders: [&str; 2], options: &[&str]) -> Run {
        let mut command = Command::new(env!("CARGO_BIN_EXE_compare"));
        let output = command.arg(mode).args(folders.map(|f| self.path(f))).args(options).output().unwrap();
        let text = |bytes| String::from_utf8(bytes).unwrap();
        Run(output.status.code(), text(output.stdout), text(output.stderr))
    }

    fn judge(&self, options: &[&str]) -> Run {
        self.run("--replicates", ["reference", "test"], options)
    }
}

fn channel<'a>(image: &'a mut Image, name: &str) -> &'a mut [f32] {
    &mut image.channels.iter_mut().find(|channel| channel.name == name).unwrap().samples
}

impl Run {
    #[track_caller]
    fn passes(&self) {
        assert_eq!((self.0, self.2.as_str()), (Some(0), ""), "{}", self.1);
        assert!(self.1.lines().last().unwrap().starts_with("PASS test p="), "{}", self.1);
    }

    #[track_caller]
    fn fails(&self, words: &str) {
        assert_eq!((self.0, self.2.as_str()), (Some(1), ""), "{}", self.1);
        let verdict = self.1.lines().last().unwrap();
        assert!(verdict.starts_with("FAIL test ") && verdict.contains(words), "{verdict}");
    }

    #[track_caller]
    fn cannot_judge(&self, words: &[&str]) {
        assert_eq!((self.0, self.1.as_str(), self.2.lines().count()), (Some(2), "", 1), "{}", self.2);
        for word in words {
            assert!(self.2.contains(word), "`{word}` is not in: {}", self.2);
        }
    }
}

#[test]
fn sound_images_pass_and_brighter_or_darker_ones_fail() {
    let run = Bench::new(SOUND).judge(&[]);
    run.passes();
    for word in ["difference", "level", "df", "visible", "subsurface tile 1,1 B/G", "not tested: nearly all background"]
    {
        assert!(run.1.contains(word), "`{word}` is not in: {}", run.1);
    }
    assert_eq!(Bench::new(SOUND).judge(&["--quiet", "--family", "5"]).1.lines().count(), 1);
    Bench::new(Fault { red: 1.1, ..SOUND }).judge(&[]).fails(" R/G +");
    Bench::new(Fault { red: 0.9, ..SOUND }).judge(&[]).fails(" R/G -");
}

#[test]
fn values_that_are_not_finite_fail() {
    Bench::with(|image| image.channels[3].samples[40] = f32::NAN).judge(&[]).fails("1 samples are not finite");
    Bench::with(|image| image.channels[2].samples[0] = f32::INFINITY).judge(&[]).fails("not finite");
    // Depth is no color, and no statistic holds it.
    Bench::with(|image| channel(image, "Z").fill(f32::NAN)).judge(&[]).fails("81 samples are not finite");
    let bench = Bench::new(SOUND);
    let mut image = replicate(1, SOUND);
    image.channels[0].samples[0] = f32::NAN;
    bench.write("reference", 0, &image);
    bench.judge(&[]).cannot_judge(&["0.exr", "not finite"]);
}

/// The logarithm of zero is not finite.
#[test]
fn a_channel_that_went_black_fails() {
    let bench = Bench::new(SOUND);
    for seed in 0..8 {
        let mut image = replicate(seed + 101, SOUND);
        channel(&mut image, "G").fill(0.0);
        bench.write("test", seed, &image);
    }
    bench.judge(&[]).fails(" G ");
}

/// The layer without light has no variance, so it must stay black.
#[test]
fn a_black_layer_must_stay_black() {
    let bench = Bench::new(SOUND);
    for seed in 0..8 {
        let mut image = replicate(seed + 101, SOUND);
        channel(&mut image, "transmission.G")[7] = 1e-3;
        bench.write("test", seed, &image);
    }
    bench.judge(&[]).fails("transmission G");
}

#[test]
fn images_that_are_no_replicates_are_refused() {
    let set = |name: &'static str, value: &'static str| {
        move |image: &mut Image| {
            image.attributes.insert(name.to_owned(), Attribute::Text(value.to_owned()));
        }
    };
    Bench::with(set("pcsss/cloud", "0000000000000066")).judge(&[]).cannot_judge(&[
        "same cloud",
        "1.exr",
        "another seed",
    ]);
    Bench::with(set("pcsss/cloud", "0000000000000005")).judge(&[]).cannot_judge(&["same cloud", "reference"]);
    Bench::with(set("pcsss/scene", "07435")).judge(&[]).cannot_judge(&["scene", "07435", "5ce4e"]);
    Bench::with(|image| image.attributes.clear()).judge(&[]).cannot_judge(&["0.exr", "pcsss/scene"]);
    Bench::with(|image| image.window = [1, 0]).judge(&[]).cannot_judge(&["[1, 0]", "one size"]);
    Bench::with(|image| drop(image.channels.pop())).judge(&[]).cannot_judge(&["0.exr", "channels"]);
    let bench = Bench::new(SOUND);
    bench.write("test", 5, &Image { window: [0, 2], ..replicate(106, SOUND) });
    bench.judge(&[]).cannot_judge(&["5.exr", "[0, 2]", "0.exr"]);
    bench.write("test", 5, &replicate(106, SOUND));
    std::fs::remove_file(bench.path("test/3.exr")).unwrap();
    bench.judge(&[]).cannot_judge(&["test", "7 replicates", "at least 8"]);
    bench.run("--replicates", ["missing", "test"], &[]).cannot_judge(&["missing"]);
    std::fs::write(bench.path("test/3.exr"), "garbage").unwrap();
    bench.judge(&[]).cannot_judge(&["3.exr", "not an OpenEXR file"]);
}

#[test]
fn a_summary_judges_like_the_images_it_was_made_of() {
    let bench = Bench::new(Fault { red: 1.02, ..SOUND });
    assert_eq!(bench.run("--summarise", ["reference", "golden"], &[]).0, Some(0));
    let judge = |reference: &str| {
        let json = bench.path("report.json");
        let run = bench.run("--replicates", [reference, "test"], &["--json", json.to_str().unwrap()]);
        let report: serde_json::Value = serde_json::from_slice(&std::fs::read(json).unwrap()).unwrap();
        assert_eq!((&report["schema"], report["pass"].as_bool()), (&1.into(), Some(run.0 == Some(0))));
        run.1
    };
    assert_eq!(judge("reference"), judge("golden"));
    let mean = Image::read(&bench.path("golden/mean.exr")).unwrap();
    assert_eq!((mean.width, mean.channels.len()), (synthetic::SIZE, 3));
    bench.run("--summarise", ["test", "golden"], &[]);
    bench.run("--replicates", ["golden", "test"], &[]).cannot_judge(&["same cloud", "golden"]);
}

/// Seen to catch: the mean written among the replicates, so that a second run refused the folder; a summary beside images, which
/// would be read instead of them.
#[test]
fn a_summary_is_not_written_among_images() {
    let bench = Bench::new(SOUND);
    let names = || std::fs::read_dir(bench.path("reference")).unwrap().count();
    for target in ["reference", "test"] {
        bench.run("--summarise", ["reference", target], &[]).cannot_judge(&[target, ".exr", "without images"]);
    }
    assert_eq!(names(), 12);
    // The mean of an earlier run may be replaced.
    for _ in 0..2 {
        assert_eq!(bench.run("--summarise", ["reference", "golden"], &[]).0, Some(0));
    }
}

/// Seen to catch: a report written over a replicate.
#[test]
fn the_report_does_not_replace_a_replicate() {
    let bench = Bench::new(SOUND);
    for image in ["reference/3.exr", "test/3.exr"] {
        let (path, before) = (bench.path(image), std::fs::read(bench.path(image)).unwrap());
        bench.judge(&["--json", path.to_str().unwrap()]).cannot_judge(&[image, "--json would replace an image"]);
        assert_eq!(std::fs::read(path).unwrap(), before);
    }
}

/// Seen to catch: primaries and display windows that were not compared.
#[test]
fn replicates_of_another_meaning_are_refused() {
    let aces = Attribute::Chromaticities([0.713, 0.293, 0.165, 0.83, 0.128, 0.044, 0.321_68, 0.337_67]);
    let convert = |image: &mut Image| drop(image.attributes.insert("chromaticities".to_owned(), aces.clone()));
    Bench::with(convert).judge(&[]).cannot_judge(&["chromaticities", "0.713", "0.64"]);
    let bench = Bench::new(SOUND);
    assert_eq!(bench.run("--summarise", ["reference", "golden"], &[]).0, Some(0));
    for seed in 0..8 {
        let mut image = replicate(seed + 101, SOUND);
        convert(&mut image);
        bench.write("test", seed, &image);
    }
    bench.judge(&[]).cannot_judge(&["chromaticities", "reference"]);
    bench.run("--replicates", ["golden", "test"], &[]).cannot_judge(&["chromaticities", "golden"]);
    for seed in 0..12 {
        let mut image = replicate(seed + 1, SOUND);
        convert(&mut image);
        bench.write("reference", seed, &image);
    }
    assert_eq!(bench.run("--summarise", ["reference", "golden"], &[]).0, Some(0));
    assert!(Image::read(&bench.path("golden/mean.exr")).unwrap().attributes["chromaticities"] == aces);
    bench.run("--replicates", ["golden", "test"], &[]).passes();
}

#[test]
fn a_damaged_summary_is_refused() {
    let bench = Bench::new(SOUND);
    bench.run("--summarise", ["reference", "golden"], &[]);
    let path = bench.path("golden/statistics.json");
    let text = std::fs::read_to_string(&path).unwrap();
    let damage = |path: &Path, from: &str, to: &str| {
        assert!(text.contains(from));
        std::fs::write(path, text.replacen(from, to, 1)).unwrap();
        bench
            .run("--replicates", ["golden", "test"], &[])
            .cannot_judge(&["statistics.json", "summarise the images again"]);
    };
    damage(&path, "\"schema\": 1", "\"schema\": 2");
    damage(&path, "\"variance\": ", "\"variance\": -");
    damage(&path, "\"mean\"", "\"median\"");
    damage(&path, "beauty R", "beauty X");
    damage(&path, "{", "");
}

#[test]
fn options_for_two_images_are_refused() {
    let bench = Bench::new(SOUND);
    for options in [["--max-bias", "1"], ["--layer", "all"], ["--family", "0"]] {
        assert_eq!(bench.judge(&options).0, Some(2), "{options:?}");
    }
}

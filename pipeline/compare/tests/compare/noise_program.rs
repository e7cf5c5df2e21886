//! Tests of `compare --replicates` and `--summarise` as programs.
//!
//! Seen to catch: one tail of t only, a gate written as `!(p < level)`, samples that are not finite passing because no
//! statistic holds them, a layer that is no longer black passing, a cloud twice, a cloud of the reference, too few
//! replicates, another scene, a reference that is not finite, logarithms of one side only.

use formats::image::{Attribute, Image};
use test_support::{Bench, Run};

use crate::{
    support::Verdict,
    synthetic::{self, Fault, SOUND, replicate},
};

/// The folders `reference` with twelve replicates and `test` with eight.
fn bench(fault: Fault) -> Bench {
    let bench = Bench::new();
    (0..12).for_each(|seed| write(&bench, "reference", seed, &replicate(seed + 1, SOUND)));
    (0..8).for_each(|seed| write(&bench, "test", seed, &replicate(seed + 101, fault)));
    bench
}

/// A bench without a fault, but with one of the test images changed.
fn changed(change: impl FnOnce(&mut Image)) -> Bench {
    let bench = bench(SOUND);
    let mut image = replicate(101, SOUND);
    change(&mut image);
    write(&bench, "test", 0, &image);
    bench
}

fn write(bench: &Bench, folder: &str, number: u64, image: &Image) {
    bench.write_image(&format!("{folder}/{number}.exr"), image);
}

fn run(bench: &Bench, mode: &str, folders: [&str; 2], options: &[&str]) -> Run {
    bench.run("compare", &[&[mode], &folders[..], options].concat())
}

fn judge(bench: &Bench, options: &[&str]) -> Run {
    run(bench, "--replicates", ["reference", "test"], options)
}

#[track_caller]
fn fails(run: &Run, words: &str) {
    run.fails("test ");
    assert!(run.verdict().contains(words), "{}", run.verdict());
}

fn channel<'a>(image: &'a mut Image, name: &str) -> &'a mut [f32] {
    &mut image.channels.iter_mut().find(|channel| channel.name == name).unwrap().samples
}

#[test]
fn sound_images_pass_and_brighter_or_darker_ones_fail() {
    let run = judge(&bench(SOUND), &[]);
    run.passes();
    for word in ["difference", "level", "df", "visible", "subsurface tile 1,1 B/G", "not tested: nearly all background"]
    {
        assert!(run.stdout.contains(word), "`{word}` is not in: {}", run.stdout);
    }
    assert_eq!(judge(&bench(SOUND), &["--quiet", "--family", "5"]).stdout.lines().count(), 1);
    fails(&judge(&bench(Fault { red: 1.1, ..SOUND }), &[]), " R/G +");
    fails(&judge(&bench(Fault { red: 0.9, ..SOUND }), &[]), " R/G -");
}

#[test]
fn values_that_are_not_finite_fail() {
    fails(&judge(&changed(|image| image.channels[3].samples[40] = f32::NAN), &[]), "1 samples are not finite");
    fails(&judge(&changed(|image| image.channels[2].samples[0] = f32::INFINITY), &[]), "not finite");
    // Depth is no color, and no statistic holds it.
    fails(&judge(&changed(|image| channel(image, "Z").fill(f32::NAN)), &[]), "81 samples are not finite");
    let bench = bench(SOUND);
    let mut image = replicate(1, SOUND);
    image.channels[0].samples[0] = f32::NAN;
    write(&bench, "reference", 0, &image);
    judge(&bench, &[]).cannot_judge(&["0.exr", "not finite"]);
}

/// The logarithm of zero is not finite.
#[test]
fn a_channel_that_went_black_fails() {
    let bench = bench(SOUND);
    for seed in 0..8 {
        let mut image = replicate(seed + 101, SOUND);
        channel(&mut image, "G").fill(0.0);
        write(&bench, "test", seed, &image);
    }
    fails(&judge(&bench, &[]), " G ");
}

/// The layer without light has no variance, so it must stay black.
#[test]
fn a_black_layer_must_stay_black() {
    let bench = bench(SOUND);
    for seed in 0..8 {
        let mut image = replicate(seed + 101, SOUND);
        channel(&mut image, "transmission.G")[7] = 1e-3;
        write(&bench, "test", seed, &image);
    }
    fails(&judge(&bench, &[]), "transmission G");
}

#[test]
fn images_that_are_no_replicates_are_refused() {
    let set = |name: &'static str, value: &'static str| {
        move |image: &mut Image| {
            image.attributes.insert(name.to_owned(), Attribute::Text(value.to_owned()));
        }
    };
    judge(&changed(set("pcsss/cloud", "0000000000000066")), &[]).cannot_judge(&["same cloud", "1.exr", "another seed"]);
    judge(&changed(set("pcsss/cloud", "0000000000000005")), &[]).cannot_judge(&["same cloud", "reference"]);
    judge(&changed(set("pcsss/scene", "07435")), &[]).cannot_judge(&["scene", "07435", "5ce4e"]);
    judge(&changed(|image| image.attributes.clear()), &[]).cannot_judge(&["0.exr", "pcsss/scene"]);
    judge(&changed(|image| image.window = [1, 0]), &[]).cannot_judge(&["[1, 0]", "without cropping"]);
    judge(&changed(|image| drop(image.channels.pop())), &[]).cannot_judge(&["0.exr", "channels"]);
    let bench = bench(SOUND);
    write(&bench, "test", 5, &Image { window: [0, 2], ..replicate(106, SOUND) });
    judge(&bench, &[]).cannot_judge(&["5.exr", "[0, 2]", "0.exr"]);
    write(&bench, "test", 5, &replicate(106, SOUND));
    std::fs::remove_file(bench.path("test/3.exr")).unwrap();
    judge(&bench, &[]).cannot_judge(&["test", "7 replicates", "at least 8"]);
    run(&bench, "--replicates", ["missing", "test"], &[]).cannot_judge(&["missing"]);
    bench.write("test/3.exr", "garbage");
    judge(&bench, &[]).cannot_judge(&["3.exr", "not an OpenEXR file"]);
}

#[test]
fn a_summary_judges_like_the_images_it_was_made_of() {
    let bench = bench(Fault { red: 1.02, ..SOUND });
    assert_eq!(run(&bench, "--summarise", ["reference", "golden"], &[]).code(), Some(0));
    let judge = |reference: &str| {
        let json = bench.path("report.json");
        let run = run(&bench, "--replicates", [reference, "test"], &["--json", json.to_str().unwrap()]);
        let report: serde_json::Value = serde_json::from_slice(&std::fs::read(json).unwrap()).unwrap();
        assert_eq!((&report["schema"], report["pass"].as_bool()), (&1.into(), Some(run.code() == Some(0))));
        run.stdout
    };
    assert_eq!(judge("reference"), judge("golden"));
    let mean = bench.image("golden/mean.exr");
    assert_eq!((mean.width, mean.channels.len()), (synthetic::SIZE, 3));
    run(&bench, "--summarise", ["test", "golden"], &[]);
    run(&bench, "--replicates", ["golden", "test"], &[]).cannot_judge(&["same cloud", "golden"]);
}

/// Seen to catch: the mean written among the replicates, so that a second run refused the folder; a summary beside
/// images, which would be read instead of them.
#[test]
fn a_summary_is_not_written_among_images() {
    let bench = bench(SOUND);
    let names = || std::fs::read_dir(bench.path("reference")).unwrap().count();
    for target in ["reference", "test"] {
        run(&bench, "--summarise", ["reference", target], &[]).cannot_judge(&[target, ".exr", "without images"]);
    }
    assert_eq!(names(), 12);
    // The mean of an earlier run may be replaced.
    for _ in 0..2 {
        assert_eq!(run(&bench, "--summarise", ["reference", "golden"], &[]).code(), Some(0));
    }
}

/// Seen to catch: a report written over a replicate.
#[test]
fn the_report_does_not_replace_a_replicate() {
    let bench = bench(SOUND);
    for image in ["reference/3.exr", "test/3.exr"] {
        let (path, before) = (bench.path(image), bench.read(image));
        judge(&bench, &["--json", path.to_str().unwrap()]).cannot_judge(&[image, "--json would replace an image"]);
        assert_eq!(std::fs::read(path).unwrap(), before);
    }
}

/// Seen to catch: primaries and display windows that were not compared.
#[test]
fn replicates_of_another_meaning_are_refused() {
    let aces = Attribute::Chromaticities([0.713, 0.293, 0.165, 0.83, 0.128, 0.044, 0.321_68, 0.337_67]);
    let convert = |image: &mut Image| drop(image.attributes.insert("chromaticities".to_owned(), aces.clone()));
    judge(&changed(convert), &[]).cannot_judge(&["chromaticities", "0.713", "0.64"]);
    let bench = bench(SOUND);
    assert_eq!(run(&bench, "--summarise", ["reference", "golden"], &[]).code(), Some(0));
    for seed in 0..8 {
        let mut image = replicate(seed + 101, SOUND);
        convert(&mut image);
        write(&bench, "test", seed, &image);
    }
    judge(&bench, &[]).cannot_judge(&["chromaticities", "reference"]);
    run(&bench, "--replicates", ["golden", "test"], &[]).cannot_judge(&["chromaticities", "golden"]);
    for seed in 0..12 {
        let mut image = replicate(seed + 1, SOUND);
        convert(&mut image);
        write(&bench, "reference", seed, &image);
    }
    assert_eq!(run(&bench, "--summarise", ["reference", "golden"], &[]).code(), Some(0));
    assert!(bench.image("golden/mean.exr").attributes["chromaticities"] == aces);
    run(&bench, "--replicates", ["golden", "test"], &[]).passes();
}

#[test]
fn a_damaged_summary_is_refused() {
    let bench = bench(SOUND);
    run(&bench, "--summarise", ["reference", "golden"], &[]);
    let text = String::from_utf8(bench.read("golden/statistics.json")).unwrap();
    for [from, to] in [
        ["\"schema\": 1", "\"schema\": 2"],
        ["\"variance\": ", "\"variance\": -"],
        ["\"mean\"", "\"median\""],
        ["beauty R", "beauty X"],
        ["{", ""],
    ] {
        assert!(text.contains(from));
        bench.write("golden/statistics.json", text.replacen(from, to, 1));
        run(&bench, "--replicates", ["golden", "test"], &[])
            .cannot_judge(&["statistics.json", "summarise the images again"]);
    }
}

#[test]
fn options_for_two_images_are_refused() {
    let bench = bench(SOUND);
    for options in [["--max-bias", "1"], ["--layer", "all"], ["--family", "0"]] {
        assert_eq!(judge(&bench, &options).code(), Some(2), "{options:?}");
    }
}

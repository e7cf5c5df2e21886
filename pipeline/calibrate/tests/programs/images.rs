//! Images of a calibration, and calibrations that do not fit.

use crate::{bench, quick, slab};
use formats::Attribute;
use test_support::{Bench, Run, data, program};

/// A folder with a cloud of the slab and its calibration in marble.
fn calibrated() -> (Bench, String) {
    let (bench, slab) = (bench(), slab());
    bench.succeed("calibrate", &quick(&slab, "a.calibration", &["--quiet", "--stats", "a.json"]));
    (bench, slab)
}

fn arguments<'a>(scene: &'a str, more: &[&'a str]) -> Vec<&'a str> {
    [&["slab.cloud", scene, "--width", "6", "--spp", "2", "-o", "image.exr", "--quiet", "--no-timings"], more].concat()
}

fn image(bench: &Bench, scene: &str, more: &[&str]) -> formats::Image {
    bench.succeed("gather", &arguments(scene, more));
    bench.image("image.exr")
}

/// Seen to catch: a calibration that was read and not used.
#[test]
fn a_calibration_brings_its_media_and_model_and_leaves_its_mark() {
    let (bench, slab) = calibrated();
    let known = image(&bench, &slab, &["--calibration", "a.calibration"]);
    let own = ["--calibration", "a.calibration", "--medium", "marble", "--bssrdf", "half-space"];
    assert_eq!(image(&bench, &slab, &own).channels, known.channels);
    let plain = image(&bench, &slab, &["--calibration", "none", "--medium", "marble", "--bssrdf", "half-space"]);
    assert_ne!(plain.channels, known.channels);
    let digest = bench.json("a.json")["calibration"].as_str().expect("a text").to_owned();
    assert_eq!(known.attributes.get("pcsss/calibration"), Some(&Attribute::Text(digest)));
    assert!(known.attributes.contains_key("pcsss/modelError"));
    assert_eq!(known.attributes.get("pcsss/bssrdf"), Some(&Attribute::Text("half-space".into())));
    assert!(!plain.attributes.contains_key("pcsss/calibration"));
}

/// Seen to catch: neither cloud nor media compared.
#[test]
fn a_calibration_of_something_else_is_refused() {
    let (bench, slab) = calibrated();
    let refuses = |cloud: &str, scene: &str, more: &[&str], words: &[&str]| {
        let mut own = arguments(scene, &[&["--calibration", "a.calibration"], more].concat());
        own[0] = cloud;
        let message = bench.refuses("gather", &own, words);
        assert_eq!(message.lines().count(), 1, "{message}");
    };
    bench.succeed("sample-surface", &[&slab, "-n", "2k", "--seed", "5", "-o", "seed.cloud", "--quiet"]);
    let sphere = data("scenes/sphere.glb");
    bench.succeed("sample-surface", &[&sphere, "-n", "2k", "-o", "sphere.cloud", "--quiet"]);
    refuses("seed.cloud", &slab, &[], &["--calibration", "a.calibration", "another cloud", "calibrate again"]);
    refuses("sphere.cloud", &sphere, &[], &["--calibration", "a.calibration", "another cloud"]);
    refuses("slab.cloud", &sphere, &[], &["sphere.glb"]);
    refuses("slab.cloud", &slab, &["--medium", "skin1"], &["a.calibration", "marble", "skin1", "--medium"]);
    refuses("slab.cloud", &slab, &["--bssrdf", "standard-dipole"], &["a.calibration", "half-space", "standard-dipole"]);
}

/// The cloud of a smooth slab fits a rough one, which has other light below its surface; its calibration does not.
///
/// Seen to catch: roughness that is not compared.
#[test]
fn a_calibration_of_another_roughness_is_refused() {
    let (bench, slab) = calibrated();
    let (stated, other) = (b"\"roughnessFactor\":0.0", b"\"roughnessFactor\":0.5");
    let mut bytes = std::fs::read(slab).expect("a scene");
    let at = bytes.windows(stated.len()).position(|part| part == stated).expect("the roughness is stated");
    bytes[at..at + other.len()].copy_from_slice(other);
    bench.write("rough.glb", bytes);
    let message = bench.refuses(
        "gather",
        &arguments("rough.glb", &["--calibration", "a.calibration"]),
        &["a.calibration", "`Slab`", "roughness", "calibrate again"],
    );
    assert_eq!(message.lines().count(), 1, "{message}");
    bench.succeed("calibrate", &quick("rough.glb", "rough.calibration", &["--quiet"]));
    bench.succeed("gather", &arguments("rough.glb", &["--calibration", "rough.calibration"]));
}

#[test]
fn files_that_are_no_calibrations_are_refused() {
    let (bench, slab) = calibrated();
    let good = bench.read("a.calibration");
    let changed = |at: usize, byte: u8| {
        let mut bad = good.clone();
        bad[at] = byte;
        bad
    };
    for (bytes, word) in [
        (good[..good.len() / 2].to_vec(), "bytes instead of"),
        (good[..20].to_vec(), "truncated"),
        (changed(good.len() - 9, good[good.len() - 9] ^ 1), "damaged"),
        (changed(8, 99), "version 99"),
        (bench.read("slab.cloud"), "not a calibration"),
        (Vec::new(), "not a calibration"),
    ] {
        bench.write("bad.calibration", bytes);
        let own = arguments(&slab, &["--calibration", "bad.calibration"]);
        let message = bench.refuses("gather", &own, &["bad.calibration", word]);
        assert_eq!(message.lines().count(), 1, "{message}");
    }
    for (path, word) in [("missing.calibration", "No such file"), (".", "not a file")] {
        bench.refuses("gather", &arguments(&slab, &["--calibration", path]), &[path, word]);
    }
}

/// Without `--calibration`, `gather` calibrates as `calibrate` does, and says the command that keeps it in a file, as a
/// shell takes it.
///
/// Seen to catch: another seed in memory than that of the arguments, names without quotes.
#[test]
fn images_are_calibrated_by_default() {
    let (bench, scene) = (bench(), slab());
    std::fs::rename(bench.path("slab.cloud"), bench.path("my 'own' slab.cloud")).expect("renames");
    let own =
        ["my 'own' slab.cloud", &scene, "--seed", "3", "--no-timings", "--width", "12", "--height", "12", "--spp", "2"];
    let typed = [&own[..], &["--medium", "ketchup", "-o", "default.exr"]].concat();
    let run = Run::of(&mut bench.command_as_typed("gather", &typed));
    assert_eq!(run.code(), Some(0), "{}", run.stderr);
    let command = run.stderr.split("to keep that for all cameras: ").nth(1).and_then(|rest| rest.lines().next());
    let mut shell = std::process::Command::new("/bin/sh");
    shell.args(["-c", command.expect("it says the command")]).current_dir(bench.folder());
    let programs = program("calibrate").parent().expect("a folder").to_owned();
    let run = Run::of(shell.env("PATH", programs));
    assert_eq!(run.code(), Some(0), "{command:?}: {}", run.stderr);
    bench.succeed("gather", &[&own[..], &["--calibration", "my 'own' slab.calibration", "-o", "kept.exr"]].concat());
    assert!(bench.read("default.exr") == bench.read("kept.exr"));
}

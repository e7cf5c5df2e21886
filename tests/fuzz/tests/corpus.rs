//! Every file of `fuzz/corpus`, and mutations of it, through its target, in a process with bounded memory and time.
//!
//! Planted errors that these tests caught: the section table of a cloud not checked against the length of the file (a
//! panic), the pixels of a Radiance file not checked against it (48 GiB requested), a node of a scene reached twice
//! (endless recursion that takes all memory), a field of view, a coefficient and a limit without a range.

use fuzz_targets::TARGETS;
use std::path::{Path, PathBuf};
use test_support::{Bench, Limits, Run};

/// Number of mutations of each file.
const MUTATIONS: u64 = 400;

/// Limits of one target: the largest valid images fit, the memory that a corrupted length requests does not.
const LIMITS: Limits = Limits { kibibytes: 2 << 20, seconds: 60 };

fn corpus(target: &str) -> Vec<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../fuzz/corpus").join(target);
    let mut files: Vec<PathBuf> = folder.read_dir().unwrap().map(|entry| entry.unwrap().path()).collect();
    files.sort();
    files
}

/// Runs the corpus of a target; returns how many cases were accepted, and of how many.
#[track_caller]
fn run(target: &str) -> [u64; 2] {
    let files = corpus(target);
    let files = files.iter().map(|path| path.to_str().expect("a name in UTF-8"));
    let mutations = MUTATIONS.to_string();
    let arguments: Vec<&str> = [target, &mutations].into_iter().chain(files).collect();
    let Run { status, stdout, stderr } = Bench::new().run_within(LIMITS, "replay", &arguments);
    let last = stdout.lines().last().unwrap_or_default();
    assert!(status.success(), "{target}: {last}: {status}\n{stderr}");
    let counts = last.strip_prefix("accepted ").and_then(|counts| counts.split_once(" of ")).unwrap();
    [counts.0, counts.1].map(|n| n.parse().unwrap())
}

/// Both outcomes must occur, or the files test little.
#[track_caller]
fn assert_kept(target: &str) {
    let [accepted, cases] = run(target);
    assert!(20 * accepted > cases && 10 * accepted < 9 * cases, "{accepted} of {cases} accepted");
}

#[test]
fn facts() {
    assert_kept("facts");
}

#[test]
fn calibrations() {
    assert_kept("calibration");
}

#[test]
fn clouds() {
    assert_kept("cloud");
}

#[test]
fn scenes() {
    assert_kept("gltf");
}

#[test]
fn images() {
    assert_kept("image");
}

#[test]
fn limits() {
    assert_kept("limits");
}

#[test]
fn media() {
    assert_kept("medium");
}

#[test]
fn views() {
    assert_kept("view");
}

#[test]
fn every_target_has_a_program_and_files_that_are_small() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../fuzz");
    for (name, _) in TARGETS {
        let program = std::fs::read_to_string(folder.join(format!("targets/{name}.rs"))).unwrap();
        assert!(program.contains(&format!("fuzz_targets::{name}(bytes)")), "{program}");
        let sizes = corpus(name).into_iter().map(|path| path.metadata().unwrap().len());
        assert!(sizes.clone().count() > 3 && sizes.sum::<u64>() < 1 << 16, "{name}");
    }
}

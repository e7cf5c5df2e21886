//! Every file of `fuzz/corpus`, and damage to it, through its target, in a process whose memory and time are bounded.
//!
//! Planted errors that these tests caught: the section table of a cloud not held against the file's length (a panic),
//! the pixels of a Radiance picture not held against it (48 GiB asked for), a node of a scene reached twice (an endless
//! walk that takes all memory), a field of view, a coefficient and a limit without their range.

use fuzz_targets::TARGETS;
use std::{
    path::{Path, PathBuf},
    process::{Command, Output},
};

/// Of each file.
const MUTATIONS: u64 = 400;

/// KiB of address space: pictures of the most texels fit, what a damaged length asks for does not.
const MEMORY: u64 = 2 << 20;
/// Seconds of processor time for one target.
const TIME: u64 = 60;

fn replay(target: &str, mutations: u64, files: &[PathBuf]) -> Output {
    // A shell sets the limits. Systems without one of them run the test without it.
    let script = format!("ulimit -v {MEMORY}; ulimit -t {TIME}; exec \"$0\" \"$@\"");
    let mut command = Command::new("sh");
    command.args(["-c", &script, env!("CARGO_BIN_EXE_replay"), target, &mutations.to_string()]).args(files);
    command.output().expect("a shell")
}

fn corpus(target: &str) -> Vec<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../fuzz/corpus").join(target);
    let mut files: Vec<PathBuf> = folder.read_dir().unwrap().map(|entry| entry.unwrap().path()).collect();
    files.sort();
    files
}

/// Runs the corpus of a target; returns how many cases were accepted, and of how many.
#[track_caller]
fn run(target: &str) -> [u64; 2] {
    let output = replay(target, MUTATIONS, &corpus(target));
    let said = String::from_utf8_lossy(&output.stdout);
    let last = said.lines().last().unwrap_or_default();
    let complaint = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{target}: {last}: {}\n{complaint}", output.status);
    let counts = last.strip_prefix("accepted ").and_then(|counts| counts.split_once(" of ")).unwrap();
    [counts.0, counts.1].map(|n| n.parse().unwrap())
}

/// Both outcomes must be there, or the files test little.
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

//! Runs the scripts that docs/ci.md gives for a CI.
#![cfg(unix)]

use std::env;
use std::fs;
use std::path::Path;
use std::process::{Command, Output};
use std::thread::sleep;
use std::time::Duration;

use formats::image::{Channel, Image};

const PAGE: &str = include_str!("../../../docs/ci.md");

/// A folder with the limits, the reference `a` and an equal image.
fn folder() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    fs::create_dir(folder.path().join("references")).unwrap();
    fs::create_dir(folder.path().join("out")).unwrap();
    let limits = r#"{"schema": 1, "limits": [{"gate": "max-abs", "limit": 0.1, "reason": "of this test"}]}"#;
    fs::write(folder.path().join("references/limits.json"), limits).unwrap();
    write(folder.path(), "references/a.exr", 0.5);
    write(folder.path(), "out/a.exr", 0.5);
    folder
}

/// Writes an image of 8 x 4 gray pixels, so much later than the files before it that their times differ in any file system.
fn write(folder: &Path, name: &str, gray: f32) {
    sleep(Duration::from_millis(20));
    let channels = ["R", "G", "B"].iter().map(|name| Channel { name: (*name).to_owned(), samples: vec![gray; 32] });
    let image = Image { width: 8, height: 4, channels: channels.collect(), ..Image::default() };
    fs::write(folder.join(name), image.encode().unwrap()).unwrap();
}

/// Runs a program in the folder, in an environment where it finds `compare` and nothing else is set.
fn run(folder: &Path, program: &str, arguments: &[&str]) -> Output {
    let compare = Path::new(env!("CARGO_BIN_EXE_compare")).parent().unwrap();
    let path = env::var_os("PATH").unwrap_or_default();
    let paths = [compare.to_owned()].into_iter().chain(env::split_paths(&path));
    let mut command = Command::new(program);
    command.current_dir(folder).env_clear().env("PATH", env::join_paths(paths).unwrap());
    command.args(arguments).output().unwrap()
}

/// Runs the step of GitHub Actions like GitHub.
fn step(folder: &Path) -> Output {
    let (_, step) = PAGE.split_once("- name: compare\n").unwrap();
    let (_, script) = step.split_once("run: |\n").unwrap();
    let indent = script.len() - script.trim_start().len();
    let lines = script.lines().take_while(|line| line.len() - line.trim_start().len() >= indent);
    fs::write(folder.join("step.sh"), lines.fold(String::new(), |text, line| text + &line[indent..] + "\n")).unwrap();
    run(folder, "bash", &["--noprofile", "--norc", "-eo", "pipefail", "step.sh"])
}

fn make(folder: &Path) -> Output {
    let (_, text) = PAGE.split_once("```make\n").unwrap();
    fs::write(folder.join("compare.mk"), text.split_once("```").unwrap().0).unwrap();
    run(folder, "make", &["-f", "compare.mk"])
}

#[track_caller]
fn ends_with(output: &Output, code: i32) {
    let text = [&output.stdout[..], &output.stderr].concat();
    assert_eq!(output.status.code(), Some(code), "{}", String::from_utf8_lossy(&text));
}

/// Seen to catch: a second run that gives the index itself to `--html-index`, which refuses to write over a report.
#[test]
fn the_step_runs_again_in_the_same_folder() {
    let folder = folder();
    ends_with(&step(folder.path()), 0);
    ends_with(&step(folder.path()), 0);
    write(folder.path(), "references/b.exr", 0.5);
    write(folder.path(), "out/b.exr", 0.75);
    ends_with(&step(folder.path()), 1);
    let index = fs::read_to_string(folder.path().join("out/index.html")).unwrap();
    assert!(index.contains("a.html") && index.contains("b.html"));
}

/// An image that was not rendered has no page. Its exit code 2 is not hidden by the 1 of a later image that differs. Seen to
/// catch: a page of the last run that stays and is listed as new.
#[test]
fn the_step_shows_no_page_of_an_earlier_run() {
    let folder = folder();
    write(folder.path(), "references/b.exr", 0.5);
    write(folder.path(), "out/b.exr", 0.75);
    ends_with(&step(folder.path()), 1);
    fs::remove_file(folder.path().join("out/a.exr")).unwrap();
    ends_with(&step(folder.path()), 2);
    let index = fs::read_to_string(folder.path().join("out/index.html")).unwrap();
    assert!(index.contains("b.html") && !index.contains("a.html"));
}

#[test]
fn the_step_fails_without_references() {
    let folder = folder();
    fs::remove_file(folder.path().join("references/a.exr")).unwrap();
    ends_with(&step(folder.path()), 2);
}

/// Seen to catch: exit code 0 of make because it had nothing to do.
#[test]
fn the_makefile_fails_without_references() {
    let folder = folder();
    fs::remove_file(folder.path().join("references/a.exr")).unwrap();
    let output = make(folder.path());
    ends_with(&output, 2);
    assert!(String::from_utf8_lossy(&output.stderr).contains("nothing would be compared"));
}

/// Seen to catch: the mark of a pass that stays after a later failure.
#[test]
fn the_makefile_judges_new_images_again() {
    let folder = folder();
    let passed = folder.path().join("out/a.ok");
    ends_with(&make(folder.path()), 0);
    ends_with(&make(folder.path()), 0);
    assert!(passed.exists());
    write(folder.path(), "out/a.exr", 0.75);
    ends_with(&make(folder.path()), 2);
    assert!(!passed.exists());
    write(folder.path(), "out/a.exr", 0.5);
    ends_with(&make(folder.path()), 0);
}

#[test]
fn the_three_lines_pass_and_fail() {
    let (_, text) = PAGE.split_once("## In three lines\n\n").unwrap();
    let script = format!("name=a\n{}", text.split_once("\n\n").unwrap().0);
    let folder = folder();
    ends_with(&run(folder.path(), "bash", &["-ec", &script]), 0);
    write(folder.path(), "out/a.exr", 0.75);
    ends_with(&run(folder.path(), "bash", &["-ec", &script]), 1);
}

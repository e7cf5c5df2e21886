//! Runs the scripts that docs/ci.md gives for a CI.

use std::env;
use std::fs;
use std::process::Command;
use std::thread::sleep;
use std::time::Duration;

use test_support::{Bench, Run, program};

use crate::support::flat;

const PAGE: &str = include_str!("../../../../docs/ci.md");

/// A bench with the limits, the reference `a` and an equal image.
fn bench() -> Bench {
    let bench = Bench::new();
    let limits = r#"{"schema": 1, "limits": [{"gate": "max-abs", "limit": 0.1, "reason": "of this test"}]}"#;
    bench.write("references/limits.json", limits);
    write(&bench, "references/a.exr", 0.5);
    write(&bench, "out/a.exr", 0.5);
    bench
}

/// Writes a gray image so much later than the files before it that their times differ in any file system.
fn write(bench: &Bench, name: &str, gray: f32) {
    sleep(Duration::from_millis(20));
    bench.write_image(name, &flat([gray; 3]));
}

/// Runs a program in the folder, in an environment where it finds `compare` and nothing else is set.
fn run(bench: &Bench, name: &str, arguments: &[&str]) -> Run {
    let compare = program("compare").parent().unwrap().to_owned();
    let path = env::var_os("PATH").unwrap_or_default();
    let paths = [compare].into_iter().chain(env::split_paths(&path));
    let mut command = Command::new(name);
    command.current_dir(bench.folder()).env_clear().env("PATH", env::join_paths(paths).unwrap());
    Run::of(command.args(arguments))
}

/// Runs the step of GitHub Actions like GitHub.
fn step(bench: &Bench) -> Run {
    let (_, step) = PAGE.split_once("- name: compare\n").unwrap();
    let (_, script) = step.split_once("run: |\n").unwrap();
    let indent = script.len() - script.trim_start().len();
    let lines = script.lines().take_while(|line| line.len() - line.trim_start().len() >= indent);
    bench.write("step.sh", lines.fold(String::new(), |text, line| text + &line[indent..] + "\n"));
    run(bench, "bash", &["--noprofile", "--norc", "-eo", "pipefail", "step.sh"])
}

fn make(bench: &Bench) -> Run {
    let (_, text) = PAGE.split_once("```make\n").unwrap();
    bench.write("compare.mk", text.split_once("```").unwrap().0);
    run(bench, "make", &["-f", "compare.mk"])
}

#[track_caller]
fn ends_with(run: &Run, code: i32) {
    assert_eq!(run.code(), Some(code), "{}{}", run.stdout, run.stderr);
}

/// Seen to catch: a second run that gives the index itself to `--html-index`, which refuses to write over a report.
#[test]
fn the_step_runs_again_in_the_same_folder() {
    let bench = bench();
    ends_with(&step(&bench), 0);
    ends_with(&step(&bench), 0);
    write(&bench, "references/b.exr", 0.5);
    write(&bench, "out/b.exr", 0.75);
    ends_with(&step(&bench), 1);
    let index = fs::read_to_string(bench.path("out/index.html")).unwrap();
    assert!(index.contains("a.html") && index.contains("b.html"));
}

/// An image that was not rendered has no page. Its exit code 2 is not hidden by the 1 of a later image that differs.
/// Seen to catch: a page of the last run that stays and is listed as new.
#[test]
fn the_step_shows_no_page_of_an_earlier_run() {
    let bench = bench();
    write(&bench, "references/b.exr", 0.5);
    write(&bench, "out/b.exr", 0.75);
    ends_with(&step(&bench), 1);
    fs::remove_file(bench.path("out/a.exr")).unwrap();
    ends_with(&step(&bench), 2);
    let index = fs::read_to_string(bench.path("out/index.html")).unwrap();
    assert!(index.contains("b.html") && !index.contains("a.html"));
}

#[test]
fn the_step_fails_without_references() {
    let bench = bench();
    fs::remove_file(bench.path("references/a.exr")).unwrap();
    ends_with(&step(&bench), 2);
}

/// Seen to catch: exit code 0 of make because it had nothing to do.
#[test]
fn the_makefile_fails_without_references() {
    let bench = bench();
    fs::remove_file(bench.path("references/a.exr")).unwrap();
    let output = make(&bench);
    ends_with(&output, 2);
    assert!(output.stderr.contains("nothing would be compared"));
}

/// Seen to catch: the mark of a pass that stays after a later failure.
#[test]
fn the_makefile_judges_new_images_again() {
    let bench = bench();
    let passed = bench.path("out/a.ok");
    ends_with(&make(&bench), 0);
    ends_with(&make(&bench), 0);
    assert!(passed.exists());
    write(&bench, "out/a.exr", 0.75);
    ends_with(&make(&bench), 2);
    assert!(!passed.exists());
    write(&bench, "out/a.exr", 0.5);
    ends_with(&make(&bench), 0);
}

#[test]
fn the_three_lines_pass_and_fail() {
    let (_, text) = PAGE.split_once("## In three lines\n\n").unwrap();
    let script = format!("name=a\n{}", text.split_once("\n\n").unwrap().0);
    let bench = bench();
    ends_with(&run(&bench, "bash", &["-ec", &script]), 0);
    write(&bench, "out/a.exr", 0.75);
    ends_with(&run(&bench, "bash", &["-ec", &script]), 1);
}

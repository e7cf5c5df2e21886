//! Tests of `--accept`: what is copied, what is logged, what is refused.
//!
//! Seen to catch: the log overwritten, means of old and new exchanged, an image accepted that is not finite, the exit
//! code of the verdict, the image encoded again instead of copied.

use std::fs;
use std::process::Command;

use formats::image::Image;

use crate::support::{Compare, Verdict, bench, documented, key_paths, picture, scale};
use test_support::{Bench, Run};

const ACCEPT: [&str; 3] = ["--accept", "--reason", "a lamp was \"too\" dark\n"];

fn accept(bench: &Bench, change: impl FnOnce(&mut Image), options: &[&str]) -> Run {
    bench.compare(change, &[&ACCEPT[..], options].concat())
}

fn log(bench: &Bench) -> Vec<serde_json::Value> {
    let text = fs::read_to_string(bench.path("reference.exr.log")).unwrap_or_default();
    assert!(text.is_empty() || text.ends_with('\n'));
    text.lines().map(|line| serde_json::from_str(line).unwrap()).collect()
}

#[test]
fn the_reference_becomes_the_test_image_byte_by_byte() {
    let bench = bench();
    let before = bench.read("reference.exr");
    let mut text = bench.path("reference.exr").into_os_string();
    text.push(".log");
    // A last line of the log that was cut off is kept.
    fs::write(&text, "{}").unwrap();
    let run = accept(&bench, |image| scale(image, 2.0), &["--max-bias", "0.1"]);
    assert_eq!((run.code(), run.stderr.as_str()), (Some(0), ""), "{}", run.stdout);
    let last: Vec<&str> = run.stdout.lines().rev().take(2).collect();
    assert!(last[0].starts_with("ACCEPTED ") && last[1].starts_with("FAIL max-bias 1 > 0.1"), "{}", run.stdout);
    let after = bench.read("reference.exr");
    assert_eq!(after, bench.read("test.exr"));
    let lines = log(&bench);
    assert_eq!(lines.len(), 2);
    let line = &lines[1];
    assert_eq!((&line["reason"], &line["verdict"]), (&ACCEPT[2].into(), &last[1].into()));
    let digest = |bytes: &[u8]| serde_json::Value::from(blake3::hash(bytes).to_hex().to_string());
    assert_eq!((&line["old"], &line["new"]), (&digest(&before), &digest(&after)));
    let red = &line["metrics"][0];
    assert_eq!((&red["layer"], &red["channel"], &red["bias"]), (&"beauty".into(), &"R".into(), &1.0.into()));
    assert_eq!(red["mean_new"].as_f64().unwrap(), 2.0 * red["mean_old"].as_f64().unwrap());
    assert_eq!(key_paths(&documented("<!-- log -->")), key_paths(line));
}

#[test]
fn an_equal_image_is_not_logged() {
    let bench = bench();
    let run = accept(&bench, |_| (), &[]);
    assert_eq!(run.code(), Some(0));
    assert!(run.verdict().starts_with("UNCHANGED "), "{}", run.stdout);
    assert!(!bench.path("reference.exr.log").exists());
}

#[test]
fn the_time_is_that_of_source_date_epoch() {
    let bench = bench();
    bench.compare(|image| scale(image, 2.0), &[]);
    let with = |epoch: &str| {
        Run::of(
            Command::new(env!("CARGO_BIN_EXE_compare"))
                .args([bench.path("reference.exr"), bench.path("test.exr")])
                .args(ACCEPT)
                .env("SOURCE_DATE_EPOCH", epoch),
        )
    };
    with("tomorrow").cannot_judge(&["SOURCE_DATE_EPOCH"]);
    assert!(log(&bench).is_empty());
    assert_eq!(with("1234").code(), Some(0));
    assert_eq!(log(&bench)[0]["time"], 1234);
}

/// Of many acceptances at the same time, each is logged as a change from the one before it. Seen to catch: lines whose
/// `old` is the `new` of no other, and lost lines.
#[test]
fn acceptances_at_once_are_one_chain() {
    let bench = bench();
    let first = bench.read("reference.exr");
    let start = |number: u8| {
        let mut image = picture();
        scale(&mut image, 2.0 + f32::from(number));
        let name = format!("test{number}.exr");
        bench.write_image(&name, &image);
        let images = [bench.path("reference.exr"), bench.path(&name)];
        let mut command = Command::new(env!("CARGO_BIN_EXE_compare"));
        command.args(images).args(["--accept", "--reason", "why", "--threads", "1", "--quiet"]);
        command.stdout(std::process::Stdio::null()).spawn().unwrap()
    };
    let children: Vec<_> = (0..12).map(start).collect();
    for mut child in children {
        assert!(child.wait().unwrap().success());
    }
    let mut before = blake3::hash(&first).to_hex().to_string();
    let lines = log(&bench);
    assert_eq!(lines.len(), 12);
    for line in lines {
        assert_eq!(line["old"], before);
        before = line["new"].as_str().unwrap().to_owned();
    }
    assert_eq!(before, blake3::hash(&bench.read("reference.exr")).to_hex().to_string());
}

#[test]
fn a_refusal_changes_nothing() {
    let bench = bench();
    let before = bench.read("reference.exr");
    let unchanged = || {
        assert_eq!(bench.read("reference.exr"), before);
        assert!(!bench.path("reference.exr.log").exists());
    };
    let hole = |image: &mut Image| image.channels[4].samples[0] = f32::INFINITY;
    accept(&bench, hole, &[]).cannot_judge(&["is not accepted", "1 samples are not finite"]);
    unchanged();
    accept(&bench, |image| image.window = [1, 0], &["--ignore-meta"]).cannot_judge(&["data window"]);
    unchanged();
    accept(&bench, |image| scale(image, 2.0), &["--json", bench.path("no/r.json").to_str().unwrap()])
        .cannot_judge(&["no/r.json"]);
    unchanged();
    bench.judge("reference.exr", &ACCEPT).cannot_judge(&["by itself"]);
    for wrong in [&["--accept"][..], &["--accept", "--reason", " "], &["--reason", "why"]] {
        assert_eq!(bench.compare(|image| scale(image, 2.0), wrong).code(), Some(2));
        unchanged();
    }
    // If the log cannot be written, the reference is not replaced.
    fs::create_dir(bench.path("reference.exr.log")).unwrap();
    accept(&bench, |image| scale(image, 2.0), &[]).cannot_judge(&["reference.exr.log"]);
    assert_eq!(bench.read("reference.exr"), before);
    fs::remove_dir(bench.path("reference.exr.log")).unwrap();
    assert_eq!(accept(&bench, hole, &["--allow-nonfinite"]).code(), Some(0));
    assert_eq!(log(&bench).len(), 1);
}

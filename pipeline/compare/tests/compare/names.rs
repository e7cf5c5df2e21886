//! Tests of names that come from files. On a terminal they are text, never a command or a second line of the verdict.
//!
//! Seen to catch: a channel whose name ends the verdict and begins another, `PASS`; escape sequences.

use formats::image::{Attribute, Image};

use crate::support::{Compare, bench, picture};
use test_support::Run;

/// Whether a text holds nothing that a terminal obeys or that ends a line.
fn is_text(text: &str) -> bool {
    text.lines().all(|line| !line.chars().any(char::is_control)) && !text.contains(['\u{202e}', '\u{2028}'])
}

#[track_caller]
fn says_text(run: &Run, lines: usize) {
    assert!(is_text(&run.stdout) && is_text(&run.stderr), "{:?} {:?}", run.stdout, run.stderr);
    assert_eq!((run.stdout.lines().count(), run.stderr.lines().count()), (lines, 0), "{}", run.stdout);
}

const EVIL: &str = "a\nPASS\u{1b}[2J\u{202e}\u{2028}";

#[test]
fn names_of_channels_are_text() {
    let bench = bench();
    let rename = |image: &mut Image| {
        image.channels[3].name = format!("{EVIL}.Z{EVIL}");
        image.attributes.insert("pcsss/cloud".to_owned(), Attribute::Text(EVIL.to_owned()));
    };
    let mut image = picture();
    rename(&mut image);
    image.attributes.insert("pcsss/cloud".to_owned(), Attribute::Text("other".to_owned()));
    bench.write_image("reference.exr", &image);
    let json = bench.path("report.json");
    let judge = |change: f32, options: &[&str]| {
        let change = |image: &mut Image| {
            rename(image);
            image.channels[3].samples[0] += change;
        };
        bench.compare(change, &[&["--ignore-meta", "--json", json.to_str().unwrap()], options].concat())
    };
    says_text(&judge(2.0, &["--quiet"]), 1);
    says_text(&judge(2.0, &["--max-abs", "1", "--layer", "all", "--quiet"]), 1);
    assert_eq!(bench.json("report.json")["gates"][2]["layer"], EVIL);
    let table = judge(2.0, &["--max-abs", "1", "--layer", "all"]);
    assert!(is_text(&table.stdout), "{:?}", table.stdout);
    assert_eq!(table.code(), Some(1));
    assert!(table.stdout.contains("is ignored: other in the reference, a\\nPASS"), "{}", table.stdout);
    let run = judge(0.0, &["--layer", "none"]);
    assert!(is_text(&run.stderr) && run.stderr.lines().count() == 1, "{:?}", run.stderr);
}

#[test]
fn names_of_files_and_reasons_are_text() {
    let bench = bench();
    std::fs::copy(bench.path("reference.exr"), bench.path(EVIL)).unwrap();
    says_text(&bench.judge(EVIL, &["--quiet"]), 1);
    bench.compare(|image| image.channels[0].samples[0] += 1.0, &[]);
    std::fs::rename(bench.path("test.exr"), bench.path(EVIL)).unwrap();
    let limits = bench.path("limits.json");
    let entry = serde_json::json!({ "gate": "max-abs", "limit": 0.5, "reason": EVIL });
    std::fs::write(&limits, serde_json::json!({ "schema": 1, "limits": [entry] }).to_string()).unwrap();
    let run = bench.judge(EVIL, &["--limits", limits.to_str().unwrap()]);
    assert!(run.code() == Some(1) && is_text(&run.stdout), "{:?}", run.stdout);
    says_text(&bench.judge(EVIL, &["--quiet", "--accept", "--reason", "brighter"]), 2);
}

//! Tests of the gates of a limits file. The unit tests of the library test what such a file may hold.
//!
//! Seen to catch: the gates of the file instead of those of the command line, those of the command line instead of
//! those of the file, `--layer` applied to the gates of the file.

use crate::support::{Compare, Verdict, bench, scale};
use test_support::{Bench, Run};

/// Compares an image that is 1 % brighter by these limits.
fn brighter(bench: &Bench, limits: &str, options: &[&str]) -> Run {
    let path = bench.path("limits.json");
    std::fs::write(&path, format!(r#"{{"schema": 1, "limits": [{limits}]}}"#)).unwrap();
    bench.compare(|image| scale(image, 1.01), &[&["--limits", path.to_str().unwrap()], options].concat())
}

const LOOSE: &str = r#"{"gate": "max-bias", "limit": 0.02, "reason": "noise"}"#;
const TIGHT: &str = r#"{"gate": "max-bias", "limit": 0.001, "reason": "energy counts"}"#;

#[test]
fn limits_and_options_must_both_be_held() {
    let bench = bench();
    brighter(&bench, LOOSE, &[]).passes();
    brighter(&bench, LOOSE, &["--max-bias", "0.001"]).fails("max-bias 0.0");
    brighter(&bench, TIGHT, &["--max-bias", "0.02"]).fails("max-bias 0.0");
    brighter(&bench, LOOSE, &["--max-bias", "0.02"]).passes();
}

#[test]
fn a_failed_limit_gives_its_reason() {
    let bench = bench();
    let json = bench.path("report.json");
    let run = brighter(&bench, TIGHT, &["--json", json.to_str().unwrap()]);
    run.fails("max-bias 0.0");
    assert!(run.stdout.contains("max-bias of beauty is limited to 0.001: energy counts"), "{}", run.stdout);
    let gates = &bench.json("report.json")["gates"];
    assert_eq!((&gates[0]["gate"], &gates[0]["reason"]), (&"nonfinite".into(), &serde_json::Value::Null));
    assert_eq!((&gates[1]["limit"], &gates[1]["ok"]), (&0.001.into(), &false.into()));
    assert_eq!(gates[1]["reason"], "energy counts");
}

#[test]
fn limits_keep_their_layer() {
    let bench = bench();
    let on = |layer: &str| format!(r#"{{"gate": "max-bias", "limit": 0.001, "layer": "{layer}", "reason": "depth"}}"#);
    brighter(&bench, &on("Z"), &[]).fails("max-bias 0.0");
    assert!(brighter(&bench, &on("Z"), &["--layer", "variance"]).verdict().ends_with("(Z Z)"));
    let all = brighter(&bench, &on("all"), &[]);
    assert_eq!(all.verdict().matches("max-bias").count(), 3, "{}", all.verdict());
    brighter(&bench, &on("diffuse"), &[]).cannot_judge(&["`diffuse`", "beauty, Z, variance", "limits file"]);
    brighter(&bench, &format!("{}, {}", on("Z"), on("Z")), &[]).cannot_judge(&["limits.json", "limit 2", "twice"]);
}

/// Seen to catch: the mark refused, though other JSON files are read with it.
#[test]
fn a_byte_order_mark_is_no_fault() {
    let bench = bench();
    let path = bench.path("limits.json");
    std::fs::write(&path, format!("\u{feff}{{\"schema\": 1, \"limits\": [{LOOSE}]}}")).unwrap();
    bench.compare(|image| scale(image, 1.01), &["--limits", path.to_str().unwrap()]).passes();
}

#[test]
fn a_limits_file_that_cannot_be_used_is_named() {
    let bench = bench();
    brighter(&bench, r#"{"gate": "max-bias", "limit": 1e999, "reason": "r"}"#, &[])
        .cannot_judge(&["limits.json", "out of range"]);
    let run = |path: &str| bench.compare(|_| (), &["--limits", path]);
    run("no/limits.json").cannot_judge(&["no/limits.json", "the limits cannot be read"]);
    run(bench.folder().to_str().unwrap()).cannot_judge(&["not a regular file"]);
    let long = bench.path("long.json");
    std::fs::write(&long, " ".repeat((1 << 20) + 1)).unwrap();
    run(long.to_str().unwrap()).cannot_judge(&["longer than 1 MiB"]);
}

//! Tests of the verdict and of the JSON report.

use formats::image::Image;

use crate::support::{Compare, HEIGHT, Verdict, WIDTH, bench, documented, key_paths, scale};

#[test]
fn quiet_prints_the_verdict_alone() {
    let bench = bench();
    let run = bench.compare(|_| (), &["--quiet"]);
    run.passes();
    assert_eq!(run.stdout.lines().count(), 1);
    assert!(bench.compare(|_| (), &[]).stdout.contains("relMSE"));
}

#[test]
fn output_is_the_same_for_any_number_of_threads() {
    let bench = bench();
    let brighter = |image: &mut Image| scale(image, 1.37);
    let json = bench.path("report.json").display().to_string();
    let run = |threads: &str| {
        let run = bench.compare(
            brighter,
            &["--max-abs", "9", "--json", &json, "-j", threads, "--seed", "3", "--progress", "none"],
        );
        run.passes();
        (run.stdout, std::fs::read(&json).unwrap())
    };
    assert_eq!(run("1"), run("5"));
}

#[test]
fn json_holds_metrics_and_gates_also_on_failure() {
    let bench = bench();
    let json = bench.path("report.json");
    let change = |image: &mut Image| image.channels[0].samples[WIDTH] += 2.0;
    let options = ["--max-abs", "1", "--max-outliers", "2@1.5", "--json", json.to_str().unwrap()];
    bench.compare(change, &options).fails("max-abs 2 > 1 (beauty R)");
    let report = bench.json("report.json");
    assert_eq!(report["schema"], 1);
    assert_eq!(report["pass"], false);
    assert_eq!(report["verdict"], "FAIL max-abs 2 > 1 (beauty R)");
    assert_eq!(report["relmse_epsilon"], 0.01);
    assert_eq!(report["nonfinite"]["test"], 0);
    let red = &report["layers"][0]["channels"][0];
    assert_eq!((&red["name"], &red["max"]["error"]), (&"R".into(), &2.0.into()));
    assert_eq!(red["max"]["pixel"], serde_json::json!([0, 1]));
    assert_eq!(red["mae"], 2.0 / (WIDTH * HEIGHT) as f64);
    let gates: Vec<_> = report["gates"].as_array().unwrap().iter().map(|gate| (&gate["gate"], &gate["ok"])).collect();
    let expected = [("nonfinite", true), ("max-abs", false), ("max-outliers", true)];
    assert_eq!(
        gates,
        expected.map(|(gate, ok)| (serde_json::Value::from(gate), ok.into())).each_ref().map(|(a, b)| (a, b))
    );
    assert_eq!((&report["gates"][1]["value"], &report["gates"][1]["limit"]), (&2.0.into(), &1.0.into()));
}

#[test]
fn json_never_replaces_an_image_and_needs_its_folder() {
    let bench = bench();
    let bytes = bench.read("reference.exr");
    let options = |name: &str| ["--json".to_owned(), bench.path(name).display().to_string()];
    let run = |name: &str| bench.compare(|_| (), &options(name).each_ref().map(String::as_str));
    run("reference.exr").cannot_judge(&["reference.exr", "--json"]);
    assert_eq!(bench.read("reference.exr"), bytes);
    run("no/report.json").cannot_judge(&["no"]);
}

/// docs/compare.md shows exactly the keys of the report.
#[test]
fn the_documented_report_has_the_keys_of_a_real_one() {
    let bench = bench();
    let limits = bench.path("limits.json");
    std::fs::write(&limits, documented("## Limits file").to_string().replace("subsurface", "Z")).unwrap();
    let json = bench.path("report.json");
    let options = ["--limits", limits.to_str().unwrap(), "--flip", "--json", json.to_str().unwrap()];
    bench.compare(|image| scale(image, 1.01), &options).fails("max-bias");
    assert_eq!(key_paths(&documented("<!-- report -->")), key_paths(&bench.json("report.json")));
}

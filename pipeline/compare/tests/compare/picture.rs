//! Tests of PSNR, SSIM and FLIP in the program: what is measured, gates, and the same bytes for any number of threads.
//!
//! Seen to catch: FLIP allowed as the only gate, the gate on LDR-FLIP, a difference of zero at a pixel that is not
//! finite, the finiteness of the picture unchecked, sums over one piece for each thread. (The sum of a map of FLIP
//! alone is nearly always exact in float64, and would not show that.)

use formats::image::{Channel, Image};
use serde_json::Value;
use test_support::Bench;

/// The size of the pictures, which is larger than a tile of the metrics.
const SIZE: [usize; 2] = [270, 140];

fn picture(noise: f32) -> Image {
    let light = |i: usize| 0.1 + (i % 61) as f32 / 40.0 + noise * ((i * 7919 % 101) as f32 / 101.0 - 0.5);
    let channel = |(shift, name): (usize, &str)| {
        let samples = (0..SIZE[0] * SIZE[1]).map(|i| light(i + 17 * shift)).collect();
        Channel { name: name.to_owned(), samples }
    };
    let channels = ["B", "G", "R"].into_iter().enumerate().map(channel).collect();
    Image { width: SIZE[0], height: SIZE[1], channels, ..Image::default() }
}

/// Compares with the picture without noise, and returns exit code, stdout, stderr and the report if there is one.
fn compare(bench: &Bench, test: &Image, options: &[&str]) -> (Option<i32>, String, String, Value) {
    bench.write_image("reference.exr", &picture(0.0));
    bench.write_image("test.exr", test);
    let report = bench.path("report.json");
    std::fs::remove_file(&report).ok();
    let files = ["reference.exr", "test.exr", "--json", "report.json"];
    let run = bench.run("compare", &[&files, options].concat());
    let code = run.code();
    (code, run.stdout, run.stderr, if report.exists() { bench.json("report.json") } else { Value::Null })
}

#[test]
fn flip_is_measured_when_asked_for() {
    let bench = Bench::new();
    let (code, stdout, _, json) = compare(&bench, &picture(0.1), &[]);
    assert_eq!(code, Some(0));
    assert!(stdout.contains("PSNR") && stdout.contains("SSIM") && !stdout.contains("-FLIP"), "{stdout}");
    assert!(json["picture"]["psnr"].as_f64() > Some(10.0) && json["picture"]["ssim"].as_f64() < Some(1.0));
    assert!(json["picture"]["flip_hdr"].is_null() && json["picture"]["missing"][0] == "flip: not asked for");
    let (_, stdout, _, json) = compare(&bench, &picture(0.1), &["--flip"]);
    assert!(stdout.contains("LDR-FLIP mean 0.") && stdout.contains("HDR-FLIP mean 0."), "{stdout}");
    for key in ["mean", "median", "p99", "max"] {
        assert!(json["picture"]["flip_ldr"][key].as_f64() > Some(0.0), "{json}");
        assert!(json["picture"]["flip_hdr"][key].as_f64() > Some(0.0), "{json}");
    }
    assert!(json["picture"]["flip_hdr"]["exposures"]["count"].as_u64() >= Some(2));
}

#[test]
fn flip_judges_beside_another_gate_only() {
    let bench = Bench::new();
    let run = |noise, options: &[&str]| compare(&bench, &picture(noise), options);
    let (code, stdout, stderr, _) = run(0.0, &["--max-flip", "0.5"]);
    assert_eq!((code, stdout.as_str(), stderr.lines().count()), (Some(2), "", 1), "{stderr}");
    assert!(["--max-flip", "misses", "--max-bias"].iter().all(|word| stderr.contains(word)), "{stderr}");
    assert_eq!(run(0.0, &["--max-flip", "0", "--max-bias", "0"]).0, Some(0));
    // The same holds for a limits file.
    let text = r#"{"schema": 1, "limits": [{"gate": "max-flip", "limit": 0.5, "reason": "seen"}]}"#;
    bench.write("limits.json", text);
    assert_eq!(run(0.0, &["--limits", "limits.json"]).0, Some(2));
    assert_eq!(run(0.0, &["--limits", "limits.json", "--max-abs", "0"]).0, Some(0));
    let beside = ["--max-flip", "0.001", "--max-bias", "1", "--layer", "all"];
    let (code, stdout, _, json) = run(0.3, &beside);
    assert_eq!(code, Some(1));
    assert!(stdout.lines().last().unwrap().starts_with("FAIL max-flip 0."), "{stdout}");
    let judged = json["gates"].as_array().unwrap().iter().find(|gate| gate["gate"] == "max-flip").unwrap();
    assert_eq!(judged["value"], json["picture"]["flip_hdr"]["mean"]);
}

#[test]
fn a_picture_that_is_not_finite_never_passes_flip() {
    let bench = Bench::new();
    let mut test = picture(0.0);
    test.channels[0].samples[300] = f32::NAN;
    let options = ["--max-flip", "1", "--max-outliers", "1@0", "--allow-nonfinite"];
    let (code, stdout, _, json) = compare(&bench, &test, &options);
    assert_eq!(code, Some(1));
    assert!(stdout.contains("FAIL max-flip NaN > 1"), "{stdout}");
    assert!(json["picture"]["psnr"].is_null() && json["picture"]["flip_hdr"]["mean"].is_null());
}

#[test]
fn reports_are_the_same_for_any_number_of_threads() {
    let bench = Bench::new();
    let run = |threads: &str| {
        let (_, stdout, _, json) = compare(&bench, &picture(0.2), &["--flip", "--threads", threads]);
        (stdout, json)
    };
    let one = run("1");
    for threads in ["2", "3", "7"] {
        assert_eq!(run(threads), one, "{threads}");
    }
}

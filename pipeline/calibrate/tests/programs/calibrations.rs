//! The file, and what is said of it.

use crate::{bench, quick, slab};
use std::fs;

#[test]
fn a_calibration_has_the_same_bytes_for_any_number_of_threads() {
    let (bench, slab) = (bench(), slab());
    for (name, more) in [("one", ["-j", "1"]), ("two", ["-j", "2"]), ("other", ["--seed", "1"])] {
        bench.succeed("calibrate", &quick(&slab, name, &more));
    }
    assert!(bench.read("one") == bench.read("two"));
    assert!(bench.read("one") != bench.read("other"));
}

/// Two lines of progress where there is no terminal, then the errors of each channel; nothing with `--quiet`.
#[test]
fn the_errors_are_said_and_written() {
    let (bench, slab) = (bench(), slab());
    let run = bench.run("calibrate", &quick(&slab, "a.calibration", &["--stats", "a.json"]));
    assert_eq!((run.code(), run.stdout.as_str()), (Some(0), ""));
    let lines: Vec<&str> = run.stderr.lines().collect();
    let [start, end, material, channels @ ..] = &lines[..] else { panic!("{lines:?}") };
    assert!(start.starts_with("calibrating: ") && end.starts_with("calibrating: done in "), "{lines:?}");
    assert!(material.contains("`Slab`: marble") && channels.len() == 3, "{lines:?}");
    for (line, channel) in channels.iter().zip(["red", "green", "blue"]) {
        assert!(line.contains(channel) && line.contains("off by relMSE") && line.contains("+-"), "{line}");
    }
    let stats = bench.json("a.json");
    let keys = "schema threads calibration cloud bssrdf walks materials seconds peak_memory_bytes";
    keys.split_whitespace().for_each(|key| assert!(!stats[key].is_null(), "{key}"));
    assert_eq!((stats["bssrdf"].as_str(), stats["walks"].as_u64()), (Some("half-space"), Some(600)));
    let material = &stats["materials"][0];
    assert_eq!(material["patches"].as_u64(), Some(64), "few walks serve few patches");
    for key in ["error_before", "error_after", "error_uncertainty", "unresolved_share", "exit_lobe"] {
        assert_eq!(material[key].as_array().map(Vec::len), Some(3), "{key}");
    }
    let quiet = bench.run("calibrate", &quick(&slab, "a.calibration", &["--quiet"]));
    assert_eq!((quiet.code(), quiet.stdout + &quiet.stderr), (Some(0), String::new()));
}

/// A medium that does not scatter has nothing to calibrate, which is said in place of an error of zero.
#[test]
fn a_clear_medium_has_no_error() {
    let (bench, slab) = (bench(), slab());
    bench.write("clear.json", r#"{"name":"clear","unit":"1/mm","sigma_a":[0.1,0,0],"sigma_s":[0,0,0],"source":"-"}"#);
    let own = ["slab.cloud", &slab, "--medium", "clear.json", "--walks", "600", "-o", "a.calibration"];
    let said = bench.says("calibrate", &own);
    assert!(said.matches("no scattered light leaves").count() == 3 && !said.contains("relMSE"), "{said}");
}

/// Shards and seeds are calibrated as one cloud, whatever their order.
#[test]
fn shards_are_one_cloud() {
    let (bench, slab) = (bench(), slab());
    bench.succeed("sample-surface", &[&slab, "-n", "2k", "--seed", "5", "-o", "more.cloud", "--quiet"]);
    let own = |first, second, output| {
        [first, second, slab.as_str(), "--medium", "marble", "--walks", "600", "-o", output, "--quiet"]
    };
    bench.succeed("calibrate", &own("slab.cloud", "more.cloud", "a.calibration"));
    bench.succeed("calibrate", &own("more.cloud", "slab.cloud", "b.calibration"));
    assert!(bench.read("a.calibration") == bench.read("b.calibration"));
    bench.succeed("calibrate", &quick(&slab, "c.calibration", &["--quiet"]));
    assert!(fs::read(bench.path("c.calibration")).expect("reads") != bench.read("a.calibration"));
}

/// `--help` states the unit of lengths and radiance, and the default of every option that has one.
#[test]
fn help_states_units_and_defaults() {
    let help = bench().succeed("calibrate", &["--help"]);
    for words in ["metres", "W/(m² sr)", "[default: 300k]", "[default: half-space]", "[default: the media that SCENE"]
    {
        assert!(help.contains(words), "{words}: {help}");
    }
}

//! Tests of `compare --html` and `--html-index` as programs.
//!
//! Seen to catch: the page written only on success, no guard of the inputs, links from the working folder instead of
//! that of the index, a relMSE that is not finite counted as zero.

use test_support::{Bench, Run};

use crate::support::flat;

/// A bench with the gray picture `reference.exr`.
fn bench() -> Bench {
    let bench = Bench::new();
    bench.write_image("reference.exr", &flat([1.0; 3]));
    bench
}

/// Compares a gray picture with the reference, and writes the page of this name.
fn page(bench: &Bench, gray: f32, page: &str, options: &[&str]) -> Option<i32> {
    bench.write_image("test.exr", &flat([gray; 3]));
    bench.run("compare", &[&["reference.exr", "test.exr", "--html", page], options].concat()).code()
}

#[track_caller]
fn refused(run: &Run, words: &[&str]) {
    assert_eq!((run.code(), run.stdout.len()), (Some(2), 0), "{}", run.stderr);
    assert!(words.iter().all(|word| run.stderr.contains(word)), "{}", run.stderr);
}

#[test]
fn a_page_is_written_also_on_failure() {
    let bench = bench();
    assert_eq!(page(&bench, 1.5, "page.html", &["--max-bias", "0.1"]), Some(1));
    let text = std::fs::read_to_string(bench.path("page.html")).unwrap();
    assert!(text.starts_with("<!DOCTYPE html>") && text.ends_with("</html>\n"));
    assert!(text.contains("FAIL max-bias 0.5 > 0.1 (beauty R)"));
    // No other file was written.
    assert_eq!(bench.files().len(), 3);
}

#[test]
fn the_page_is_the_same_for_any_number_of_threads() {
    let bench = bench();
    let bytes = |threads: &str| {
        page(&bench, 1.25, "page.html", &["--threads", threads]);
        bench.read("page.html")
    };
    assert!(bytes("1") == bytes("4"));
}

#[test]
fn inputs_are_never_replaced() {
    let bench = bench();
    let before = bench.read("reference.exr");
    let output = bench.run("compare", &["reference.exr", "reference.exr", "--html", "reference.exr"]);
    refused(&output, &["reference.exr", "--html would replace REFERENCE"]);
    assert_eq!(bench.read("reference.exr"), before);
    page(&bench, 1.0, "page.html", &[]);
    refused(
        &bench.run("compare", &["--html-index", "page.html", "page.html"]),
        &["--html-index would replace REPORT.html"],
    );
}

/// The links of the index in its order.
fn links(index: &std::path::Path) -> Vec<String> {
    let text = std::fs::read_to_string(index).unwrap();
    let links = text.split("\"link\":\"").skip(1);
    links.map(|rest| rest.split('"').next().unwrap().to_owned()).collect()
}

#[test]
fn the_index_begins_with_the_worst() {
    let bench = bench();
    std::fs::create_dir_all(bench.path("pages/far")).unwrap();
    page(&bench, 1.01, "good.html", &["--max-bias", "0.1"]);
    page(&bench, 1.05, "pages/passable.html", &["--max-bias", "0.1"]);
    page(&bench, 1.2, "pages/far/bad.html", &["--max-bias", "0.1"]);
    page(&bench, 1.01, "pages/strict.html", &["--max-bias", "0.001"]);
    page(&bench, f32::NAN, "nan.html", &[]);
    page(&bench, f32::NAN, "pages/allowed.html", &["--allow-nonfinite"]);
    let reports = [
        "good.html",
        "pages/passable.html",
        "pages/far/bad.html",
        "pages/strict.html",
        "nan.html",
        "pages/allowed.html",
    ];
    let output = bench.run("compare", &[&["--quiet", "--html-index", "pages/index.html"], &reports[..]].concat());
    assert_eq!((output.code(), output.stderr.len()), (Some(0), 0), "{output:?}");
    let expected = ["../nan.html", "strict.html", "far/bad.html", "allowed.html", "passable.html", "../good.html"];
    assert_eq!(links(&bench.path("pages/index.html")), expected);
}

#[test]
fn files_that_are_no_reports_have_no_index() {
    let bench = bench();
    page(&bench, 1.0, "page.html", &[]);
    let run = |report: &str| bench.run("compare", &["--html-index", "index.html", report]);
    refused(&run("reference.exr"), &["reference.exr", "not an HTML report of compare"]);
    refused(&run("missing.html"), &["missing.html"]);
    refused(&run("."), &["not a regular file"]);
    let text = std::fs::read_to_string(bench.path("page.html")).unwrap();
    bench.write("other.html", text.replace("\"verdict\"", "\"other\""));
    refused(&run("other.html"), &["other.html", "not an HTML report of compare"]);
    refused(&bench.run("compare", &["--html-index", "no/index.html", "page.html"]), &["no/index.html"]);
    assert!(!bench.path("index.html").exists());
}

//! Tests of `compare --html` and `--html-index` as programs.
//!
//! Seen to catch: the page written only on success, no guard of the inputs, links from the working folder instead of that of the
//! index, a relMSE that is not finite counted as zero.

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use formats::image::{Channel, Image};

/// A folder with the gray picture `reference.exr`.
fn folder() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    write(folder.path(), "reference.exr", &[1.0; 3]);
    folder
}

/// Writes an image of 8 x 4 pixels with these values in R, G and B.
fn write(folder: &Path, name: &str, color: &[f32; 3]) {
    let channels = ["R", "G", "B"].iter().zip(color);
    let channels = channels.map(|(name, value)| Channel { name: (*name).to_owned(), samples: vec![*value; 32] });
    let image = Image { width: 8, height: 4, channels: channels.collect(), ..Image::default() };
    std::fs::write(folder.join(name), image.encode().unwrap()).unwrap();
}

fn compare(folder: &Path, arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_compare")).current_dir(folder).args(arguments).output().unwrap()
}

/// Compares a gray picture with the reference, and writes the page of this name.
fn page(folder: &Path, gray: f32, page: &str, options: &[&str]) -> Option<i32> {
    write(folder, "test.exr", &[gray; 3]);
    compare(folder, &[&["reference.exr", "test.exr", "--html", page], options].concat()).status.code()
}

#[track_caller]
fn refused(output: &Output, words: &[&str]) {
    let text = String::from_utf8_lossy(&output.stderr);
    assert_eq!((output.status.code(), output.stdout.len()), (Some(2), 0), "{text}");
    assert!(words.iter().all(|word| text.contains(word)), "{text}");
}

#[test]
fn a_page_is_written_also_on_failure() {
    let folder = folder();
    assert_eq!(page(folder.path(), 1.5, "page.html", &["--max-bias", "0.1"]), Some(1));
    let text = std::fs::read_to_string(folder.path().join("page.html")).unwrap();
    assert!(text.starts_with("<!DOCTYPE html>") && text.ends_with("</html>\n"));
    assert!(text.contains("FAIL max-bias 0.5 > 0.1 (beauty R)"));
    // No other file was written.
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 3);
}

#[test]
fn the_page_is_the_same_for_any_number_of_threads() {
    let folder = folder();
    let bytes = |threads: &str| {
        page(folder.path(), 1.25, "page.html", &["--threads", threads]);
        std::fs::read(folder.path().join("page.html")).unwrap()
    };
    assert!(bytes("1") == bytes("4"));
}

#[test]
fn inputs_are_never_replaced() {
    let folder = folder();
    let before = std::fs::read(folder.path().join("reference.exr")).unwrap();
    let output = compare(folder.path(), &["reference.exr", "reference.exr", "--html", "reference.exr"]);
    refused(&output, &["reference.exr", "--html would replace REFERENCE"]);
    assert_eq!(std::fs::read(folder.path().join("reference.exr")).unwrap(), before);
    page(folder.path(), 1.0, "page.html", &[]);
    refused(
        &compare(folder.path(), &["--html-index", "page.html", "page.html"]),
        &["--html-index would replace REPORT.html"],
    );
}

/// The links of the index in its order.
fn links(index: &Path) -> Vec<String> {
    let text = std::fs::read_to_string(index).unwrap();
    let links = text.split("\"link\":\"").skip(1);
    links.map(|rest| rest.split('"').next().unwrap().to_owned()).collect()
}

#[test]
fn the_index_begins_with_the_worst() {
    let folder = folder();
    std::fs::create_dir_all(folder.path().join("pages/far")).unwrap();
    page(folder.path(), 1.01, "good.html", &["--max-bias", "0.1"]);
    page(folder.path(), 1.05, "pages/passable.html", &["--max-bias", "0.1"]);
    page(folder.path(), 1.2, "pages/far/bad.html", &["--max-bias", "0.1"]);
    page(folder.path(), 1.01, "pages/strict.html", &["--max-bias", "0.001"]);
    page(folder.path(), f32::NAN, "nan.html", &[]);
    page(folder.path(), f32::NAN, "pages/allowed.html", &["--allow-nonfinite"]);
    let reports = [
        "good.html",
        "pages/passable.html",
        "pages/far/bad.html",
        "pages/strict.html",
        "nan.html",
        "pages/allowed.html",
    ];
    let output = compare(folder.path(), &[&["--quiet", "--html-index", "pages/index.html"], &reports[..]].concat());
    assert_eq!((output.status.code(), output.stderr.len()), (Some(0), 0), "{output:?}");
    let expected = ["../nan.html", "strict.html", "far/bad.html", "allowed.html", "passable.html", "../good.html"];
    assert_eq!(links(&folder.path().join("pages/index.html")), expected);
}

#[test]
fn files_that_are_no_reports_have_no_index() {
    let folder = folder();
    page(folder.path(), 1.0, "page.html", &[]);
    let run = |report: &str| compare(folder.path(), &["--html-index", "index.html", report]);
    refused(&run("reference.exr"), &["reference.exr", "not an HTML report of compare"]);
    refused(&run("missing.html"), &["missing.html"]);
    refused(&run("."), &["not a regular file"]);
    let text = std::fs::read_to_string(folder.path().join("page.html")).unwrap();
    std::fs::write(folder.path().join("other.html"), text.replace("\"verdict\"", "\"other\"")).unwrap();
    refused(&run("other.html"), &["other.html", "not an HTML report of compare"]);
    refused(&compare(folder.path(), &["--html-index", "no/index.html", "page.html"]), &["no/index.html"]);
    assert!(!PathBuf::from(folder.path()).join("index.html").exists());
}

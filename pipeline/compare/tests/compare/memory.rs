//! Tests that images that do not fit into the memory are refused before they are read.
//!
//! Seen to catch: a run under `ulimit -v` that ended by SIGABRT.

use std::path::Path;
use std::process::Command;

use crate::support::bench;
use test_support::Run;

#[track_caller]
fn refused(arguments: &[&Path], words: &[&str]) {
    let mut limited = Command::new("sh");
    let script = "ulimit -v 800000 && exec \"$0\" \"$@\" --threads 2";
    let run = Run::of(limited.args(["-c", script, env!("CARGO_BIN_EXE_compare")]).args(arguments));
    assert_eq!(run.code(), Some(2), "{}", run.stderr);
    let last = run.stderr.lines().last().unwrap();
    for words in words.iter().chain(&["GiB of memory"]) {
        assert!(last.contains(words), "{last}");
    }
}

/// The header of a small file describes a large image, and the file is long enough for a black image of that size.
#[test]
fn images_that_do_not_fit_are_refused_with_a_sentence() {
    let bench = bench();
    let mut bytes = bench.read("reference.exr");
    let mut set = |attribute: &[u8], offset: usize, value: i32| {
        let end = bytes.windows(attribute.len()).position(|window| window == attribute).unwrap() + attribute.len();
        bytes[end + offset..][..4].copy_from_slice(&value.to_le_bytes());
    };
    set(b"dataWindow\0box2i\0\x10\0\0\0", 8, 11_999);
    set(b"dataWindow\0box2i\0\x10\0\0\0", 12, 11_999);
    // A block has 16 rows.
    set(b"chunkCount\0int\0\x04\0\0\0", 0, 750);
    // With a shorter file, 12000 x 12000 x 5 samples would be refused as impossible.
    bytes.resize(2 << 20, 0);
    bench.write("large.exr", &bytes);
    let image = bench.path("large.exr");
    refused(&[&image, &image], &["large.exr", "12000 x 12000 pixels with 5 channels", "smaller images"]);
    let folder = bench.path("replicates");
    std::fs::create_dir(&folder).unwrap();
    std::fs::rename(&image, folder.join("large.exr")).unwrap();
    let replicates = Path::new("--replicates");
    refused(&[replicates, &folder, &folder], &["large.exr", "12000 x 12000 pixels", "smaller replicates"]);
    refused(&[Path::new("--summarise"), &folder, &bench.path("golden")], &["large.exr", "smaller replicates"]);
}

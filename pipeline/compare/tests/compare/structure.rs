//! Tests of what cannot be judged: images that do not belong together, files that are no images, wrong usage.
//!
//! Seen to catch: no message about a hash of one image alone, `-` taken for a file, a closed stdout taken for a
//! failure.

use std::process::Command;

use formats::image::{Attribute, Channel, Image};

use crate::support::{Compare, Verdict, bench, picture};
use test_support::Run;

#[test]
fn images_of_different_structure_cannot_be_judged() {
    let bench = bench();
    let smaller = Image { width: 1, height: 1, channels: vec![], ..picture() };
    let one = |name: &str| Channel { name: name.to_owned(), samples: vec![1.0] };
    let smaller = Image { channels: ["R", "G", "B", "Z", "variance.R"].map(one).to_vec(), ..smaller };
    bench.compare(|image| *image = smaller, &[]).cannot_judge(&["test.exr", "1 x 1", "24 x 16", "reference.exr"]);
    bench.compare(|image| image.window = [1, 0], &[]).cannot_judge(&["test.exr", "[1, 0]", "[0, 0]"]);
    bench.compare(|image| image.channels[3].name = "depth".to_owned(), &[]).cannot_judge(&["missing: Z", "depth"]);
    let other = |image: &mut Image| {
        image.attributes.insert("pcsss/scene".to_owned(), Attribute::Text("07435".to_owned()));
    };
    bench.compare(other, &[]).cannot_judge(&["pcsss/scene", "07435", "5ce4e", "--ignore-meta"]);
    bench.compare(other, &["--ignore-meta"]).passes();
    bench.compare(|image| image.attributes.clear(), &[]).passes();
}

#[test]
fn files_that_are_no_images_cannot_be_judged() {
    let bench = bench();
    bench.judge("missing.exr", &[]).cannot_judge(&["missing.exr"]);
    bench.write("garbage.exr", "garbage");
    bench.judge("garbage.exr", &[]).cannot_judge(&["garbage.exr", "not an OpenEXR file"]);
    let bytes = bench.read("reference.exr");
    bench.write("half.exr", &bytes[..bytes.len() / 2]);
    bench.judge("half.exr", &[]).cannot_judge(&["half.exr", "truncated"]);
    bench.judge(".", &[]).cannot_judge(&["not a regular file"]);
}

#[test]
fn wrong_usage_cannot_be_judged() {
    let bench = bench();
    for options in
        [&["--max-baas", "1"][..], &["--max-bias", "NaN"], &["--max-abs=-1"], &["--max-outliers", "3"], &["third.exr"]]
    {
        let run = bench.compare(|_| (), options);
        assert_eq!((run.code(), run.stdout.as_str()), (Some(2), ""), "{options:?}");
        assert!(run.stderr.contains(options[0].split('=').next().unwrap()), "{}", run.stderr);
    }
    assert_eq!(Run::of(&mut Command::new(env!("CARGO_BIN_EXE_compare"))).code(), Some(2));
}

/// A hash of one image alone is no fault, but other inputs would not be noticed.
#[test]
fn a_hash_of_one_image_alone_is_reported() {
    let bench = bench();
    let run = bench.compare(|image| image.attributes.clear(), &[]);
    run.passes();
    assert!(run.stdout.contains("pcsss/scene is in the reference only"), "{}", run.stdout);
    let cloud = |image: &mut Image| {
        image.attributes.insert("pcsss/cloud".to_owned(), Attribute::Text("c10".to_owned()));
    };
    assert!(bench.compare(cloud, &[]).stdout.contains("pcsss/cloud is in the test image only"));
    let other = |image: &mut Image| {
        image.attributes.insert("pcsss/scene".to_owned(), Attribute::Text("07435".to_owned()));
    };
    let run = bench.compare(other, &["--ignore-meta"]);
    assert!(run.stdout.contains("pcsss/scene differs and is ignored: 5ce4e in"), "{}", run.stdout);
    assert!(!bench.compare(|_| (), &[]).stdout.contains("pcsss"));
}

#[test]
fn streams_are_no_images() {
    let bench = bench();
    for arguments in [["-", "test.exr"], ["test.exr", "-"]] {
        let run = Run::of(Command::new(env!("CARGO_BIN_EXE_compare")).args(arguments).current_dir(bench.folder()));
        assert_eq!((run.code(), run.stdout.as_str()), (Some(2), ""));
        assert!(run.stderr.contains("streams are not accepted"), "{}", run.stderr);
    }
    assert_eq!(bench.compare(|_| (), &["--json", "-"]).code(), Some(2));
}

#[test]
fn one_file_twice_is_reported() {
    let bench = bench();
    let run = bench.judge("reference.exr", &["--quiet"]);
    assert_eq!((run.code(), run.stderr.as_str()), (Some(0), ""));
    assert!(bench.judge("reference.exr", &[]).stderr.contains("are one file"));
}

/// The exit code does not change if the reader of stdout ends early.
#[test]
fn a_closed_stdout_keeps_the_exit_code() {
    let bench = bench();
    bench.compare(|image| image.channels[0].samples[0] += 9.0, &[]);
    let mut child = Command::new(env!("CARGO_BIN_EXE_compare"))
        .args([bench.path("reference.exr"), bench.path("test.exr")])
        .args(["--max-abs", "1"])
        .stdout(std::process::Stdio::piped())
        .spawn()
        .unwrap();
    drop(child.stdout.take());
    assert_eq!(child.wait().unwrap().code(), Some(1));
}

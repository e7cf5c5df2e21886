//! Tests of the images that the program writes: the signed difference and the heatmap.
//!
//! Seen to catch: reference - test, outputs written only on success, the guard of the inputs left out for each option,
//! the scale taken from the images.

use std::path::Path;

use formats::image::Image;
use picture::Picture;

use crate::support::{Compare, Verdict, WIDTH, bench, picture};

fn options<'a>(option: &'a str, path: &'a Path) -> [&'a str; 2] {
    [option, path.to_str().unwrap()]
}

#[test]
fn the_difference_is_signed_and_keeps_names_and_window() {
    let bench = bench();
    let shift = |image: &mut Image| image.window = [-3, 5];
    let mut reference = picture();
    shift(&mut reference);
    bench.write_image("reference.exr", &reference);
    let path = bench.path("difference.exr");
    let change = |image: &mut Image| {
        shift(image);
        image.channels[1].samples[7] -= 0.5;
        image.channels[3].samples[WIDTH] = f32::NAN;
    };
    bench.compare(change, &options("--diff-exr", &path)).fails("nonfinite 1 > 0");
    let found = Image::read(&path).unwrap();
    assert_eq!((found.width, found.height, found.window), (reference.width, reference.height, [-3, 5]));
    let mut names: Vec<String> = reference.channels.into_iter().map(|channel| channel.name).collect();
    names.sort();
    assert_eq!(found.channels.iter().map(|channel| channel.name.clone()).collect::<Vec<_>>(), names);
    assert_eq!(found.channel("G").unwrap()[7], -0.5);
    assert!(found.channel("Z").unwrap()[WIDTH].is_nan());
    let zeroes = |name: &str| found.channel(name).unwrap().iter().filter(|sample| **sample == 0.0).count();
    assert_eq!(["R", "G", "Z"].map(zeroes), [24 * 16, 24 * 16 - 1, 24 * 16 - 1]);
}

/// Seen to catch: infinities written for finite images, with exit code 0.
#[test]
fn a_difference_that_float32_does_not_hold_is_not_written() {
    let bench = bench();
    let mut reference = picture();
    reference.channels[1].samples[WIDTH + 3] = -3e38;
    bench.write_image("reference.exr", &reference);
    let (path, json) = (bench.path("difference.exr"), bench.path("report.json"));
    let change = |value: f32| move |image: &mut Image| image.channels[1].samples[WIDTH + 3] = value;
    let outputs = [options("--diff-exr", &path), options("--json", &json)].concat();
    let run = bench.compare(change(3e38), &outputs);
    assert_eq!((run.code(), run.stdout.as_str()), (Some(3), ""), "{}", run.stderr);
    for words in ["difference.exr", "channel G at pixel 3,1", "6.000e38", "--diff-exr"] {
        assert!(run.stderr.contains(words), "{}", run.stderr);
    }
    assert!(!path.exists() && !json.exists());
    bench.compare(change(3e37), &outputs).passes();
    assert!(Image::read(&path).unwrap().channel("G").unwrap()[WIDTH + 3] > 3.2e38);
}

/// Two images with different errors have the same scale, and its end can be set.
#[test]
fn the_heatmap_has_a_fixed_scale() {
    let bench = bench();
    let path = bench.path("heat.png");
    let draw = |error: f32, more: &[&str]| {
        let change = |image: &mut Image| {
            image.channels[0].samples[0] += 0.05;
            image.channels[2].samples[1] += error;
            image.channels[1].samples[2] = f32::NAN;
        };
        bench.compare(change, &[&options("--heatmap", &path), more].concat()).fails("nonfinite 1 > 0");
        let drawn = Picture::read(&path).unwrap();
        // An image of 24 pixels is enlarged by sixteen, the largest factor.
        assert!(drawn.width == 448 && drawn.height > 16 * 16);
        [0, 1, 2, 3].map(|pixel| drawn.pixels[8 * drawn.width + 16 * pixel + 8])
    };
    let few = draw(0.02, &[]);
    let many = draw(5.0, &[]);
    assert_eq!((few[0], few[3]), (many[0], many[3]));
    assert_eq!((few[2], few[3], many[1]), ([0, 255, 0], [0; 3], [255; 3]));
    assert!(few[1] != many[1] && few[0] != few[1]);
    let half = draw(0.02, &["--heatmap-max", "0.05"]);
    assert!(half[0][0] > few[0][0], "the end of the scale is brighter than its middle");
    assert_eq!(draw(0.02, &["--layer", "Z"])[0], [0; 3]);
}

#[test]
fn the_file_describes_the_scale() {
    let bench = bench();
    let path = bench.path("heat.png");
    bench.compare(|_| (), &[&options("--heatmap", &path)[..], &["--heatmap-max", "0.25"]].concat()).passes();
    let bytes = std::fs::read(&path).unwrap();
    let words = b"tEXtDescription\0absolute error of beauty, largest of its channels; linear scale from 0 to 0.25";
    assert!(bytes.windows(words.len()).any(|window| window == words));
}

#[test]
fn no_output_replaces_an_input_or_another_output() {
    let bench = bench();
    let (reference, limits) = (bench.path("reference.exr"), bench.path("limits.json"));
    std::fs::write(&limits, r#"{"schema": 1, "limits": [{"gate": "exact", "limit": 0, "reason": "r"}]}"#).unwrap();
    let link = bench.path("link.exr");
    std::os::unix::fs::symlink(&reference, &link).unwrap();
    let before = std::fs::read(&reference).unwrap();
    for option in ["--json", "--diff-exr", "--heatmap"] {
        for path in [&reference, &bench.path("test.exr"), &link, &bench.path("./test.exr")] {
            bench.compare(|_| (), &options(option, path)).cannot_judge(&[
                option,
                "would replace ",
                "give another name",
            ]);
        }
        bench
            .compare(|_| (), &[options("--limits", &limits), options(option, &limits)].concat())
            .cannot_judge(&[option, "would replace --limits"]);
    }
    assert_eq!(std::fs::read(&reference).unwrap(), before);
    let one = bench.path("one");
    bench
        .compare(|_| (), &[options("--json", &one), options("--heatmap", &one)].concat())
        .cannot_judge(&["--heatmap would replace --json"]);
}

#[test]
fn an_output_that_cannot_be_written_is_an_error() {
    let bench = bench();
    for option in ["--json", "--diff-exr", "--heatmap"] {
        bench.compare(|_| (), &options(option, &bench.path("no/file"))).cannot_judge(&["no/file", "cannot write"]);
        bench.compare(|_| (), &options(option, bench.folder())).cannot_judge(&["is a folder"]);
    }
    bench.compare(|_| (), &["--heatmap", "h.png", "--layer", "diffuse"]).cannot_judge(&["there is no layer `diffuse`"]);
    for wrong in ["0", "-1", "NaN", "inf"] {
        assert_eq!(bench.compare(|_| (), &["--heatmap", "h.png", &format!("--heatmap-max={wrong}")]).code(), Some(2));
    }
    assert_eq!(bench.compare(|_| (), &["--heatmap-max", "1"]).code(), Some(2));
    assert!(!Path::new("h.png").exists());
}

//! Tests that every channel of the picture is judged, that layers without a gate are named, and that the attributes
//! that give the numbers their meaning are compared.
//!
//! Seen to catch: alpha 1 against 0, X and Z of a picture of X, Y and Z, chroma beside luminance, other primaries,
//! another display window, pixels of another shape, and a cube for a map of latitude and longitude, all of which passed
//! without a message.

use formats::image::{Attribute, Channel, Image, Window};

use crate::support::{Compare, HEIGHT, Verdict, WIDTH, bench, picture};
use test_support::Run;

/// The limits that docs/compare.md recommends to begin with.
const LIMITS: [&str; 6] = ["--max-bias", "0.002", "--max-relmse", "0.0005", "--max-outliers", "0@0.1"];

/// Compares images of these channels, each with one value in the reference and one in the test image.
fn channels(values: &[(&str, f32, f32)], options: &[&str]) -> Run {
    let bench = bench();
    let image = |of: fn(&(&str, f32, f32)) -> f32| {
        let channel =
            |all: &(&str, f32, f32)| Channel { name: all.0.to_owned(), samples: vec![of(all); WIDTH * HEIGHT] };
        Image { width: WIDTH, height: HEIGHT, channels: values.iter().map(channel).collect(), ..Image::default() }
    };
    bench.write_image("reference.exr", &image(|(_, reference, _)| *reference));
    bench.write_image("test.exr", &image(|(_, _, test)| *test));
    bench.judge("test.exr", options)
}

#[test]
fn alpha_is_part_of_the_picture() {
    let alpha = [("R", 0.5, 0.5), ("A", 1.0, 0.0)];
    channels(&alpha, &LIMITS).fails("max-bias 1 > 0.002 (A A)");
    // If a layer is named, it is judged alone.
    let run = channels(&alpha, &[&LIMITS[..], &["--layer", "beauty"]].concat());
    run.passes();
    assert!(run.verdict().ends_with("; different but not judged: A"), "{}", run.verdict());
}

#[test]
fn pictures_without_red_green_and_blue_are_judged_as_a_whole() {
    channels(&[("X", 1.0, 6.0), ("Y", 0.5, 0.5), ("Z", 0.2, 0.6)], &LIMITS).fails("max-bias 5 > 0.002 (beauty X)");
    channels(&[("Y", 0.5, 0.5), ("RY", 0.1, 1.1), ("BY", 0.1, 0.0)], &LIMITS).fails("max-bias");
}

/// Other layers differ from render to render, so the limits of the picture do not apply to them.
#[test]
fn layers_that_no_gate_judges_are_named() {
    let bench = bench();
    let change = |image: &mut Image| image.channels[3].samples.iter_mut().for_each(|z| *z += 1.0);
    let json = bench.path("report.json");
    for options in [&[][..], &LIMITS, &["--quiet"]] {
        let run = bench.compare(change, &[options, &["--json", json.to_str().unwrap()]].concat());
        run.passes();
        assert!(run.verdict().ends_with("; different but not judged: Z"), "{}", run.verdict());
        assert_eq!(bench.json("report.json")["unjudged"], serde_json::json!(["Z"]));
    }
    for options in [&["--max-abs", "2", "--layer", "all"][..], &["--max-abs", "2", "--layer", "Z"]] {
        assert!(!bench.compare(change, options).stdout.contains("not judged"));
    }
    // A limit on depth alone does not judge the picture.
    let red = |image: &mut Image| image.channels[0].samples[0] += 1.0;
    assert!(bench.compare(red, &["--max-abs", "2", "--layer", "Z"]).verdict().ends_with("not judged: beauty"));
    assert!(!bench.compare(|_| (), &LIMITS).stdout.contains("not judged"));
    let names: Vec<String> = (0..40).map(|i| format!("aov{i:02}")).collect();
    let many: Vec<_> =
        [("R", 1.0, 1.0)].into_iter().chain(names.iter().map(|name| (name.as_str(), 1.0, 2.0))).collect();
    assert!(channels(&many, &LIMITS).verdict().ends_with("aov10, aov11 and 28 more"));
}

#[test]
fn numbers_of_another_meaning_cannot_be_judged() {
    let bench = bench();
    let set = |name: &str, value: &Attribute| {
        let (name, value) = (name.to_owned(), value.clone());
        move |image: &mut Image| drop(image.attributes.insert(name, value))
    };
    let other = |kind: &str, value: &[u8]| Attribute::Other { kind: kind.to_owned(), value: value.to_vec() };
    let aces = Attribute::Chromaticities([0.713, 0.293, 0.165, 0.83, 0.128, 0.044, 0.321_68, 0.337_67]);
    for (name, value, words) in [
        ("chromaticities", aces, ["0.713", "0.64, 0.33"]),
        ("pixelAspectRatio", Attribute::Float(2.0), ["is 2", "but 1 in"]),
        ("screenWindowWidth", Attribute::Float(0.5), ["0.5", "but 1 in"]),
        ("screenWindowCenter", other("v2f", &[0, 0, 0, 63, 0, 0, 0, 0]), ["0.5, 0", "but 0, 0 in"]),
        ("envmap", other("envmap", &[1]), ["cube", "no environment"]),
    ] {
        for options in [&LIMITS[..], &["--exact"], &["--ignore-meta"]] {
            let run = bench.compare(set(name, &value), options);
            run.cannot_judge(&[&[name, "test.exr", "reference.exr"][..], &words].concat());
        }
    }
    let rec709 = Attribute::Chromaticities([0.64, 0.33, 0.3, 0.6, 0.15, 0.06, 0.3127, 0.329]);
    bench.compare(set("chromaticities", &rec709), &LIMITS).passes();
    let shown = |image: &mut Image| image.display = Some(Window { position: [0, 0], size: [99, 99] });
    bench.compare(shown, &["--exact"]).cannot_judge(&["displayWindow", "99 x 99", "the data window"]);
    let white = bench.compare(set("whiteLuminance", &Attribute::Float(100.0)), &[]);
    white.passes();
    assert!(white.stdout.contains("whiteLuminance is in the test image only"), "{}", white.stdout);
}

/// The difference of images with other primaries has these primaries too.
#[test]
fn a_difference_keeps_the_meaning_of_its_numbers() {
    let bench = bench();
    let mut image = picture();
    image.attributes.insert("whiteLuminance".to_owned(), Attribute::Float(100.0));
    image.display = Some(Window { position: [-5, 0], size: [100, 50] });
    bench.write_image("reference.exr", &image);
    bench.write_image("test.exr", &image);
    let path = bench.path("difference.exr");
    bench.judge("test.exr", &["--diff-exr", path.to_str().unwrap()]).passes();
    let found = Image::read(&path).unwrap();
    assert_eq!(found.display, image.display);
    assert_eq!(found.attributes["whiteLuminance"], Attribute::Float(100.0));
}

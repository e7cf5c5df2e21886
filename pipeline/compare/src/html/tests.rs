//! Tests of the bytes of the page. Its behavior is tested in a browser (`make browser-test`).
//!
//! Seen to catch: `<` left in JSON, planes that are equal in both images embedded twice, bytes not shuffled, means of
//! partial blocks divided by whole ones, offsets of the data window left out, a layer dropped without a note, a value
//! of the template searched for names.

use std::collections::BTreeSet;
use std::io::Read;

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use flate2::read::ZlibDecoder;
use formats::image::{Attribute, Channel};
use serde_json::Value;

use super::reduce::{Rectangle, block_for, means};
use super::*;
use crate::{Settings, compare};

const HOSTILE: &str = "</script><!--<script>\"'&{{data}}";

fn image(width: usize, height: usize, names: &[&str]) -> Image {
    let plane = |shift: usize| (0..width * height).map(|i| ((i * 7 + shift) % 97) as f32 / 8.0).collect();
    let channels = names.iter().enumerate().map(|(i, name)| Channel { name: (*name).to_owned(), samples: plane(i) });
    Image { width, height, channels: channels.collect(), window: [10, -20], ..Image::default() }
}

/// A copy whose first channel is brighter in one pixel.
fn brighter(image: &Image, pixel: usize) -> Image {
    let mut test = image.clone();
    test.channels[0].samples[pixel] += 100.0;
    test
}

fn report(reference: &Image, test: &Image) -> Report {
    compare(reference, test, &Settings::default()).unwrap()
}

fn text(reference: &Image, test: &Image) -> String {
    let report = report(reference, test);
    String::from_utf8(page(&report, &report, reference, test).unwrap()).unwrap()
}

/// The text that an HTML parser finds in a block, which ends at the first `</script`.
fn block<'a>(page: &'a str, id: &str) -> &'a str {
    let (_, rest) = page.split_once(&format!(" id=\"{id}\">")).unwrap();
    rest.split("</script").next().unwrap()
}

fn samples(page: &str, plane: &Value) -> Vec<f32> {
    let deflated = STANDARD.decode(block(page, &format!("plane-{plane}"))).unwrap();
    let mut bytes = Vec::new();
    ZlibDecoder::new(deflated.as_slice()).read_to_end(&mut bytes).unwrap();
    let count = bytes.len() / 4;
    (0..count).map(|i| f32::from_le_bytes([0, 1, 2, 3].map(|byte| bytes[byte * count + i]))).collect()
}

#[test]
fn samples_come_back_with_their_bits() {
    let mut reference = image(5, 3, &["R", "G", "B", "Z"]);
    reference.channels[0].samples[..4].copy_from_slice(&[f32::NAN, f32::NEG_INFINITY, -0.0, 1e-42]);
    let test = brighter(&reference, 7);
    let page = text(&reference, &test);
    let picture: Value = serde_json::from_str(block(&page, "picture")).unwrap();
    let bits = |samples: &[f32]| samples.iter().map(|s| s.to_bits()).collect::<Vec<_>>();
    for (layer, channel, name) in [(0, 0, "R"), (0, 2, "B"), (1, 0, "Z")] {
        let planes = &picture["layers"][layer]["grids"][0]["planes"][channel];
        assert_eq!(bits(&samples(&page, &planes[0])), bits(reference.channel(name).unwrap()), "{name}");
        assert_eq!(bits(&samples(&page, &planes[1])), bits(test.channel(name).unwrap()), "{name}");
        assert_eq!(planes[0] == planes[1], name != "R", "equal planes are embedded once");
    }
    assert_eq!(page.matches(" id=\"plane-").count(), 5);
    assert_eq!(picture["window"], serde_json::json!([10, -20]));
}

#[test]
fn hostile_names_remain_text() {
    let names = ["R", "G", "B", &format!("{HOSTILE}.R")];
    let mut reference = image(4, 4, &names);
    reference.attributes.insert(HOSTILE.to_owned(), Attribute::Text(HOSTILE.to_owned()));
    let page = text(&reference, &brighter(&reference, 3));
    assert!(!page.contains(HOSTILE) && !page.contains("<!--"));
    let picture: Value = serde_json::from_str(block(&page, "picture")).unwrap();
    assert_eq!(picture["layers"][1]["name"], HOSTILE);
    assert_eq!(picture["attributes"][0]["reference"], HOSTILE);
    let report: Value = serde_json::from_str(block(&page, "report")).unwrap();
    assert_eq!(report["layers"][1]["name"], HOSTILE);
    // There is one element for each block, and one for the code at the end.
    assert_eq!(page.matches("<script").count(), 3 + 5 + 1);
    assert_eq!(page.matches("</script>").count(), 3 + 5 + 1);
}

/// In the markup of the page and of the index each id occurs once, every id that the scripts ask for exists, nothing is
/// loaded, and no markup is made of text.
#[test]
fn pages_are_whole() {
    for (template, script) in [
        (include_str!("page/page.html"), [COMMON, SCRIPT].concat()),
        (include_str!("page/index.html"), index::script()),
    ] {
        let ids: Vec<&str> = template.split(" id=\"").skip(1).map(|rest| rest.split('"').next().unwrap()).collect();
        assert_eq!(ids.iter().collect::<BTreeSet<_>>().len(), ids.len(), "{ids:?}");
        for asked in script.split("byId(\"").skip(1).map(|rest| rest.split('"').next().unwrap()) {
            assert!(ids.contains(&asked), "no element `{asked}`");
        }
        for element in ["section", "table", "div", "p", "button", "main", "header", "label", "fieldset", "aside"] {
            let opened =
                template.matches(&format!("<{element}>")).count() + template.matches(&format!("<{element} ")).count();
            assert_eq!(opened, template.matches(&format!("</{element}>")).count(), "{element}");
        }
        for word in ["innerHTML", "outerHTML", "insertAdjacentHTML", "document.write", "eval(", "http://", "https://"] {
            let allowed = script.replace("\"http://www.w3.org/2000/svg\"", "");
            assert!(!allowed.contains(word) && !template.contains(word), "{word}");
        }
    }
}

#[test]
fn bytes_are_the_same_for_any_number_of_threads() {
    let reference = image(70, 50, &["R", "G", "B", "N.X", "N.Y", "N.Z", "Z"]);
    let test = brighter(&reference, 99);
    let run = |threads| {
        rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap().install(|| text(&reference, &test))
    };
    assert!(run(1) == run(5));
}

#[test]
fn means_of_blocks() {
    let plane: Vec<f32> = (0..15).map(|i| i as f32).collect();
    let whole = Rectangle { x: 0, y: 0, width: 5, height: 3 };
    assert_eq!(means(&plane, 5, whole, 2), [3.0, 5.0, 6.5, 10.5, 12.5, 14.0]);
    let part = Rectangle::around([4, 1], 2, [5, 3]);
    assert_eq!(part, Rectangle { x: 2, y: 0, width: 3, height: 3 });
    assert_eq!(means(&plane, 5, part, 1), [2.0, 3.0, 4.0, 7.0, 8.0, 9.0, 12.0, 13.0, 14.0]);
    let limits = [(100, 1), (99, 2), (25, 2), (24, 4), (1, 16), (0, 1)];
    assert_eq!(limits.map(|(limit, _)| block_for([10, 10], limit)), limits.map(|(_, block)| block));
}

/// 2100 x 1000 pixels are slightly more than 2^21.
#[test]
fn a_large_image_is_reduced_but_for_its_worst_pixel() {
    let reference = image(2100, 1000, &["Y"]);
    let test = brighter(&reference, 700 * 2100 + 1500);
    let page = text(&reference, &test);
    let picture: Value = serde_json::from_str(block(&page, "picture")).unwrap();
    let grids = picture["layers"][0]["grids"].as_array().unwrap();
    let shape = |grid: &Value| ["x", "y", "width", "height", "block"].map(|key| grid[key].as_u64().unwrap());
    assert_eq!(grids.iter().map(shape).collect::<Vec<_>>(), [[0, 0, 1050, 500, 2], [1468, 668, 64, 64, 1]]);
    let plane = samples(&page, &grids[1]["planes"][0][1]);
    assert_eq!(plane[32 * 64 + 32], test.channels[0].samples[700 * 2100 + 1500]);
    assert!(picture["notes"][0].as_str().unwrap().contains("beauty show means of 2 x 2 pixels"), "{picture}");
}

/// The budget is small, because a page of 100 MB would take long.
#[test]
fn large_layers_are_reduced_the_first_one_last() {
    let names = ["R", "a.R", "b.R", "c.R"];
    let mut reference = image(64, 64, &names);
    // Random bits cannot be deflated.
    let mut state = 1_u32;
    for sample in reference.channels.iter_mut().flat_map(|channel| &mut channel.samples) {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        *sample = f32::from_bits(0x3f80_0000 | state >> 9);
    }
    let report = report(&reference, &reference);
    let layers = layer::layers(&reference, &reference);
    let blocks = |budget: usize| {
        let fitted = fit::fit(&report, &layers, &reference, budget);
        let size: usize = fitted.layers.iter().flat_map(LayerData::planes).map(|plane| plane.text.len()).sum();
        assert!(size <= budget, "{size} of {budget}");
        (serde_json::to_value(&fitted.layers).unwrap(), fitted.notes)
    };
    let of = |layers: &Value| {
        layers.as_array().unwrap().iter().map(|layer| layer["grids"][0]["block"].as_u64().unwrap()).collect::<Vec<_>>()
    };
    assert_eq!(of(&blocks(200_000).0), [1, 1, 1, 1]);
    let (layers, notes) = blocks(60_000);
    assert_eq!(of(&layers)[0], 1);
    assert!(
        of(&layers)[1..].iter().any(|block| *block > 1) && notes[0].contains("means of 2 x 2"),
        "{layers} {notes:?}"
    );
    // The area around the worst pixel keeps its size.
    let (layers, notes) = blocks(14_000);
    assert_eq!(of(&layers).len(), 3, "{layers}");
    assert!(
        notes.last().unwrap().starts_with("These layers are only in the tables")
            && notes.last().unwrap().ends_with(": c."),
        "{notes:?}"
    );
}

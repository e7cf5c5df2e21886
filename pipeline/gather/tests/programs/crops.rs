//! `--crop`: a crop has the bits of the whole image, and crops can be joined to the whole.
//!
//! Seen to catch: random numbers by the position in the crop; corners of edge pixels counted from the corner of the
//! crop; points of the cut correction from an image of the crop's size; the data window as the display window; row and
//! column exchanged.

use formats::{Image, Window};
use std::process::Command;
use test_support::{Bench, Run, data};

const SIZE: [usize; 2] = [40, 30];

/// Crops in the middle, of one pixel, at each corner, of a row, of a column, of everything; with offsets that are no
/// multiples of a tile.
const CROPS: [[usize; 4]; 9] = [
    [13, 7, 11, 9],
    [20, 14, 1, 1],
    [0, 0, 5, 3],
    [37, 0, 3, 8],
    [0, 21, 9, 9],
    [31, 27, 9, 3],
    [0, 15, 40, 1],
    [21, 0, 1, 30],
    [0, 0, 40, 30],
];

fn gather(bench: &Bench, output: &str, more: &[&str]) {
    let (scene, view) = (data("scenes/figure.glb"), data("views/figure/front.json"));
    let own = ["figure.cloud", &scene, "--view", &view, "--medium", "skin1", "-o", output, "--width", "40"];
    bench.succeed("gather", &[&own[..], &["--height", "30", "--no-timings", "--quiet"], more].concat());
}

fn sample(bench: &Bench) {
    bench.succeed("sample-surface", &[&data("scenes/figure.glb"), "-n", "5k", "-o", "figure.cloud", "--quiet"]);
}

fn bits(image: &Image, [x, y, width, height]: [usize; 4]) -> Vec<(String, Vec<u32>)> {
    let rows = |samples: &[f32]| -> Vec<u32> {
        let row = |k: usize| samples[k * image.width + x..][..width].iter().map(|v| v.to_bits());
        (y..y + height).flat_map(row).collect()
    };
    image.channels.iter().map(|channel| (channel.name.clone(), rows(&channel.samples))).collect()
}

#[test]
fn a_crop_is_that_part_of_the_whole_bit_for_bit() {
    let bench = Bench::new();
    sample(&bench);
    let kinds: [&[&str]; 5] = [
        &["--spp", "4"],
        &["--spp", "1", "--filter", "point"],
        &["--spp", "3", "--bssrdf", "standard-dipole", "--accuracy", "0.2"],
        &["--spp", "2", "--estimator", "roulette"],
        &["--spp", "2", "--estimator", "exhaustive"],
    ];
    for kind in kinds {
        gather(&bench, "whole.exr", &[kind, &["--stats", "whole.json"]].concat());
        let whole = bench.image("whole.exr");
        // The image has edge pixels and is not black.
        assert!(bench.json("whole.json")["edge_pixels"].as_u64() > Some(20) || kind.contains(&"point"));
        for crop in CROPS {
            let [x, y, width, height] = crop;
            let argument = crop.map(|n| n.to_string()).join(",");
            gather(&bench, "crop.exr", &[kind, &["--crop", &argument, "--preview", "crop.png"]].concat());
            let part = bench.image("crop.exr");
            assert!(bits(&part, [0, 0, width, height]) == bits(&whole, crop), "{kind:?} {crop:?}");
            assert_eq!((part.width, part.height, part.window), (width, height, [x as i32, y as i32]));
            let shown = Window { position: [0, 0], size: SIZE };
            assert_eq!(part.display, ([width, height] != SIZE).then_some(shown), "{crop:?}");
            assert_eq!(part.attributes, whole.attributes);
            let png = bench.read("crop.png");
            let side = |at: usize| u32::from_be_bytes(png[at..at + 4].try_into().expect("four bytes")) as usize;
            assert_eq!([side(16), side(20)], [width, height]);
        }
    }
}

#[test]
fn a_crop_outside_the_image_is_refused() {
    let bench = Bench::new();
    sample(&bench);
    let (scene, view) = (data("scenes/figure.glb"), data("views/figure/front.json"));
    let own = ["figure.cloud", &scene, "--view", &view, "--medium", "skin1", "-o", "x.exr", "--width", "40"];
    for crop in ["33,0,8,1", "0,0,1,31", "40,0,1,1", "4294967295,0,4294967295,1", "0,0,0,1", "1,2,3", "-1,0,1,1", "a"] {
        let argument = format!("--crop={crop}");
        bench.refuses("gather", &[&own[..], &["--height", "30", &argument]].concat(), &["--crop"]);
    }
    bench.refuses("gather", &[&own[..], &["--crop", "0,0,1,1", "--target-error", "0.1"]].concat(), &["--target-error"]);
}

/// The command of docs/guide.md joins crops in any order.
#[test]
fn oiiotool_joins_crops_to_the_whole() {
    if Command::new("oiiotool").arg("--version").output().is_err() {
        println!("skipped: oiiotool is not installed");
        return;
    }
    let bench = Bench::new();
    sample(&bench);
    gather(&bench, "whole.exr", &["--spp", "4"]);
    let parts = [("c", "17,12,23,18"), ("a", "0,0,17,30"), ("b", "17,0,23,12")];
    let files: Vec<String> = parts.iter().map(|(name, _)| format!("{name}.exr")).collect();
    for (file, (_, crop)) in files.iter().zip(parts) {
        gather(&bench, file, &["--spp", "4", "--crop", crop]);
    }
    let mut oiiotool = Command::new("oiiotool");
    oiiotool.current_dir(bench.path("")).args(files).args(["--paste:all=1:mergeroi=1", "+0+0", "-o", "joined.exr"]);
    let output = Run::of(&mut oiiotool);
    assert!(output.status.success(), "{}", output.stderr);
    let (whole, joined) = (bench.image("whole.exr"), bench.image("joined.exr"));
    assert_eq!((joined.width, joined.height, joined.window, joined.display), (40, 30, [0, 0], None));
    let all = [0, 0, SIZE[0], SIZE[1]];
    assert!(bits(&joined, all) == bits(&whole, all));
    assert_eq!(joined.attributes.get("pcsss/cloud"), whole.attributes.get("pcsss/cloud"));
    // Some of the joined values are negative.
    assert!(whole.channel("N.X").expect("a layer").iter().any(|x| *x < 0.0));
}

//! Environment maps of both formats, their windows and colors, and damaged files.

use super::*;
use crate::{Attribute, Channel, Window};

fn exr(names: &[&str]) -> Vec<u8> {
    let channel =
        |(k, name): (usize, &&str)| Channel { name: (*name).into(), samples: vec![k as f32, 0.5, 2.0, 1e-3, 7.0, 1e5] };
    let channels = names.iter().enumerate().map(channel).collect();
    Image { width: 3, height: 2, channels, ..Image::default() }.encode().expect("encodes")
}

#[test]
fn the_same_picture_as_either_format_is_the_same() {
    let picture = Panorama::decode(&exr(&["R", "G", "B"])).expect("a picture");
    assert_eq!((picture.width, picture.height, picture.pixels.len()), (3, 2, 6));
    assert_eq!((picture.pixels[0], picture.pixels[1]), ([0.0, 1.0, 2.0], [0.5; 3]));
    let exact = [[0.0, 1.0, 2.0], [0.5, 0.5, 0.5], [256.0, 0.0, 2.0]];
    let mut hdr = b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 3\n".to_vec();
    hdr.extend([0, 64, 128, 130, 128, 128, 128, 128, 128, 0, 1, 137]);
    let channel = |k: usize| Channel { name: "RGB"[k..=k].into(), samples: exact.map(|p: [f32; 3]| p[k]).to_vec() };
    let image = Image { width: 3, height: 1, channels: (0..3).map(channel).collect(), ..Image::default() };
    let from_exr = Panorama::decode(&image.encode().expect("encodes")).expect("a picture");
    assert_eq!(from_exr, Panorama::decode(&hdr).expect("a picture"));
    assert_eq!(from_exr.pixels, exact);
}

#[test]
fn gray_is_a_color_and_other_layers_are_not() {
    let gray = Panorama::decode(&exr(&["Y"])).expect("a picture");
    assert_eq!(gray.pixels[5], [1e5; 3]);
    let message = Panorama::decode(&exr(&["sky.R", "sky.G"])).expect_err("no color");
    assert!(message.contains("sky.G") && message.contains("R, G and B"), "{message}");
    assert!(Panorama::decode(&exr(&["R", "Y"])).is_err() && Panorama::decode(&exr(&["Y", "RY", "BY"])).is_err());
}

#[test]
fn damaged_files_are_refused() {
    let whole = exr(&["R", "G", "B"]);
    for length in 0..whole.len() {
        assert!(Panorama::decode(&whole[..length]).is_err(), "{length}");
    }
    assert!(Panorama::decode(b"\x89PNG").expect_err("refused").contains("neither"));
    let folder = tempfile::tempdir().expect("a folder");
    assert!(Panorama::read(folder.path()).expect_err("refused").to_string().contains("not a regular file"));
}

/// Four by two pixels of red 1 to 8 whose data and display windows lie elsewhere.
fn windows(data: Window, display: Window) -> Image {
    let [width, height] = data.size;
    let sample = |k: usize| (1 + k) as f32;
    let channel = |name: &str| Channel { name: name.into(), samples: (0..width * height).map(sample).collect() };
    let channels = vec![channel("R"), channel("G"), channel("B")];
    Image { width, height, channels, window: data.position, display: Some(display), ..Image::default() }
}

fn reds(picture: &Panorama) -> Vec<f32> {
    picture.pixels.iter().map(|p| p[0]).collect()
}

fn decoded(image: &Image) -> Result<Panorama, String> {
    Panorama::decode(&image.encode().expect("encodes"))
}

/// Seen to catch: the data window stretched over the sphere; the offset of one window taken for that of the other; rows
/// taken for columns.
#[test]
fn the_display_window_is_the_sphere() {
    let window = |x: i32, y: i32, width: usize, height: usize| Window { position: [x, y], size: [width, height] };
    let part = decoded(&windows(window(1, 0, 2, 1), window(0, 0, 4, 2))).expect("a picture");
    assert_eq!((part.width, part.height), (4, 2));
    assert_eq!(reds(&part), [0.0, 1.0, 2.0, 0.0, 0.0, 0.0, 0.0, 0.0]);
    assert!(part.warnings.len() == 1 && part.warnings[0].contains("25.0 % of its display window of 4 x 2"));
    let overscan = decoded(&windows(window(-11, 4, 4, 3), window(-10, 5, 2, 1))).expect("a picture");
    assert_eq!((overscan.width, overscan.height, reds(&overscan)), (2, 1, vec![6.0, 7.0]));
    assert!(overscan.warnings.len() == 1 && overscan.warnings[0].contains("left out"), "{:?}", overscan.warnings);
    let both = decoded(&windows(window(-1, -1, 2, 2), window(0, 0, 2, 2))).expect("a picture");
    assert_eq!((reds(&both), both.warnings.len()), (vec![4.0, 0.0, 0.0, 0.0], 2));
    let apart = decoded(&windows(window(4, 0, 2, 1), window(0, 0, 4, 2))).expect_err("nothing is shown");
    assert!(apart.contains("outside its display window"), "{apart}");
    // Black takes no room in a file, but it does in memory.
    for size in [[16_000, 8_000], [1 << 20, 1 << 20]] {
        let display = Window { position: [0, 0], size };
        let message = decoded(&windows(window(0, 0, 1, 1), display)).expect_err("refused");
        assert!(message.contains(&format!("{} x {} pixels", size[0], size[1])), "{message}");
    }
}

fn with_chromaticities(numbers: [f32; 8], planes: &[(&str, [f32; 2])]) -> Image {
    let channel = |(name, samples): &(&str, [f32; 2])| Channel { name: (*name).into(), samples: samples.to_vec() };
    let attributes = [("chromaticities".to_owned(), Attribute::Chromaticities(numbers))].into();
    let channels = planes.iter().map(channel).collect();
    Image { width: 2, height: 1, channels, attributes, ..Image::default() }
}

const ACESCG: [f32; 8] = [0.713, 0.293, 0.165, 0.830, 0.128, 0.044, 0.32168, 0.33767];

/// Seen to catch: all numbers taken for Rec. 709.
#[test]
fn other_primaries_become_rec_709() {
    let inside = [("R", [0.5, 1.0]), ("G", [0.5, 0.9]), ("B", [0.5, 0.8])];
    let picture = decoded(&with_chromaticities(ACESCG, &inside)).expect("a picture");
    let expected = [[0.5; 3], [1.078836, 0.888020, 0.782303]];
    for (found, expected) in picture.pixels.iter().flatten().zip(expected.iter().flatten()) {
        assert!((found - expected).abs() < 2e-4, "{found} {expected}");
    }
    assert_eq!(picture.warnings, [""; 0]);
    // Half of the sphere is pure green: the warning states the change of the light.
    let green = [("R", [0.0, 0.5]), ("G", [1.0, 0.5]), ("B", [0.0, 0.5])];
    let picture = decoded(&with_chromaticities(ACESCG, &green)).expect("a picture");
    let [r, g, b] = picture.pixels[0];
    assert!(r == 0.0 && (g - 1.1408).abs() < 1e-4 && b == 0.0, "{:?}", picture.pixels);
    let said = "1 of 2 pixels have colors outside Rec. 709: negative channels become 0, and the mean radiance of the \
                picture is 2.5000e-1 8.2040e-1 2.5000e-1 instead of -6.0";
    assert!(picture.warnings.len() == 1 && picture.warnings[0].starts_with(said), "{:?}", picture.warnings);
    // Numbers that are no radiance are kept, for the environment map to refuse.
    let bad = [("R", [f32::NAN, -1.0]), ("G", [1.0, 1.0]), ("B", [1.0, 1.0])];
    let picture = decoded(&with_chromaticities(ACESCG, &bad)).expect("a picture");
    assert!(picture.pixels[0][0].is_nan() && picture.pixels[1] == [-1.0, 1.0, 1.0]);
    let message = decoded(&with_chromaticities([0.0; 8], &inside)).expect_err("no color space");
    assert!(message.starts_with("chromaticities: ") && message.contains("Rec. 709"), "{message}");
}

#[test]
fn rec_709_and_gray_keep_their_bits_and_alpha_is_over_black() {
    let own = [0.64, 0.33, 0.3, 0.6, 0.15, 0.06, 0.3127, 0.329];
    let planes = [("A", [0.25, 1.0]), ("R", [0.1, 0.2]), ("G", [0.3, 0.4]), ("B", [0.5, 0.6])];
    let picture = decoded(&with_chromaticities(own, &planes)).expect("a picture");
    assert_eq!((picture.pixels, picture.warnings), (vec![[0.1, 0.3, 0.5], [0.2, 0.4, 0.6]], vec![]));
    let gray = decoded(&with_chromaticities(ACESCG, &[("Y", [0.1, 0.2]), ("Z", [7.0, 8.0])])).expect("a picture");
    assert_eq!(gray.pixels, [[0.1; 3], [0.2; 3]]);
}

/// Seen to catch: a cube taken for latitude and longitude; X, Y and Z taken for gray.
#[test]
fn other_projections_and_color_models_are_refused() {
    let mut image = with_chromaticities(ACESCG, &[("R", [1.0; 2]), ("G", [1.0; 2]), ("B", [1.0; 2])]);
    for (kind, refused) in [("\u{0}", false), ("\u{1}", true)] {
        image.attributes = [("envmaQ".to_owned(), Attribute::Text(kind.into()))].into();
        let mut bytes = image.encode().expect("encodes");
        let start = bytes.windows(14).position(|w| w == b"envmaQ\0string\0").expect("the attribute");
        bytes[start..start + 14].copy_from_slice(b"envmap\0envmap\0");
        let message = Panorama::decode(&bytes).err().unwrap_or_default();
        assert_eq!(message.contains("envmap: the map is a cube"), refused, "{message}");
    }
    let message = Panorama::decode(&exr(&["X", "Y", "Z"])).expect_err("refused");
    assert!(message.contains("X, Y and Z"), "{message}");
}

/// The size is read without the pixels, and the stated memory covers them.
#[test]
fn the_size_is_in_the_header() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("sky.exr");
    let window = |width: usize, height: usize| Window { position: [0, 0], size: [width, height] };
    let whole = windows(window(30, 20), window(40, 50)).encode().expect("encodes");
    // Part of the first block of pixels is there.
    std::fs::write(&path, &whole[..whole.len() * 2 / 3]).expect("writes");
    let size = Panorama::size(&path).expect("a size");
    assert_eq!((size.width, size.height), (40, 50));
    assert!(size.reading_bytes > 30 * 20 * 12 + 40 * 50 * 12, "{size:?}");
    let image = Image::dimensions(&path).expect("dimensions");
    assert_eq!((image.width, image.height, image.channels), (30, 20, 3));
    assert!(Panorama::read(&path).is_err());
    let hdr = folder.path().join("sky.hdr");
    std::fs::write(&hdr, b"#?RADIANCE\n\n-Y 3 +X 5\n12345678").expect("writes");
    let size = Panorama::size(&hdr).expect("a size");
    assert_eq!((size.width, size.height), (5, 3));
}

//! Files that `exr/make.py` wrote with OpenEXR and its tools.
//!
//! Seen to catch: tiles without their offset; mip levels not left out; the largest uint compared as u32; rows from
//! bottom to top for decreasing line order.

use std::num::NonZeroUsize;
use std::path::PathBuf;

use formats::image::Image;

const SIZE: (usize, usize) = (37, 41);

fn path(name: &str) -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("tests/exr").join(name).with_extension("exr")
}

fn value(channel: usize, x: usize, y: usize) -> f32 {
    ((x / 4 + y / 8 + channel) % 9) as f32 * 0.25
}

/// Samples of float, half and uint: multiples of a quarter, which even PXR24 keeps.
#[track_caller]
fn assert_pixels(image: &Image, prefix: &str) {
    for (name, channel, scale) in [("R", 0, 1.0), ("G", 1, 1.0), ("id", 2, 4.0)] {
        let samples = image.channel(&format!("{prefix}{name}")).unwrap();
        assert_eq!(samples.len(), SIZE.0 * SIZE.1);
        for (i, sample) in samples.iter().enumerate() {
            assert_eq!(*sample, scale * value(channel, i % SIZE.0, i / SIZE.0), "{prefix}{name} {i}");
        }
    }
}

#[test]
fn lossless_flat_files_are_read_exactly() {
    for name in ["none", "zips", "zip", "pxr24", "decreasing", "random", "mip", "rip"] {
        let image = Image::read(&path(name)).unwrap();
        assert_eq!((image.width, image.height, image.window), (SIZE.0, SIZE.1, [-7, 11]), "{name}");
        assert_eq!(image.channels.len(), 3, "{name}");
        assert_pixels(&image, "");
    }
}

/// One part of scan lines, and one of tiles at several resolutions.
#[test]
fn parts_are_layers() {
    let image = Image::read(&path("parts")).unwrap();
    let names: Vec<&str> = image.channels.iter().map(|channel| channel.name.as_str()).collect();
    assert_eq!(names, ["mip.G", "mip.R", "mip.id", "zips.G", "zips.R", "zips.id"]);
    assert_pixels(&image, "mip.");
    assert_pixels(&image, "zips.");
}

#[test]
fn any_number_of_threads_reads_the_same() {
    for name in ["zip", "random", "rip", "parts"] {
        let bytes = std::fs::read(path(name)).unwrap();
        let one = Image::decode(&bytes).unwrap();
        for threads in [2, 3, 64] {
            assert_eq!(Image::decode_with(&bytes, NonZeroUsize::new(threads).unwrap()).unwrap(), one, "{name}");
        }
    }
}

#[test]
fn what_cannot_be_read_exactly_is_refused_by_name() {
    for (name, words) in [
        ("htj2k", "ht j2k 256"),
        ("zstd", "ZSTD"),
        ("dwaa", "dwaa"),
        ("b44", "b44"),
        ("deep", "deep data"),
        ("windows", "different data windows"),
        ("chroma", "subsampling"),
        ("large-id", "`id` holds integers that float32 cannot represent"),
    ] {
        let message = Image::read(&path(name)).unwrap_err().to_string();
        assert!(message.contains(words) && message.contains("unsupported kind"), "{message}");
        assert!(message.starts_with(path(name).to_str().unwrap()), "{message}");
    }
}

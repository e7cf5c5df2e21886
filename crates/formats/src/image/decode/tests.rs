//! Reading of every layout, and of damaged files.

use exr::prelude::*;

use super::{Image as Plain, ImageError};

const SIZE: (usize, usize) = (37, 41);

/// An image that compression makes smaller, so that damage reaches the decompressors.
fn value(channel: usize, x: usize, y: usize) -> f32 {
    ((x / 4 + y / 8 + channel) % 9) as f32 * 0.25
}

fn layer(name: &str, encoding: Encoding) -> Layer<AnyChannels<FlatSamples>> {
    let plane = |channel| (0..SIZE.0 * SIZE.1).map(move |i| value(channel, i % SIZE.0, i / SIZE.0));
    let list: [(&str, FlatSamples); 3] = [
        ("R", FlatSamples::F32(plane(0).collect())),
        ("G", FlatSamples::F16(plane(1).map(f16::from_f32).collect())),
        ("id", FlatSamples::U32(plane(2).map(|value| (4.0 * value) as u32).collect())),
    ];
    let channels = list.into_iter().map(|(name, samples)| AnyChannel::new(name, samples)).collect();
    let attributes = LayerAttributes::named(name).with_position(Vec2(-7, 11));
    Layer::new(SIZE, attributes, encoding, AnyChannels::sort(channels))
}

fn file(layers: &[(&str, Encoding)]) -> Vec<u8> {
    let layers: Layers<_> = layers.iter().map(|(name, encoding)| layer(name, *encoding)).collect();
    let image = Image::from_layers(ImageAttributes::with_size(SIZE), layers);
    let mut bytes = std::io::Cursor::new(Vec::new());
    image.write().non_parallel().to_buffered(&mut bytes).unwrap();
    bytes.into_inner()
}

fn encodings() -> Vec<Encoding> {
    let mut list = Vec::new();
    for compression in
        [Compression::Uncompressed, Compression::RLE, Compression::ZIP1, Compression::ZIP16, Compression::PIZ]
    {
        list.push(Encoding { compression, blocks: Blocks::ScanLines, line_order: LineOrder::Increasing });
        list.push(Encoding { compression, blocks: Blocks::ScanLines, line_order: LineOrder::Decreasing });
        list.push(Encoding { compression, blocks: Blocks::Tiles(Vec2(16, 8)), line_order: LineOrder::Increasing });
    }
    list
}

fn assert_samples(image: &Plain, prefix: &str) {
    for (name, channel, scale) in [("R", 0, 1.0), ("G", 1, 1.0), ("id", 2, 4.0)] {
        let samples = image.channel(&format!("{prefix}{name}")).unwrap();
        for (i, sample) in samples.iter().enumerate() {
            assert_eq!(*sample, scale * value(channel, i % SIZE.0, i / SIZE.0), "{prefix}{name} {i}");
        }
    }
}

#[test]
fn every_lossless_layout_is_read() {
    for encoding in encodings() {
        let image = Plain::decode(&file(&[("only", encoding)])).unwrap();
        assert_eq!((image.width, image.height, image.window), (SIZE.0, SIZE.1, [-7, 11]), "{encoding:?}");
        assert_eq!(image.channels.len(), 3);
        assert_samples(&image, "");
    }
}

#[test]
fn lossy_compression_is_refused() {
    for compression in [Compression::B44, Compression::DWAA(None)] {
        let encoding = Encoding { compression, blocks: Blocks::ScanLines, line_order: LineOrder::Increasing };
        let message = Plain::decode(&file(&[("only", encoding)])).unwrap_err().to_string();
        assert!(message.contains(&compression.to_string()), "{message}");
    }
}

#[test]
fn parts_become_layers() {
    let list = encodings();
    let image = Plain::decode(&file(&[("specular", list[10]), ("subsurface", list[2])])).unwrap();
    assert_eq!(image.channels.len(), 6);
    assert_samples(&image, "specular.");
    assert_samples(&image, "subsurface.");
}

#[test]
fn other_files_and_short_ones_are_named_as_such() {
    assert!(matches!(Plain::decode(b""), Err(ImageError::NotOpenExr)));
    assert!(matches!(Plain::decode(b"\x89PNG\r\n\x1a\n"), Err(ImageError::NotOpenExr)));
    let bytes = file(&[("only", encodings()[9])]);
    for end in 4..bytes.len() {
        assert!(Plain::decode(&bytes[..end]).is_err(), "{end} of {} bytes", bytes.len());
    }
}

/// A changed byte may change a sample, which no reader can notice, but it must not cause a panic.
#[test]
fn damage_never_panics() {
    let mut state = 1_u64;
    let mut random = |bound: usize| {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 33) as usize % bound
    };
    for encoding in encodings() {
        for layers in [vec![("a", encoding)], vec![("a", encoding), ("b", encoding)]] {
            let bytes = file(&layers);
            for _ in 0..40 {
                let mut damaged = bytes.clone();
                for _ in 0..=random(3) {
                    // Half of the damage goes to the header and the offsets, which hold the sizes.
                    let end = if random(2) == 0 { bytes.len() } else { bytes.len().min(700) };
                    damaged[random(end)] = [0, 1, 0x7f, 0x80, 0xff, random(256) as u8][random(6)];
                }
                let _ = Plain::decode(&damaged);
            }
        }
    }
}

/// A data window that the file cannot hold is refused before memory is allocated.
#[test]
fn absurd_sizes_are_refused() {
    let mut bytes = file(&[("only", encodings()[9])]);
    let find = |bytes: &[u8], words: &[u8]| bytes.windows(words.len()).position(|window| window == words).unwrap();
    // The count of blocks is left out, because it would contradict the data window.
    let count = find(&bytes, b"chunkCount\0");
    bytes[count] = b'C';
    let maximum = find(&bytes, b"dataWindow\0") + b"dataWindow\0box2i\0".len() + 4 + 8;
    // The last file is long and may unpack to more, but not to more than the limit of any image.
    for ([x, y], length) in
        [([30_000_i32, 20_000], 0), ([1_000_000_000, 1_000_000_000], 0), ([30_000, 25_000], 5 << 20)]
    {
        bytes.resize(bytes.len().max(length), 0);
        bytes[maximum..maximum + 4].copy_from_slice(&x.to_le_bytes());
        bytes[maximum + 4..maximum + 8].copy_from_slice(&y.to_le_bytes());
        let result = Plain::decode(&bytes);
        assert!(matches!(result, Err(ImageError::TooLarge { .. })), "{result:?}");
    }
}

/// Offsets that name one block twice are refused. Seen to catch: no check, where another block stays black.
#[test]
fn repeated_blocks_are_refused() {
    let mut bytes = file(&[("only", encodings()[9])]);
    let blocks = SIZE.1.div_ceil(16);
    let first = bytes.windows(8).position(|window| window == b"software").unwrap_or(0);
    let table = (first..bytes.len() - 8 * blocks)
        .find(|&at| u64::from_le_bytes(bytes[at..at + 8].try_into().unwrap()) == (at + 8 * blocks) as u64)
        .unwrap();
    bytes.copy_within(table..table + 8, table + 8);
    let message = Plain::decode(&bytes).unwrap_err().to_string();
    assert!(message.contains("position of another"), "{message}");
}

//! Panoramas as the environment of both programs.

use formats::{Attribute, Channel, Image, Window};
use test_support::{Bench, Limits, data};

/// A panorama of twelve by six pixels that both formats hold exactly: a bright pixel in a sky over dark ground.
fn sky() -> Vec<[f32; 3]> {
    let pixel = |k: usize| match (k, k / 12) {
        (28, _) => [96.0, 64.0, 32.0],
        (_, 0..3) => [0.25, 0.5, 1.0],
        _ => [0.0625; 3],
    };
    (0..72).map(pixel).collect()
}

fn image(pixels: &[[f32; 3]]) -> Image {
    let channel = |c: usize| Channel { name: "RGB"[c..=c].into(), samples: pixels.iter().map(|p| p[c]).collect() };
    Image { width: 12, height: pixels.len() / 12, channels: (0..3).map(channel).collect(), ..Image::default() }
}

fn exr(pixels: &[[f32; 3]]) -> Vec<u8> {
    image(pixels).encode().expect("encodes")
}

/// Encodes the pixels one by one, without runs.
fn hdr(pixels: &[[f32; 3]]) -> Vec<u8> {
    let mut bytes = b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 6 +X 12\n".to_vec();
    for pixel in pixels {
        let exponent = pixel.iter().fold(0.0f32, |most, x| most.max(*x)).log2().floor() + 1.0;
        bytes.extend(pixel.map(|x| (x * (8.0 - exponent).exp2()) as u8));
        bytes.push((exponent + 128.0) as u8);
    }
    bytes
}

/// Samples the slab under an environment.
fn sample(bench: &Bench, output: &str, environment: &[&str]) -> Vec<u8> {
    let slab = data("scenes/slab.glb");
    bench.succeed("sample-surface", &[&[&slab, "-n", "40k", "-o", output, "--quiet"], environment].concat());
    bench.read(output)
}

/// The cloud has the same bytes for the same panorama in either format and for any number of threads, and other bytes
/// for another scale, rotation or panorama.
#[test]
fn a_cloud_depends_on_the_picture_and_not_on_its_format() {
    let bench = Bench::new();
    bench.write("sky.exr", exr(&sky()));
    bench.write("sky.HDR", hdr(&sky()));
    let mut dimmer = sky();
    dimmer[28] = [64.0, 64.0, 32.0];
    bench.write("other.exr", exr(&dimmer));
    let first = sample(&bench, "a.cloud", &["--environment", "sky.exr", "-j", "1"]);
    assert_eq!(first, sample(&bench, "b.cloud", &["--environment", "sky.HDR", "-j", "2"]));
    let others: [&[&str]; 4] = [
        &["--environment", "sky.exr", "--environment-scale", "0.5"],
        &["--environment", "sky.exr", "--environment-rotation", "-90"],
        &["--environment", "other.exr"],
        &["--environment", "0.1,0.1,0.1"],
    ];
    for other in others {
        assert_ne!(first, sample(&bench, "c.cloud", other), "{other:?}");
    }
}

/// Seen to catch: the environment not compared with that of the cloud; the rotation applied to light only.
#[test]
fn an_image_wants_the_environment_of_its_cloud() {
    let bench = Bench::new();
    bench.write("sky.exr", exr(&sky()));
    let lit = ["--environment", "sky.exr", "--environment-rotation", "90", "--environment-scale", "2"];
    sample(&bench, "slab.cloud", &lit);
    let (slab, view) = (data("scenes/slab.glb"), data("views/slab/top.json"));
    bench.write("across.json", r#"{"eye":[0,1,0],"target":[-1,1.379,-1],"yfov":5,"width":1,"height":1}"#);
    let arguments = ["slab.cloud", &slab, "--medium", "marble", "-o", "out.exr", "--quiet"];
    let small = ["--view", &view, "--width", "4", "--height", "4", "--spp", "1"];
    for wrong in [&[][..], &lit[..2], &lit[..4], &["--environment", "1,1,1"]] {
        bench.refuses(
            "gather",
            &[&arguments, &small[..], wrong].concat(),
            &["slab.cloud", "--environment", "turned by 90"],
        );
    }
    bench.succeed("gather", &[&arguments, &small[..], &lit].concat());
    // Escaping rays see the bright pixel, which lies an eighth of a turn left of the middle and 15 degrees up, turned
    // by a quarter to between -X and -Z, and twice as bright.
    bench.succeed("gather", &[&arguments, &["--view", "across.json"][..], &lit].concat());
    let seen = ["R", "G", "B"].map(|c| bench.image("out.exr").channel(&format!("emission.{c}")).expect("a layer")[0]);
    assert_eq!(seen, [192.0, 128.0, 64.0]);
}

#[test]
fn bad_pictures_are_refused_by_name_and_pixel() {
    let bench = Bench::new();
    let slab = data("scenes/slab.glb");
    let refuses = |name: &str, content: Vec<u8>, words: &[&str]| {
        bench.write(name, &content);
        let arguments = [&slab, "-n", "10", "-o", "out.cloud", "--environment", name];
        let output = bench.run("sample-surface", &arguments);
        let message = output.stderr;
        assert_eq!(output.status.code(), Some(2), "{name}: {message}");
        for word in ["--environment", name].iter().chain(words) {
            assert!(message.contains(word), "{name}: `{word}` is not in: {message}");
        }
        assert!(!bench.path("out.cloud").exists());
    };
    for bad in [f32::NAN, f32::INFINITY, -1.0] {
        let mut pixels = sky();
        pixels[12 + 7][1] = bad;
        refuses("bad.exr", exr(&pixels), &["pixel 7, 1", "finite"]);
    }
    let (good, flat) = (exr(&sky()), hdr(&sky()));
    refuses("cut.exr", good[..good.len() - 9].to_vec(), &["damaged or truncated"]);
    refuses("cut.hdr", flat[..flat.len() - 9].to_vec(), &["ends early"]);
    refuses("bomb.hdr", b"#?RADIANCE\n\n-Y 100000 +X 100000\n".to_vec(), &["can hold"]);
    refuses("text.hdr", b"a letter".to_vec(), &["neither"]);
}

/// Seen to catch: the data window stretched over the sphere, and its border taken for sky; values in ACEScg taken for
/// Rec. 709 without a warning.
#[test]
fn a_picture_is_what_its_header_says() {
    let bench = Bench::new();
    let display = Some(Window { position: [0, 0], size: [12, 6] });
    let write = |name: &str, image: Image| bench.write(name, image.encode().expect("encodes"));
    let sampled = |name: &str| sample(&bench, "sky.cloud", &["--environment", name]);
    let [black, bright] = [[0.0; 3], [5.0; 3]];
    let upper = [&sky()[..36], &[black; 36]].concat();
    bench.write("upper.exr", exr(&upper));
    write("window.exr", Image { display, ..image(&sky()[..36]) });
    assert_eq!(sampled("upper.exr"), sampled("window.exr"));
    bench.write("sky.exr", exr(&sky()));
    let bordered = [&[bright; 24], &sky()[..], &[bright; 12]].concat();
    write("border.exr", Image { display, window: [0, -2], ..image(&bordered) });
    assert_eq!(sampled("sky.exr"), sampled("border.exr"));
    let chromaticities = Attribute::Chromaticities([0.713, 0.293, 0.165, 0.830, 0.128, 0.044, 0.32168, 0.33767]);
    let attributes = [("chromaticities".to_owned(), chromaticities)].into();
    write("green.exr", Image { attributes, ..image(&[[0.0, 1.0, 0.0]; 72]) });
    let arguments = [&data("scenes/slab.glb"), "-n", "1k", "-o", "green.cloud", "--environment", "green.exr"];
    let said = bench.says("sample-surface", &arguments);
    for words in
        ["warning: --environment: green.exr: 72 of 72 pixels", "0.0000e0 1.1408e0 0.0000e0 instead of -6.2179e-1"]
    {
        assert!(said.contains(words), "{words}: {said}");
    }
}

/// A panorama of this many rows, all of whose blocks of 16 rows are that of the given one.
fn tall(bytes: &[u8], rows: usize) -> Vec<u8> {
    let mut end = 8;
    while bytes[end] != 0 {
        let text = |at: usize| at + bytes[at..].iter().position(|b| *b == 0).expect("text ends") + 1;
        let size = text(text(end));
        end = size + 4 + u32::from_le_bytes(bytes[size..size + 4].try_into().expect("four bytes")) as usize;
    }
    let (mut header, block) = (bytes[..=end].to_vec(), &bytes[end + 1 + 8..]);
    let mut set = |name: &[u8], offset: usize, value: usize| {
        let at = header.windows(name.len()).position(|w| w == name).expect("the attribute") + name.len() + offset;
        header[at..at + 4].copy_from_slice(&(value as u32).to_le_bytes());
    };
    let count = rows / 16;
    set(b"dataWindow\0box2i\0", 4 + 12, rows - 1);
    set(b"displayWindow\0box2i\0", 4 + 12, rows - 1);
    set(b"chunkCount\0int\0", 4, count);
    let first = header.len() + 8 * count;
    header.extend((0..count).flat_map(|k| ((first + k * block.len()) as u64).to_le_bytes()));
    let blocks = (0..count).flat_map(|k| [&(16 * k as u32).to_le_bytes(), &block[4..]].concat());
    header.extend(blocks);
    header
}

/// Half a megabyte of compressed zeros is read only where the pixels fit into memory. Seen to fail without the check:
/// both programs were aborted by signal 6.
#[test]
fn pictures_that_do_not_fit_are_refused_before_they_are_read() {
    let bench = Bench::new();
    let limits = Limits { kibibytes: 700_000, seconds: 20 };
    for (width, rows, words) in [(12_000, 12_000, "scale the picture down"), (8_000, 8_000, "GiB of memory")] {
        let channel = Channel { name: "Y".into(), samples: vec![0.0; width * 16] };
        let block = Image { width, height: 16, channels: vec![channel], ..Image::default() };
        let file = tall(&block.encode().expect("encodes"), rows);
        assert!(file.len() < 1 << 20);
        bench.write("big.exr", file);
        let arguments = [&data("scenes/slab.glb"), "-n", "10", "-o", "out.cloud", "--environment", "big.exr"];
        let output = bench.run_within(limits, "sample-surface", &arguments);
        let message = output.stderr;
        assert_eq!(output.status.code(), Some(2), "{message}");
        for words in ["--environment: ", "big.exr", &format!("{width} x {rows}"), words] {
            assert!(message.contains(words), "`{words}` is not in: {message}");
        }
    }
}

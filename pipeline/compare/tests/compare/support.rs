//! A picture that tests change, and runs of the program that compare with it.

use formats::image::{Attribute, Channel, Image};
use serde_json::Value;
use std::collections::BTreeSet;
use test_support::{Bench, Run};

pub const WIDTH: usize = 24;
pub const HEIGHT: usize = 16;

/// An image with colors, one more layer, depth, and the hash of a scene.
pub fn picture() -> Image {
    let plane = |shift: usize| (0..WIDTH * HEIGHT).map(|i| 0.25 + ((i * 7 + shift) % 13) as f32 / 8.0).collect();
    let names = ["R", "G", "B", "Z", "variance.R"];
    let channels = names.iter().enumerate().map(|(i, name)| Channel { name: (*name).to_owned(), samples: plane(i) });
    Image {
        width: WIDTH,
        height: HEIGHT,
        channels: channels.collect(),
        attributes: [("pcsss/scene".to_owned(), Attribute::Text("5ce4e".to_owned()))].into(),
        window: [0, 0],
        display: None,
    }
}

/// An image of 8 x 4 pixels with these values in R, G and B.
pub fn flat(color: [f32; 3]) -> Image {
    let channels = ["R", "G", "B"].iter().zip(color);
    let channels = channels.map(|(name, value)| Channel { name: (*name).to_owned(), samples: vec![value; 32] });
    Image { width: 8, height: 4, channels: channels.collect(), ..Image::default() }
}

/// A bench with the picture as `reference.exr`.
pub fn bench() -> Bench {
    let bench = Bench::new();
    bench.write_image("reference.exr", &picture());
    bench
}

/// Comparisons with `reference.exr`.
pub trait Compare {
    /// Compares a changed copy of the picture.
    fn compare(&self, change: impl FnOnce(&mut Image), options: &[&str]) -> Run;
    /// Compares the image of this name.
    fn judge(&self, test: &str, options: &[&str]) -> Run;
}

impl Compare for Bench {
    fn compare(&self, change: impl FnOnce(&mut Image), options: &[&str]) -> Run {
        let mut image = picture();
        change(&mut image);
        self.write_image("test.exr", &image);
        self.judge("test.exr", options)
    }

    fn judge(&self, test: &str, options: &[&str]) -> Run {
        self.run("compare", &[&["reference.exr", test], options].concat())
    }
}

/// The outcome of a comparison.
pub trait Verdict {
    fn verdict(&self) -> &str;
    fn passes(&self);
    fn fails(&self, gates: &str);
    fn cannot_judge(&self, words: &[&str]);
}

impl Verdict for Run {
    /// The last line of stdout.
    fn verdict(&self) -> &str {
        self.stdout.lines().last().unwrap_or_default()
    }

    #[track_caller]
    fn passes(&self) {
        assert_eq!((self.code(), self.stderr.as_str()), (Some(0), ""), "{}", self.stdout);
        let heads = ["PASS test.exr relmse=", "PASS test p="];
        assert!(heads.iter().any(|head| self.verdict().starts_with(head)), "{}", self.stdout);
    }

    #[track_caller]
    fn fails(&self, gates: &str) {
        assert_eq!((self.code(), self.stderr.as_str()), (Some(1), ""), "{}", self.stdout);
        assert!(self.verdict().starts_with(&format!("FAIL {gates}")), "{}", self.stdout);
    }

    #[track_caller]
    fn cannot_judge(&self, words: &[&str]) {
        assert_eq!((self.code(), self.stdout.as_str()), (Some(2), ""), "{}", self.stderr);
        assert_eq!(self.stderr.lines().count(), 1, "{}", self.stderr);
        for word in words {
            assert!(self.stderr.contains(word), "`{word}` is not in: {}", self.stderr);
        }
    }
}

pub fn scale(image: &mut Image, factor: f32) {
    image.channels.iter_mut().flat_map(|channel| &mut channel.samples).for_each(|sample| *sample *= factor);
}

/// The first JSON example of docs/compare.md that follows these words.
pub fn documented(words: &str) -> Value {
    let page = include_str!("../../../../docs/compare.md");
    let (_, rest) = page.split_once(words).unwrap();
    let (_, rest) = rest.split_once("```json\n").unwrap();
    serde_json::from_str(rest.split_once("```").unwrap().0).unwrap()
}

/// The names of all keys with those of the keys above them. The items of a list share their keys.
pub fn key_paths(value: &Value) -> BTreeSet<String> {
    match value {
        Value::Object(map) => map
            .iter()
            .flat_map(|(key, value)| {
                let below = key_paths(value).into_iter().map(move |path| format!("{key}/{path}"));
                below.chain([key.clone()])
            })
            .collect(),
        Value::Array(items) => items.iter().flat_map(key_paths).collect(),
        _ => BTreeSet::new(),
    }
}

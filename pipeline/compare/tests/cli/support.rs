//! Runs the program on images in a temporary folder.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use formats::image::{Attribute, Channel, Image};

pub const WIDTH: usize = 24;
pub const HEIGHT: usize = 16;

/// A temporary folder with `reference.exr`.
pub struct Bench {
    pub folder: tempfile::TempDir,
}

/// The result of a run.
pub struct Run {
    pub code: Option<i32>,
    pub stdout: String,
    pub stderr: String,
}

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

impl Bench {
    pub fn new() -> Bench {
        let bench = Bench { folder: tempfile::tempdir().unwrap() };
        bench.write("reference.exr", &picture());
        bench
    }

    pub fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    pub fn write(&self, name: &str, image: &Image) {
        std::fs::write(self.path(name), image.encode().unwrap()).unwrap();
    }

    /// Compares the reference with a changed copy of itself.
    pub fn compare(&self, change: impl FnOnce(&mut Image), options: &[&str]) -> Run {
        let mut image = picture();
        change(&mut image);
        self.write("test.exr", &image);
        self.run("test.exr", options)
    }

    pub fn run(&self, test: &str, options: &[&str]) -> Run {
        run(Command::new(env!("CARGO_BIN_EXE_compare"))
            .args([self.path("reference.exr"), self.path(test)])
            .args(options))
    }
}

pub fn run(command: &mut Command) -> Run {
    let Output { status, stdout, stderr } = command.output().unwrap();
    let text = |bytes| String::from_utf8(bytes).unwrap();
    Run { code: status.code(), stdout: text(stdout), stderr: text(stderr) }
}

impl Run {
    pub fn verdict(&self) -> &str {
        self.stdout.lines().last().unwrap_or_default()
    }

    #[track_caller]
    pub fn passes(&self) {
        assert_eq!((self.code, self.stderr.as_str()), (Some(0), ""), "{}", self.stdout);
        assert!(self.verdict().starts_with("PASS test.exr relmse="), "{}", self.stdout);
    }

    #[track_caller]
    pub fn fails(&self, gates: &str) {
        assert_eq!((self.code, self.stderr.as_str()), (Some(1), ""), "{}", self.stdout);
        assert!(self.verdict().starts_with(&format!("FAIL {gates}")), "{}", self.stdout);
    }

    #[track_caller]
    pub fn cannot_judge(&self, words: &[&str]) {
        assert_eq!((self.code, self.stdout.as_str()), (Some(2), ""), "{}", self.stderr);
        assert_eq!(self.stderr.lines().count(), 1, "{}", self.stderr);
        for word in words {
            assert!(self.stderr.contains(word), "`{word}` is not in: {}", self.stderr);
        }
    }
}

pub fn scale(image: &mut Image, factor: f32) {
    image.channels.iter_mut().flat_map(|channel| &mut channel.samples).for_each(|sample| *sample *= factor);
}

pub fn read_json(path: &Path) -> serde_json::Value {
    serde_json::from_slice(&std::fs::read(path).unwrap()).unwrap()
}

/// The first JSON example of docs/compare.md that follows these words.
pub fn documented(words: &str) -> serde_json::Value {
    let page = include_str!("../../../../docs/compare.md");
    let (_, rest) = page.split_once(words).unwrap();
    let (_, rest) = rest.split_once("```json\n").unwrap();
    serde_json::from_str(rest.split_once("```").unwrap().0).unwrap()
}

/// The names of all keys with those of the keys above them. The items of a list share their keys.
pub fn key_paths(value: &serde_json::Value) -> BTreeSet<String> {
    match value {
        serde_json::Value::Object(map) => map
            .iter()
            .flat_map(|(key, value)| {
                let below = key_paths(value).into_iter().map(move |path| format!("{key}/{path}"));
                below.chain([key.clone()])
            })
            .collect(),
        serde_json::Value::Array(items) => items.iter().flat_map(key_paths).collect(),
        _ => BTreeSet::new(),
    }
}

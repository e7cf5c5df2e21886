//! The Makefile as users run it, in a folder of its own with links to the programs.

mod calibrations;
mod clean;
mod install;
mod pictures;
mod truth;

use formats::{Channel, Image};
use serde_json::json;
use std::{
    env, fs,
    os::unix::fs::symlink,
    path::Path,
    process::{Command, Output},
    time::{Duration, SystemTime},
};
use test_support::{Bench, program};

/// The folder of the images of `thing`.
const IMAGES: &str = "out/thing/k500-s0/marble-half-space";

/// A copy of what make needs, in a folder below that of the bench.
struct Tree {
    bench: Bench,
}

/// The output of a run of make, both streams.
struct Said(String);

impl Tree {
    fn new() -> Tree {
        let tree = Tree { bench: Bench::new() };
        let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
        for folder in ["crates/formats", "make", "target/release", "tests/check"] {
            fs::create_dir_all(tree.path(folder)).expect("makes a folder");
        }
        for file in
            ["Makefile", "crates/formats/cloud-version", "crates/formats/calibration-version", "tests/check/planted.sh"]
        {
            fs::copy(root.join(file), tree.path(file)).expect("copies");
        }
        for file in fs::read_dir(root.join("make")).expect("lists") {
            let file = file.expect("an entry");
            fs::copy(file.path(), tree.path("make").join(file.file_name())).expect("copies");
        }
        for name in ["sample-surface", "calibrate", "gather", "compare"] {
            symlink(program(name), tree.path("target/release").join(name)).expect("links");
        }
        tree
    }

    fn path(&self, name: &str) -> std::path::PathBuf {
        self.bench.path("tree").join(name)
    }

    /// Writes a file, and the folders on the way to it.
    fn write(&self, name: &str, content: impl AsRef<[u8]>) {
        let path = self.path(name);
        fs::create_dir_all(path.parent().expect("a folder")).expect("makes a folder");
        fs::write(path, content).expect("writes");
    }

    /// Writes a file whose time is before that of all other files.
    fn write_old(&self, name: &str, content: impl AsRef<[u8]>) {
        self.write(name, content);
        let file = fs::OpenOptions::new().append(true).open(self.path(name)).expect("opens");
        file.set_modified(SystemTime::UNIX_EPOCH + Duration::from_secs(1_577_836_800)).expect("sets the time");
    }

    /// The slab as `name.gltf` with `name.bin` beside it, under light of this strength, and with a small camera.
    fn scene(&self, name: &str, intensity: f64) -> Vec<u8> {
        self.bench.slab("slab.gltf", |root| {
            root["buffers"][0]["uri"] = "thing%20of  parts.bin".into();
            root["images"] = json!([{"uri": "card.png"}, {"uri": "data:image/png;base64,AAAA"}]);
            root["extensions"]["KHR_lights_punctual"]["lights"][0]["intensity"] = intensity.into();
        });
        self.write(
            &format!("{}/thing of  parts.bin", folder(name)),
            fs::read(self.bench.path("slab.bin")).expect("reads"),
        );
        self.write(&format!("{}/card.png", folder(name)), "one");
        let text = fs::read(self.bench.path("slab.gltf")).expect("reads");
        self.write(name, &text);
        text
    }

    /// The same without its last triangles, so that the slab is open.
    fn open_scene(&self, name: &str) {
        let text = self.scene(name, 1.0);
        let mut root: serde_json::Value = serde_json::from_slice(&text).expect("JSON");
        let indices = root["meshes"][0]["primitives"][0]["indices"].as_u64().expect("an index") as usize;
        let count = root["accessors"][indices]["count"].as_u64().expect("a count");
        root["accessors"][indices]["count"] = json!(count / 2 / 3 * 3);
        self.write(name, root.to_string());
    }

    fn command(&self, arguments: &[&str]) -> Command {
        let mut command = Command::new("make");
        command.current_dir(self.path("")).env_clear().env("PATH", env::var_os("PATH").unwrap_or_default());
        command.env("HOME", self.path("home"));
        command
            .args(["--no-print-directory", "CARGO=true", "THREADS=1", "SAMPLES=500", "SPP=1", "WALKS=200"])
            .args(arguments);
        command
    }

    fn make(&self, arguments: &[&str]) -> Said {
        let output = self.command(arguments).output().expect("make starts");
        assert_eq!(output.status.code(), Some(0), "{arguments:?}: {}", said(&output));
        Said(said(&output))
    }

    /// Runs make, which must refuse with exit code 2 and all of `words`, and leave the files as they are.
    fn refuses(&self, command: &mut Command, words: &[&str]) {
        let before = self.files();
        let output = command.output().expect("it starts");
        let message = said(&output);
        assert_eq!(output.status.code(), Some(2), "{command:?}: {message}");
        assert!(words.iter().all(|word| message.contains(word)), "{command:?}: {message}");
        assert_eq!(self.files(), before, "{command:?}");
    }

    fn bytes(&self, name: &str) -> Vec<u8> {
        fs::read(self.path(name)).unwrap_or_else(|e| panic!("{name}: {e}"))
    }

    /// All files, links and folders of the bench.
    fn files(&self) -> Vec<String> {
        let mut found = Vec::new();
        let mut folders = vec![self.bench.folder().to_owned()];
        while let Some(folder) = folders.pop() {
            for entry in fs::read_dir(&folder).expect("lists") {
                let entry = entry.expect("an entry");
                if entry.file_type().expect("a kind").is_dir() {
                    folders.push(entry.path());
                }
                found.push(entry.path().strip_prefix(self.bench.folder()).expect("within").display().to_string());
            }
        }
        found.sort();
        found
    }

    /// Makes an image, then again when `change` is done: it must be another, that of an empty OUT.
    #[track_caller]
    fn remakes(&self, image: &str, arguments: &[&str], change: impl FnOnce()) {
        let before = self.bytes(image);
        change();
        self.make(arguments);
        let after = self.bytes(image);
        assert!(after != before, "{arguments:?}: the old picture");
        self.make(&[arguments, &["OUT=fresh"]].concat());
        assert!(after == self.bytes(&image.replacen("out", "fresh", 1)), "{arguments:?}: a third picture");
        fs::remove_dir_all(self.path("fresh")).expect("removes");
        assert!(self.make(arguments).made().is_empty(), "{arguments:?}: made without a reason");
    }
}

impl Said {
    /// The programs that ran, in their order.
    fn made(&self) -> Vec<&str> {
        let programs = self.0.lines().filter_map(|line| line.strip_prefix("target/release/"));
        programs.filter_map(|line| line.split(' ').next()).collect()
    }
}

fn said(output: &Output) -> String {
    String::from_utf8_lossy(&[&output.stdout[..], &output.stderr].concat()).into_owned()
}

fn folder(name: &str) -> &str {
    name.rsplit_once('/').map_or(".", |(folder, _)| folder)
}

fn view(height: f64) -> String {
    let view =
        json!({"eye": [0, height, 0], "target": [0, 0, 0], "up": [0, 0, -1], "yfov": 20, "width": 8, "height": 8});
    view.to_string()
}

fn medium(sigma_s: f64) -> String {
    let medium = json!({"name": "m", "unit": "1/mm", "sigma_a": [0.1, 0.2, 0.3], "sigma_s": [sigma_s, 1.0, 1.0], "source": "none"});
    medium.to_string()
}

/// Light from all around, red as given.
fn sky(red: f32) -> Vec<u8> {
    let channel = |(name, value): (&str, f32)| Channel { name: name.into(), samples: vec![value; 8] };
    let channels = [("R", red), ("G", 0.5), ("B", 0.5)].map(channel).into();
    Image { width: 4, height: 2, channels, ..Image::default() }.encode().expect("encodes")
}

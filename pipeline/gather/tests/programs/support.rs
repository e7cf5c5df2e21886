//! Starting the programs of the pipeline.

use formats::Image;
use serde_json::Value;
use std::{
    fs,
    path::{Path, PathBuf},
    process::{Child, Command, Output, Stdio},
};

/// A temporary folder and the programs.
pub struct Bench {
    folder: tempfile::TempDir,
}

/// What a program may take.
#[derive(Clone, Copy)]
pub struct Limits {
    /// Address space.
    pub kibibytes: u64,
    /// Of all its threads.
    pub seconds: u64,
}

/// A file of `data/`.
pub fn data(name: &str) -> String {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../data").join(name).to_string_lossy().into_owned()
}

/// The JSON of a .glb and its binary chunk.
pub fn split_glb(bytes: &[u8]) -> (Value, &[u8]) {
    let size = u32::from_le_bytes(bytes[12..16].try_into().expect("four bytes")) as usize;
    (serde_json::from_slice(&bytes[20..20 + size]).expect("JSON"), &bytes[28 + size..])
}

/// A program of the workspace. Cargo names only this package's to a test; the others lie beside it.
pub fn program(name: &str) -> PathBuf {
    let path = Path::new(env!("CARGO_BIN_EXE_gather")).with_file_name(name);
    assert!(path.exists(), "{name} is not built: run `cargo test --workspace`");
    path
}

impl Bench {
    pub fn new() -> Bench {
        Bench { folder: tempfile::tempdir().expect("a temporary folder") }
    }

    pub fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    /// Runs a program in the folder.
    pub fn run(&self, name: &str, arguments: &[&str]) -> Output {
        let mut command = Command::new(program(name));
        command.current_dir(self.folder.path()).args(arguments).output().expect("the program starts")
    }

    pub fn folder(&self) -> &Path {
        self.folder.path()
    }

    /// Starts a program in the folder.
    pub fn start(&self, name: &str, arguments: &[&str]) -> Child {
        let mut command = Command::new(program(name));
        command.current_dir(self.folder.path()).args(arguments).stdout(Stdio::piped()).stderr(Stdio::piped());
        command.spawn().expect("the program starts")
    }

    /// Runs a program within limits, where there is a shell to ask for them.
    pub fn run_within(&self, limits: Limits, name: &str, arguments: &[&str]) -> Output {
        if !Path::new("/bin/sh").exists() {
            return self.run(name, arguments);
        }
        let mut command = Command::new("/bin/sh");
        let limits = format!("ulimit -v {} && ulimit -t {} && exec \"$@\"", limits.kibibytes, limits.seconds);
        command.args(["-c", &limits, "sh"]).arg(program(name));
        command.current_dir(self.folder.path()).args(arguments).output().expect("the program starts")
    }

    /// Runs a program that must succeed; returns its stdout.
    pub fn succeed(&self, name: &str, arguments: &[&str]) -> String {
        let output = self.run(name, arguments);
        let message = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(0), "{name} {arguments:?}: {message}");
        String::from_utf8_lossy(&output.stdout).into_owned()
    }

    /// What a program that must succeed says on stderr.
    pub fn says(&self, name: &str, arguments: &[&str]) -> String {
        let output = self.run(name, arguments);
        let message = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(0), "{name} {arguments:?}: {message}");
        message
    }

    /// Runs gather and demands a refusal with exit code 2 that says all of `words` and leaves no file.
    pub fn refuses(&self, arguments: &[&str], words: &[&str]) {
        self.program_refuses("gather", arguments, words);
    }

    /// The same of any program.
    pub fn program_refuses(&self, name: &str, arguments: &[&str], words: &[&str]) {
        let before = self.files();
        let output = self.run(name, arguments);
        let message = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(2), "{arguments:?}: {message}");
        for word in words {
            assert!(message.contains(word), "{arguments:?}: `{word}` is not in: {message}");
        }
        assert!(!message.contains("panicked"), "{message}");
        assert_eq!(self.files(), before, "{arguments:?} left files behind");
    }

    pub fn image(&self, name: &str) -> Image {
        Image::read(&self.path(name)).expect("an image")
    }

    pub fn json(&self, name: &str) -> Value {
        serde_json::from_slice(&fs::read(self.path(name)).expect("reads")).expect("JSON")
    }

    /// The slab of `data/` with its JSON changed, as `name` with its buffer in `slab.bin` beside it.
    pub fn slab(&self, name: &str, change: impl FnOnce(&mut Value)) -> String {
        let bytes = fs::read(data("scenes/slab.glb")).expect("reads");
        let (mut root, binary) = split_glb(&bytes);
        root["buffers"][0]["uri"] = "slab.bin".into();
        change(&mut root);
        self.write("slab.bin", binary);
        self.write(name, root.to_string());
        name.to_owned()
    }

    pub fn write(&self, name: &str, content: impl AsRef<[u8]>) {
        fs::write(self.path(name), content).expect("writes");
    }

    pub fn files(&self) -> Vec<PathBuf> {
        let entries = fs::read_dir(self.folder.path()).expect("lists");
        let mut files: Vec<PathBuf> = entries.map(|e| e.expect("an entry").path()).collect();
        files.sort();
        files
    }
}

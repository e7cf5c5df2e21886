//! Starting the programs of the pipeline.

use formats::Image;
use serde_json::Value;
use std::{
    fs,
    path::{Path, PathBuf},
    process::{Command, Output},
};

/// A temporary folder and the programs.
pub struct Bench {
    folder: tempfile::TempDir,
}

/// A file of `data/`.
pub fn data(name: &str) -> String {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../data").join(name).to_string_lossy().into_owned()
}

/// A program of the workspace. Cargo names only this package's to a test; the others lie beside it.
fn program(name: &str) -> PathBuf {
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

    /// Runs a program with so many KiB of address space, where there is a shell to ask for that.
    pub fn run_within(&self, kibibytes: &str, name: &str, arguments: &[&str]) -> Output {
        if !Path::new("/bin/sh").exists() {
            return self.run(name, arguments);
        }
        let mut command = Command::new("/bin/sh");
        command.args(["-c", "ulimit -v \"$1\" && shift && exec \"$@\"", "sh", kibibytes]).arg(program(name));
        command.current_dir(self.folder.path()).args(arguments).output().expect("the program starts")
    }

    /// Runs a program that must succeed; returns its stdout.
    pub fn succeed(&self, name: &str, arguments: &[&str]) -> String {
        let output = self.run(name, arguments);
        let message = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(0), "{name} {arguments:?}: {message}");
        String::from_utf8_lossy(&output.stdout).into_owned()
    }

    /// Runs gather and demands a refusal with exit code 2 that says all of `words` and leaves no file.
    pub fn refuses(&self, arguments: &[&str], words: &[&str]) {
        let before = self.files();
        let output = self.run("gather", arguments);
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

    pub fn write(&self, name: &str, content: impl AsRef<[u8]>) {
        fs::write(self.path(name), content).expect("writes");
    }

    fn files(&self) -> Vec<PathBuf> {
        let entries = fs::read_dir(self.folder.path()).expect("lists");
        let mut files: Vec<PathBuf> = entries.map(|e| e.expect("an entry").path()).collect();
        files.sort();
        files
    }
}

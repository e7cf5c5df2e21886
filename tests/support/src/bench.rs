//! A temporary folder, and the programs of the workspace as users start them in it.

use crate::glb::Asset;
use formats::Image;
use serde_json::Value;
use std::{
    env,
    ffi::OsStr,
    fs,
    path::{Path, PathBuf},
    process::{Child, Command, ExitStatus, Output, Stdio},
};
use tempfile::TempDir;

/// A temporary folder, which is the working folder of the programs.
pub struct Bench {
    folder: TempDir,
}

/// Exit status and output of a program.
#[derive(Debug)]
pub struct Run {
    pub status: ExitStatus,
    pub stdout: String,
    pub stderr: String,
}

/// Limits on the resources of a program.
#[derive(Clone, Copy)]
pub struct Limits {
    /// Address space.
    pub kibibytes: u64,
    /// Processor time of all its threads.
    pub seconds: u64,
}

/// Path of a program of the workspace. Cargo builds tests into `deps` below the folder of the programs.
pub fn program(name: &str) -> PathBuf {
    let test = env::current_exe().expect("the test has a path");
    let path = test.parent().and_then(Path::parent).expect("the test lies in `deps`").join(name);
    assert!(path.exists(), "{name} is not built: run `cargo test --workspace`");
    path
}

/// What else is typed: images are not calibrated unless the arguments say how, for that would take most of the time of
/// most tests. `--note` and `--reference` do not calibrate.
fn unless_said(name: &str, arguments: &[impl AsRef<OsStr>]) -> &'static [&'static str] {
    let says = |word: &str| arguments.iter().any(|a| a.as_ref() == word);
    let renders = name == "gather" && arguments.iter().all(|a| !a.as_ref().to_string_lossy().starts_with("--list"));
    if renders && !["--calibration", "--note", "--reference"].into_iter().any(says) {
        &["--calibration", "none"]
    } else {
        &[]
    }
}

/// Path of a file of `data/`.
pub fn data(name: &str) -> String {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../data").join(name).to_string_lossy().into_owned()
}

impl Run {
    /// Runs a command to its end.
    pub fn of(command: &mut Command) -> Run {
        command.output().expect("the program starts").into()
    }

    /// None if a signal ended the program.
    pub fn code(&self) -> Option<i32> {
        self.status.code()
    }
}

impl From<Output> for Run {
    fn from(Output { status, stdout, stderr }: Output) -> Run {
        let text = |bytes: Vec<u8>| String::from_utf8_lossy(&bytes).into_owned();
        Run { status, stdout: text(stdout), stderr: text(stderr) }
    }
}

impl Default for Bench {
    fn default() -> Bench {
        Bench::new()
    }
}

impl Bench {
    pub fn new() -> Bench {
        Bench { folder: tempfile::tempdir().expect("the temporary folder is writable") }
    }

    pub fn folder(&self) -> &Path {
        self.folder.path()
    }

    pub fn path(&self, name: &str) -> PathBuf {
        self.folder().join(name)
    }

    /// Writes a file, and the folders that its name asks for.
    pub fn write(&self, name: &str, content: impl AsRef<[u8]>) -> PathBuf {
        let path = self.path(name);
        fs::create_dir_all(path.parent().expect("the file lies in a folder")).expect("makes the folder");
        fs::write(&path, content).expect("writes");
        path
    }

    pub fn write_image(&self, name: &str, image: &Image) -> PathBuf {
        self.write(name, image.encode().expect("encodes"))
    }

    /// The slab of `data/` with its JSON changed: as a .glb, or as a .gltf with its buffer in `slab.bin` beside it.
    pub fn slab(&self, name: &str, change: impl FnOnce(&mut Value)) -> String {
        let mut slab = Asset::read(&fs::read(data("scenes/slab.glb")).expect("reads"));
        if name.ends_with(".glb") {
            change(&mut slab.json);
            self.write(name, slab.glb());
        } else {
            slab.json["buffers"][0]["uri"] = "slab.bin".into();
            change(&mut slab.json);
            self.write("slab.bin", slab.binary);
            self.write(name, slab.json.to_string());
        }
        name.to_owned()
    }

    pub fn read(&self, name: &str) -> Vec<u8> {
        fs::read(self.path(name)).expect("reads")
    }

    pub fn image(&self, name: &str) -> Image {
        Image::read(&self.path(name)).expect("an image")
    }

    pub fn json(&self, name: &str) -> Value {
        serde_json::from_slice(&self.read(name)).expect("JSON")
    }

    /// All entries of the folder, sorted.
    pub fn files(&self) -> Vec<PathBuf> {
        let entries = fs::read_dir(self.folder()).expect("lists");
        let mut files: Vec<PathBuf> = entries.map(|e| e.expect("an entry").path()).collect();
        files.sort();
        files
    }

    /// The command that starts a program in the folder.
    pub fn command(&self, name: &str, arguments: &[impl AsRef<OsStr>]) -> Command {
        let mut command = self.command_as_typed(name, arguments);
        command.args(unless_said(name, arguments));
        command
    }

    /// The command without the arguments that [`Bench::command`] adds to those of `gather`.
    pub fn command_as_typed(&self, name: &str, arguments: &[impl AsRef<OsStr>]) -> Command {
        let mut command = Command::new(program(name));
        command.current_dir(self.folder()).args(arguments);
        command
    }

    pub fn run(&self, name: &str, arguments: &[impl AsRef<OsStr>]) -> Run {
        Run::of(&mut self.command(name, arguments))
    }

    /// Starts a program with its output piped.
    pub fn start(&self, name: &str, arguments: &[&str]) -> Child {
        let mut command = self.command(name, arguments);
        command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().expect("the program starts")
    }

    /// Runs a program within limits, where there is a shell to ask for them.
    pub fn run_within(&self, limits: Limits, name: &str, arguments: &[&str]) -> Run {
        if !Path::new("/bin/sh").exists() {
            return self.run(name, arguments);
        }
        let limits = format!("ulimit -v {} && ulimit -t {} && exec \"$@\"", limits.kibibytes, limits.seconds);
        let mut command = Command::new("/bin/sh");
        command.args(["-c", &limits, "sh"]).arg(program(name)).args(arguments).args(unless_said(name, arguments));
        command.current_dir(self.folder());
        Run::of(&mut command)
    }

    /// Runs a program that must succeed; returns its stdout.
    #[track_caller]
    pub fn succeed(&self, name: &str, arguments: &[&str]) -> String {
        self.succeeded(name, arguments).stdout
    }

    /// Runs a program that must succeed; returns its stderr.
    #[track_caller]
    pub fn says(&self, name: &str, arguments: &[&str]) -> String {
        self.succeeded(name, arguments).stderr
    }

    #[track_caller]
    fn succeeded(&self, name: &str, arguments: &[&str]) -> Run {
        let run = self.run(name, arguments);
        assert_eq!(run.code(), Some(0), "{name} {arguments:?}: {}", run.stderr);
        run
    }

    /// Runs a program that must refuse its arguments or input: exit code 2, a message that says all of `words`, nothing
    /// on stdout and no file left behind. Returns the message.
    #[track_caller]
    pub fn refuses(&self, name: &str, arguments: &[&str], words: &[&str]) -> String {
        let before = self.files();
        let Run { status, stdout, stderr } = self.run(name, arguments);
        assert_eq!(status.code(), Some(2), "{name} {arguments:?}: {stderr}");
        assert_eq!(stdout, "", "{name} {arguments:?} wrote to stdout");
        for word in words {
            assert!(stderr.contains(word), "{name} {arguments:?}: `{word}` is not in: {stderr}");
        }
        assert!(!stderr.contains("panicked"), "{stderr}");
        assert_eq!(self.files(), before, "{name} {arguments:?} left files behind");
        stderr
    }
}

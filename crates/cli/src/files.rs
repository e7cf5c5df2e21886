//! The files that a run reads and writes, all declared before any work is done, so that no output replaces an input or
//! another output and every output is known to be writable.

use crate::Failure;
use clap::builder::{PathBufValueParser, TypedValueParser};
use formats::atomic;
use std::{
    collections::{HashMap, HashSet},
    ffi::OsString,
    fs::{self, Metadata},
    io,
    os::unix::fs::{FileTypeExt, MetadataExt},
    path::{Path, PathBuf},
};

/// The files of a run. Paths that lead to the same file, by links or other spellings, are one file.
#[derive(Debug, Default)]
pub struct Files {
    known: HashMap<Identity, Use>,
    /// Folders in which files can be created.
    probed: HashSet<Identity>,
}

/// The identity of a file: its device and inode or, where there is no file yet, those of its folder and its name.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
enum Identity {
    There { device: u64, inode: u64 },
    New { device: u64, folder: u64, name: OsString },
}

/// How a run uses a file.
#[derive(Clone, Debug)]
struct Use {
    path: PathBuf,
    /// The option or argument that names it.
    what: String,
    written: bool,
}

impl Files {
    /// Declares an input that the option or argument `what` names. Refuses pipes and devices, which might never begin
    /// or end, and a file that is declared as an output. A missing file is left to its reader.
    pub fn reads(&mut self, what: &str, path: &Path) -> Result<(), Failure> {
        let Ok(meta) = fs::metadata(path) else { return Ok(()) };
        if !meta.is_file() && !meta.is_dir() {
            let path = path.display();
            return Err(Failure::usage(format!(
                "{path}: cannot read: not a regular file; {what} names a regular file"
            )));
        }
        match self.known.get(&identity_of(&meta)) {
            Some(other) if other.written => {
                Err(would_replace(&other.path, &other.what, what, if other.path == path { None } else { Some(path) }))
            }
            Some(_) => Ok(()),
            None => {
                let used = Use { path: path.to_owned(), what: what.to_owned(), written: false };
                self.known.insert(identity_of(&meta), used);
                Ok(())
            }
        }
    }

    /// Declares an output that the option `what` names. Refuses one that cannot be written, and one that is an input or
    /// another output. Several options may name a device such as `/dev/null`.
    pub fn writes(&mut self, what: &str, path: &Path) -> Result<(), Failure> {
        let named = |failure: Failure| failure.within(what);
        atomic::check(path).map_err(|e| named(e.into()))?;
        if fs::metadata(path).is_ok_and(|meta| meta.file_type().is_char_device() || meta.file_type().is_block_device())
        {
            return Ok(());
        }
        let file = identity(path).map_err(|source| named(formats::Error::write(path, source).into()))?;
        if let Some(other) = self.known.get(&file) {
            return Err(would_replace(path, what, &other.what, (other.path != path).then_some(&other.path)));
        }
        let folder = atomic::destination(path)
            .and_then(|file| fs::metadata(atomic::folder_of(&file)))
            .map_err(|source| named(formats::Error::write(path, source).into()))?;
        if self.probed.insert(identity_of(&folder)) {
            atomic::probe(path).map_err(|e| named(e.into()))?;
        }
        self.known.insert(file, Use { path: path.to_owned(), what: what.to_owned(), written: true });
        Ok(())
    }
}

/// The refusal to write `path`, which both `what` and `other` name, the latter as the path `by` if that differs.
fn would_replace(path: &Path, what: &str, other: &str, by: Option<&Path>) -> Failure {
    let spelled = by.map_or(String::new(), |by| format!(" ({} is the same file)", by.display()));
    Failure::usage(format!("{}: {what} would replace {other}{spelled}; give another name", path.display()))
}

fn identity_of(meta: &Metadata) -> Identity {
    Identity::There { device: meta.dev(), inode: meta.ino() }
}

/// The identity of the file that a path leads to, whether or not it exists.
fn identity(path: &Path) -> io::Result<Identity> {
    if let Ok(meta) = fs::metadata(path) {
        return Ok(identity_of(&meta));
    }
    let file = atomic::destination(path)?;
    let folder = fs::metadata(atomic::folder_of(&file))?;
    let name = file.file_name().ok_or_else(|| io::Error::other("names no file"))?.to_owned();
    Ok(Identity::New { device: folder.dev(), folder: folder.ino(), name })
}

/// Whether two paths lead to the same file; false if either leads nowhere.
pub fn is_same_file(one: &Path, other: &Path) -> bool {
    identity(one).is_ok_and(|one| identity(other).is_ok_and(|other| one == other))
}

/// Parses the name of a file; refuses `-`, which users might mean as a stream.
pub fn file_name() -> impl TypedValueParser<Value = PathBuf> {
    PathBufValueParser::new().try_map(|path| match path == Path::new("-") {
        true => Err("streams are not accepted; give the name of a file (`./-` if that is its name)"),
        false => Ok(path),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::os::unix::fs::symlink;

    /// Whether `second` may be written beside the input `first`, and the other way round.
    fn may_both(folder: &Path, first: &str, second: &str) -> [bool; 2] {
        let (first, second) = (folder.join(first), folder.join(second));
        let mut early = Files::default();
        early.reads("SCENE", &first).expect("is an input");
        let mut late = Files::default();
        late.writes("--ply", &second).expect("is an output");
        [early.writes("--ply", &second).is_ok(), late.reads("SCENE", &first).is_ok()]
    }

    /// Seen to catch: paths compared as text, hard links told apart, dangling links not followed.
    #[test]
    fn a_file_of_several_names_is_not_both_read_and_written() {
        let root = tempfile::tempdir().expect("a folder");
        let folder = root.path();
        fs::write(folder.join("scene.glb"), b"scene").expect("writes");
        fs::create_dir(folder.join("sub")).expect("makes");
        symlink("scene.glb", folder.join("link")).expect("links");
        symlink(folder, folder.join("sub/up")).expect("links");
        fs::hard_link(folder.join("scene.glb"), folder.join("hard")).expect("links");
        for name in ["scene.glb", "./scene.glb", "sub/../scene.glb", "link", "sub/up/scene.glb", "hard"] {
            assert_eq!(may_both(folder, "scene.glb", name), [false; 2], "{name}");
            assert_eq!(may_both(folder, name, "scene.glb"), [false; 2], "{name}");
        }
        assert_eq!(may_both(folder, "scene.glb", "other"), [true; 2]);
        assert_eq!(fs::read_dir(folder).expect("lists").count(), 4, "the probes leave nothing");
    }

    /// Seen to catch: outputs not remembered, outputs that do not exist yet compared as text.
    #[test]
    fn two_outputs_are_two_files() {
        let root = tempfile::tempdir().expect("a folder");
        let folder = root.path();
        symlink("new.exr", folder.join("dangling")).expect("links");
        for (name, other) in [("new.exr", "new.exr"), ("new.exr", "./new.exr"), ("new.exr", "dangling")] {
            let mut files = Files::default();
            files.writes("--output", &folder.join(name)).expect("is an output");
            let message = files.writes("--stats", &folder.join(other)).expect_err("the same").message;
            assert!(message.contains("--stats would replace --output"), "{message}");
        }
        let mut files = Files::default();
        for option in ["--output", "--stats"] {
            files.writes(option, Path::new("/dev/null")).expect("a device takes all");
        }
    }

    /// Seen to catch: the probe left out.
    #[test]
    fn an_output_that_cannot_be_written_is_refused() {
        let root = tempfile::tempdir().expect("a folder");
        let mut files = Files::default();
        for path in ["nowhere/x.ply", ".", "/proc/x.ply"] {
            let path = if path == "." { root.path().to_owned() } else { root.path().join(path) };
            let message = files.writes("--ply", &path).expect_err("refused").message;
            assert!(message.contains("--ply: ") && message.contains(": cannot write: "), "{message}");
        }
        let fifo = root.path().join("fifo");
        assert!(std::process::Command::new("mkfifo").arg(&fifo).status().expect("starts").success());
        files.reads("SCENE", &fifo).expect_err("refused");
        files.writes("--ply", &fifo).expect_err("refused");
    }
}

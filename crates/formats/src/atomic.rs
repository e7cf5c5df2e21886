//! Files written whole or not at all: a temporary file beside the target, then a rename.
//!
//! Devices and pipes (`/dev/null`, a fifo) are written in place: a rename would replace them.
//!
//! Who writes a temporary file holds a lock on it. A process that was killed holds none, on this machine or another, so
//! the next that writes the same target removes what it left; that of a live one stays.

use crate::Error;
use std::{
    ffi::{OsStr, OsString},
    fs::{self, File, OpenOptions, TryLockError},
    io::{self, BufWriter, Write},
    path::{Path, PathBuf},
    sync::{
        Mutex, PoisonError,
        atomic::{AtomicU64, Ordering},
    },
};

/// Temporary files of this process that are still there.
static TEMPORARIES: Mutex<Vec<PathBuf>> = Mutex::new(Vec::new());

/// An output file that is being written. Dropped without [`Output::commit`], it leaves nothing behind.
#[derive(Debug)]
pub struct Output {
    target: PathBuf,
    temporary: Option<PathBuf>,
    file: BufWriter<File>,
}

impl Output {
    /// Creates the temporary file, so that a target that cannot be written fails before the work starts.
    pub fn create(target: &Path) -> Result<Output, Error> {
        check(target)?;
        let fail = |source| Error::write(target, source);
        // A link is followed: it is its target that is replaced, not the link.
        let target = &fs::canonicalize(target).unwrap_or_else(|_| target.to_owned());
        if is_written_in_place(target) {
            let file = OpenOptions::new().write(true).open(target).map_err(fail)?;
            return Ok(Output { target: target.clone(), temporary: None, file: BufWriter::new(file) });
        }
        remove_abandoned(target);
        let (temporary, file) = create_temporary(target).map_err(fail)?;
        Ok(Output { target: target.clone(), temporary: Some(temporary), file: BufWriter::new(file) })
    }

    /// Writes out what is buffered and puts the file in its place.
    pub fn commit(mut self) -> Result<(), Error> {
        let path = self.target.clone();
        self.finish().map_err(|source| Error::write(&path, source))
    }

    fn finish(&mut self) -> io::Result<()> {
        self.file.flush()?;
        let Some(temporary) = self.temporary.as_ref() else {
            return Ok(());
        };
        self.file.get_ref().sync_all()?;
        fs::rename(temporary, &self.target)?;
        registered().retain(|p| p != temporary);
        self.temporary = None;
        // The rename itself must survive a power cut; folders that cannot be opened or synced are left to the system.
        if let Ok(folder) = File::open(self.target.parent().filter(|p| p.as_os_str() != "").unwrap_or(Path::new("."))) {
            folder.sync_all().ok();
        }
        Ok(())
    }
}

impl Write for Output {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.file.write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.file.flush()
    }
}

impl Drop for Output {
    fn drop(&mut self) {
        if let Some(temporary) = self.temporary.take() {
            fs::remove_file(&temporary).ok();
            registered().retain(|p| *p != temporary);
        }
    }
}

/// Refuses a target that can be seen not to be writable.
pub fn check(target: &Path) -> Result<(), Error> {
    let fail = |why: &str| Err(Error::write(target, io::Error::other(why)));
    match fs::metadata(target) {
        Ok(meta) if meta.is_dir() => fail("is a folder"),
        Ok(meta) if meta.is_file() && meta.permissions().readonly() => fail("is read-only"),
        Ok(_) => Ok(()),
        Err(_) => match target.parent().filter(|p| p.as_os_str() != "").map(fs::metadata) {
            Some(Err(source)) => Err(Error::write(target, source)),
            Some(Ok(meta)) if !meta.is_dir() => fail("lies in what is no folder"),
            _ => Ok(()),
        },
    }
}

/// Devices and pipes are.
pub fn is_written_in_place(target: &Path) -> bool {
    fs::metadata(target).is_ok_and(|meta| !meta.is_file())
}

/// Writes `bytes` to `path`, whole or not at all.
pub fn write(path: &Path, bytes: &[u8]) -> Result<(), Error> {
    let mut output = Output::create(path)?;
    output.write_all(bytes).map_err(|source| Error::write(path, source))?;
    output.commit()
}

/// Removes the temporary files of all outputs in progress and ends the process: what a signal asks for.
pub fn abandon(exit_code: i32) -> ! {
    // Held to the end, so that no thread begins another, or says that its own could not be put in its place.
    let mut temporaries = registered();
    temporaries.drain(..).for_each(|path| {
        fs::remove_file(path).ok();
    });
    std::process::exit(exit_code)
}

fn registered() -> std::sync::MutexGuard<'static, Vec<PathBuf>> {
    TEMPORARIES.lock().unwrap_or_else(PoisonError::into_inner)
}

/// A new file beside the target, registered and locked.
fn create_temporary(target: &Path) -> io::Result<(PathBuf, File)> {
    loop {
        let path = temporary_name(target)?;
        let file = match OpenOptions::new().write(true).create_new(true).open(&path) {
            // Of a process with the same number on another machine.
            Err(e) if e.kind() == io::ErrorKind::AlreadyExists => continue,
            opened => opened?,
        };
        registered().push(path.clone());
        // Where there are no locks nothing is ever taken for abandoned.
        let taken = matches!(file.try_lock(), Err(TryLockError::WouldBlock));
        if !taken && path.exists() {
            return Ok((path, file));
        }
        // Another process took it for abandoned before it was locked, and removes it.
        registered().retain(|p| *p != path);
    }
}

/// Removes temporary files of this target that nobody holds. What cannot be removed stays, and harms nobody.
fn remove_abandoned(target: &Path) {
    let (Some(folder), Some(name)) = (target.parent(), target.file_name()) else { return };
    let folder = if folder.as_os_str().is_empty() { Path::new(".") } else { folder };
    for entry in fs::read_dir(folder).into_iter().flatten().flatten() {
        if is_temporary_of(name, &entry.file_name())
            && let Ok(file) = OpenOptions::new().write(true).open(entry.path())
            && file.try_lock().is_ok()
        {
            fs::remove_file(entry.path()).ok();
        }
    }
}

/// Whether [`temporary_name`] could have given `found` for a target named `name`.
fn is_temporary_of(name: &OsStr, found: &OsStr) -> bool {
    let found = found.as_encoded_bytes();
    let numbers = found
        .strip_prefix(b".")
        .and_then(|rest| rest.strip_prefix(name.as_encoded_bytes()))
        .and_then(|rest| rest.strip_prefix(b"."))
        .and_then(|rest| rest.strip_suffix(b".tmp"));
    numbers.is_some_and(|numbers| {
        let parts: Vec<&[u8]> = numbers.split(|byte| *byte == b'-').collect();
        parts.len() == 2 && parts.iter().all(|part| !part.is_empty() && part.iter().all(u8::is_ascii_digit))
    })
}

fn temporary_name(target: &Path) -> io::Result<PathBuf> {
    static COUNTER: AtomicU64 = AtomicU64::new(0);
    let name = target.file_name().ok_or_else(|| io::Error::other("names no file"))?;
    let mut hidden = OsString::from(".");
    hidden.push(name);
    hidden.push(format!(".{}-{}.tmp", std::process::id(), COUNTER.fetch_add(1, Ordering::Relaxed)));
    Ok(target.with_file_name(hidden))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_dropped_output_leaves_the_old_file_and_no_other() {
        let folder = tempfile::tempdir().expect("folder");
        let path = folder.path().join("file");
        write(&path, b"old").expect("writes");
        let mut output = Output::create(&path).expect("creates");
        output.write_all(b"new").expect("buffers");
        drop(output);
        assert_eq!(fs::read(&path).expect("reads"), b"old");
        assert_eq!(fs::read_dir(folder.path()).expect("lists").count(), 1);
    }

    #[test]
    fn a_committed_output_replaces_the_file() {
        let folder = tempfile::tempdir().expect("folder");
        let path = folder.path().join("file");
        write(&path, b"old").expect("writes");
        write(&path, b"new").expect("writes");
        assert_eq!(fs::read(&path).expect("reads"), b"new");
        assert_eq!(fs::read_dir(folder.path()).expect("lists").count(), 1);
    }

    /// Planted errors that this caught: the lock left out, every temporary file of the folder taken.
    #[test]
    fn what_a_killed_process_left_is_removed_and_what_a_live_one_writes_is_not() {
        let folder = tempfile::tempdir().expect("folder");
        let path = |name: &str| folder.path().join(name);
        let names = || {
            let list = fs::read_dir(folder.path()).expect("lists");
            let mut names: Vec<_> = list.map(|e| e.expect("entry").file_name().into_string().expect("UTF-8")).collect();
            names.sort();
            names
        };
        let strangers = [".a.cloud.1-.tmp", ".a.cloud.1-2-3.tmp", ".a.cloud.old.tmp", ".b.cloud.1-2.tmp"];
        for name in strangers.iter().chain(&[".a.cloud.99-0.tmp", ".a.cloud.99-1.tmp"]) {
            fs::write(path(name), b"half").expect("writes");
        }
        let live = Output::create(&path("a.cloud")).expect("creates");
        write(&path("a.cloud"), b"whole").expect("writes beside a live one");
        assert_eq!(names().len(), strangers.len() + 2, "{:?}", names());
        live.commit().expect("is still there");
        let mut expected = strangers.map(str::to_owned).to_vec();
        expected.push("a.cloud".into());
        assert_eq!(names(), expected);
    }

    #[test]
    fn a_full_device_is_an_error_and_stays_a_device() {
        let full = Path::new("/dev/full");
        if full.exists() {
            let message = write(full, &[0; 100]).expect_err("no space").to_string();
            assert!(message.contains("/dev/full"), "{message}");
            assert!(!fs::metadata(full).expect("still there").is_file());
        }
    }

    #[test]
    fn a_target_in_no_folder_is_an_error_at_once() {
        assert!(Output::create(Path::new("no/such/folder/file")).is_err());
        assert!(Output::create(Path::new(".")).is_err());
    }
}

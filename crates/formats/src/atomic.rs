//! Files that are written whole or not at all: a temporary file beside the target is renamed over it.
//!
//! A link is followed, even to a file that does not exist yet: the file that it leads to is replaced, and the link
//! stays. The new file has the permissions of the one that it replaces, and its owner where the system allows that.
//! Devices (`/dev/null`) are written directly, because a rename would replace them. Named pipes and sockets are
//! refused, because opening one can wait for ever.
//!
//! A writer holds a lock on its temporary file. A killed process holds none, on this machine or another, so that the
//! next writer of the same target removes its temporary file; that of a live process stays.

use crate::Error;
use std::{
    ffi::{OsStr, OsString},
    fs::{self, File, OpenOptions, TryLockError},
    io::{self, BufWriter, Write},
    os::unix::fs::{FileTypeExt, MetadataExt, OpenOptionsExt, PermissionsExt, fchown},
    path::{Path, PathBuf},
    sync::{
        Mutex, PoisonError,
        atomic::{AtomicU64, Ordering},
    },
    thread,
    time::{Duration, Instant},
};
use xxhash_rust::xxh3::xxh3_64;

/// Temporary files of this process that exist.
static TEMPORARIES: Mutex<Vec<PathBuf>> = Mutex::new(Vec::new());

/// An output file that is being written. Dropped without [`Output::commit`], it leaves nothing behind.
#[derive(Debug)]
pub struct Output {
    target: PathBuf,
    temporary: Option<PathBuf>,
    file: BufWriter<File>,
}

impl Output {
    /// Creates the temporary file. A target that cannot be written fails here, before the work starts.
    pub fn create(target: &Path) -> Result<Output, Error> {
        check(target)?;
        let fail = |source| Error::write(target, source);
        let target = &destination(target).map_err(fail)?;
        if is_written_in_place(target) {
            let file = OpenOptions::new().write(true).open(target).map_err(fail)?;
            return Ok(Output { target: target.clone(), temporary: None, file: BufWriter::new(file) });
        }
        remove_abandoned(target);
        let (temporary, file) = create_temporary(target).map_err(fail)?;
        Ok(Output { target: target.clone(), temporary: Some(temporary), file: BufWriter::new(file) })
    }

    /// Flushes the buffer and renames the file to its target.
    pub fn commit(mut self) -> Result<(), Error> {
        let renamed = self.settle().and_then(|()| self.rename());
        renamed.map_err(|source| Error::write(&self.target, source))
    }

    /// Flushes the buffer, and returns the path at which the file can be read until it is committed.
    pub fn written(&mut self) -> Result<&Path, Error> {
        self.settle().map_err(|source| Error::write(&self.target, source))?;
        Ok(self.temporary.as_deref().unwrap_or(&self.target))
    }

    /// Writes all bytes to the disk.
    fn settle(&mut self) -> io::Result<()> {
        self.file.flush()?;
        if self.temporary.is_some() { self.file.get_ref().sync_all() } else { Ok(()) }
    }

    /// Renames the file, whose bytes are on the disk, to its target.
    fn rename(&mut self) -> io::Result<()> {
        let Some(temporary) = self.temporary.as_ref() else {
            return Ok(());
        };
        fs::rename(temporary, &self.target)?;
        registered().retain(|p| p != temporary);
        self.temporary = None;
        // The rename must survive a power cut. Where a folder cannot be opened or synced, the system decides.
        if let Ok(folder) = File::open(folder_of(&self.target)) {
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

/// Files of one run that belong together, as an image and its preview. They are renamed while no other group is whose
/// first file lies in the same folder, so that after two simultaneous runs all files are those of one of them.
#[derive(Debug, Default)]
pub struct Group(Vec<Output>);

impl Group {
    /// Adds a file that was written and is not committed yet.
    pub fn add(&mut self, output: Output) {
        self.0.push(output);
    }

    /// Adds a file with these bytes.
    pub fn write(&mut self, path: &Path, bytes: &[u8]) -> Result<(), Error> {
        let mut output = Output::create(path)?;
        output.write_all(bytes).map_err(|source| Error::write(path, source))?;
        self.add(output);
        Ok(())
    }

    /// Renames all files to their targets, or none if one of them cannot be flushed.
    pub fn commit(mut self) -> Result<(), Error> {
        for output in &mut self.0 {
            output.written()?;
        }
        let _lock = self.0.first().and_then(|first| lock_folder(folder_of(&first.target)));
        for output in &mut self.0 {
            output.rename().map_err(|source| Error::write(&output.target, source))?;
        }
        Ok(())
    }
}

/// Locks a folder while files are renamed. None where the system has no locks, or another process holds this one for
/// long.
fn lock_folder(folder: &Path) -> Option<File> {
    let file = File::open(folder).ok()?;
    let start = Instant::now();
    while let Err(TryLockError::WouldBlock) = file.try_lock() {
        if start.elapsed() > PATIENCE {
            return None;
        }
        thread::sleep(Duration::from_millis(1));
    }
    Some(file)
}

/// Longest time that a group waits for another.
const PATIENCE: Duration = Duration::from_secs(5);

/// Refuses a target that is visibly not writable.
pub fn check(target: &Path) -> Result<(), Error> {
    let fail = |why: &str| Err(Error::write(target, io::Error::other(why)));
    match fs::metadata(target) {
        Ok(meta) if meta.is_dir() => fail("is a folder"),
        Ok(meta) if meta.file_type().is_fifo() || meta.file_type().is_socket() => {
            fail("is a pipe or socket, which could wait for ever; name a regular file")
        }
        Ok(meta) if meta.is_file() && meta.permissions().readonly() => fail("is read-only"),
        Ok(_) => Ok(()),
        Err(error) if error.kind() != io::ErrorKind::NotFound => Err(Error::write(target, error)),
        Err(_) => {
            let file = destination(target).map_err(|source| Error::write(target, source))?;
            match fs::metadata(folder_of(&file)) {
                Err(source) => Err(Error::write(target, source)),
                Ok(meta) if !meta.is_dir() => fail("its parent is not a folder"),
                Ok(_) => Ok(()),
            }
        }
    }
}

/// Refuses a target whose folder takes no new file: creates one and removes it.
pub fn probe(target: &Path) -> Result<(), Error> {
    Output::create(target).map(drop)
}

/// True if the target is a device, which a rename would replace.
pub fn is_written_in_place(target: &Path) -> bool {
    fs::metadata(target).is_ok_and(|meta| !meta.is_file())
}

/// The file to which a path leads through links, whether or not it exists.
pub fn destination(path: &Path) -> io::Result<PathBuf> {
    if let Ok(file) = fs::canonicalize(path) {
        return Ok(file);
    }
    let mut here = path.to_owned();
    for _ in 0..MAX_LINKS {
        match fs::read_link(&here) {
            Ok(next) => here = folder_of(&here).join(next),
            Err(_) => return Ok(here),
        }
    }
    Err(io::Error::other("is a link to itself"))
}

/// Most links that are followed one after another, as in the kernel.
const MAX_LINKS: usize = 40;

/// The folder that a file lies in.
pub fn folder_of(path: &Path) -> &Path {
    path.parent().filter(|folder| folder.as_os_str() != "").unwrap_or(Path::new("."))
}

/// Writes `bytes` to `path`, whole or not at all.
pub fn write(path: &Path, bytes: &[u8]) -> Result<(), Error> {
    let mut output = Output::create(path)?;
    output.write_all(bytes).map_err(|source| Error::write(path, source))?;
    output.commit()
}

/// Removes the temporary files of all outputs in progress and ends the process, as a signal asks.
pub fn abandon(exit_code: i32) -> ! {
    // The lock is held to the end, so that no other thread starts a file, or reports that its own cannot be renamed.
    let mut temporaries = registered();
    temporaries.drain(..).for_each(|path| {
        fs::remove_file(path).ok();
    });
    std::process::exit(exit_code)
}

fn registered() -> std::sync::MutexGuard<'static, Vec<PathBuf>> {
    TEMPORARIES.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Creates a file beside the target, registered and locked.
fn create_temporary(target: &Path) -> io::Result<(PathBuf, File)> {
    let replaced = fs::metadata(target).ok();
    // Others must not read the content of a private file, not even while it is written.
    let mode = replaced.as_ref().map_or(0o666, |old| old.permissions().mode() & 0o777);
    loop {
        let path = temporary_name(target)?;
        // The lock is held until the new file is in the list, so that a signal never finds it missing there.
        let mut temporaries = registered();
        let file = match OpenOptions::new().write(true).create_new(true).mode(mode).open(&path) {
            // A process with the same number on another machine has it.
            Err(e) if e.kind() == io::ErrorKind::AlreadyExists => continue,
            opened => opened?,
        };
        temporaries.push(path.clone());
        drop(temporaries);
        // Where the system has no locks, no file is ever taken for abandoned.
        let taken = matches!(file.try_lock(), Err(TryLockError::WouldBlock));
        if !taken && path.exists() {
            if let Some(old) = &replaced {
                keep_owner_and_mode(&file, old);
            }
            return Ok((path, file));
        }
        // Another process took the file for abandoned before it was locked, and removes it.
        registered().retain(|p| *p != path);
    }
}

/// Gives the new file the owner and the permissions of the one that it replaces, where the system allows it.
fn keep_owner_and_mode(file: &File, old: &fs::Metadata) {
    if file.metadata().is_ok_and(|new| (new.uid(), new.gid()) != (old.uid(), old.gid())) {
        fchown(file, Some(old.uid()), Some(old.gid())).or_else(|_| fchown(file, None, Some(old.gid()))).ok();
    }
    file.set_permissions(fs::Permissions::from_mode(old.permissions().mode() & 0o777)).ok();
}

/// Removes temporary files of this target that no process has locked. Those that cannot be removed stay and do no harm.
fn remove_abandoned(target: &Path) {
    let Some(name) = target.file_name() else { return };
    let stem = temporary_stem(name);
    for entry in fs::read_dir(folder_of(target)).into_iter().flatten().flatten() {
        // A pipe of such a name is no temporary file, and opening it would wait for its other end.
        if is_temporary_of(&stem, &entry.file_name())
            && entry.file_type().is_ok_and(|kind| kind.is_file())
            && let Ok(file) = OpenOptions::new().write(true).open(entry.path())
            && file.try_lock().is_ok()
        {
            fs::remove_file(entry.path()).ok();
        }
    }
}

/// True if [`temporary_name`] could have made `found` for a target with this stem.
fn is_temporary_of(stem: &OsStr, found: &OsStr) -> bool {
    let found = found.as_encoded_bytes();
    let numbers = found
        .strip_prefix(b".")
        .and_then(|rest| rest.strip_prefix(stem.as_encoded_bytes()))
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
    hidden.push(temporary_stem(name));
    hidden.push(format!(".{}-{}.tmp", std::process::id(), COUNTER.fetch_add(1, Ordering::Relaxed)));
    Ok(target.with_file_name(hidden))
}

/// The stem of the names of a target's temporary files: its name, or a hash of a long one, so that the file system
/// takes the temporary name.
fn temporary_stem(name: &OsStr) -> OsString {
    let bytes = name.as_encoded_bytes();
    if bytes.len() <= LONG_NAME { name.to_owned() } else { format!("{:016x}", xxh3_64(bytes)).into() }
}

/// Longer names, in bytes, are hashed. The shortest limit in use is 143 bytes (eCryptfs).
const LONG_NAME: usize = 100;

#[cfg(test)]
mod tests;

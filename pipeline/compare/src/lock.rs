//! The lock that lets one `--accept` replace a reference at a time. Without it, another one would log a change from a
//! reference that was already replaced.
//!
//! The lock is on the file itself. An acceptance replaces the file, so that a process that had to wait has to check
//! whether it locked the file that is there now. The lock ends with the process that holds it.

use std::fs::{self, File, TryLockError};
use std::os::unix::fs::MetadataExt;
use std::path::Path;
use std::thread::sleep;
use std::time::{Duration, Instant};

use cli::Failure;
use formats::ImageError;

use crate::inputs::named;

/// The longest time to wait for another acceptance.
pub(crate) const PATIENCE: Duration = Duration::from_secs(300);
/// The time between two attempts.
const STEP: Duration = Duration::from_millis(10);

/// A lock that is held until it is dropped.
#[derive(Debug)]
pub(crate) struct Lock {
    _file: File,
}

impl Lock {
    /// Takes the lock. `tell` is called if it has to wait, or if the file system has no locks.
    pub(crate) fn take(path: &Path, patience: Duration, tell: impl Fn(String)) -> Result<Lock, Failure> {
        let (start, name) = (Instant::now(), path.display());
        let mut told = false;
        loop {
            let file = open(path).map_err(named(path))?;
            match file.try_lock() {
                Ok(()) if is_still(path, &file) => return Ok(Lock { _file: file }),
                // The file was replaced between opening and locking, so this is the lock of a file that is gone.
                Ok(()) => {}
                Err(TryLockError::WouldBlock) => {
                    if !told {
                        tell(format!("{name}: waiting for another --accept for at most {} s", patience.as_secs()));
                    }
                    told = true;
                    sleep(STEP);
                }
                Err(TryLockError::Error(error)) => {
                    tell(format!("warning: {name}: the file cannot be locked ({error}); accept one image at a time"));
                    return Ok(Lock { _file: file });
                }
            }
            if start.elapsed() > patience {
                return Err(Failure::usage(format!(
                    "{name}: another --accept has held it for {} s; wait until it has ended, or end it, then run again",
                    patience.as_secs()
                )));
            }
        }
    }
}

/// Opens a file for writing if that is allowed, because network file systems lock no others.
fn open(path: &Path) -> Result<File, ImageError> {
    if !fs::metadata(path)?.is_file() {
        return Err(ImageError::NotAFile);
    }
    Ok(File::options().read(true).write(true).open(path).or_else(|_| File::open(path))?)
}

/// Whether an open file is the one at this path.
fn is_still(path: &Path, file: &File) -> bool {
    let identity = |facts: fs::Metadata| (facts.dev(), facts.ino());
    fs::metadata(path).is_ok_and(|now| file.metadata().is_ok_and(|opened| identity(now) == identity(opened)))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn silent(_: String) {}

    /// Seen to catch: no bound, so that it waited for ever.
    #[test]
    fn a_lock_is_waited_for_but_not_for_ever() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("reference.exr");
        fs::write(&path, "old").unwrap();
        let held = Lock::take(&path, PATIENCE, silent).unwrap();
        let message = Lock::take(&path, Duration::from_millis(30), silent).unwrap_err().message;
        assert!(message.contains("reference.exr: another --accept has held it"), "{message}");
        let waiter = std::thread::spawn({
            let path = path.clone();
            move || Lock::take(&path, PATIENCE, silent).map(|lock| is_still(&path, &lock._file))
        });
        sleep(Duration::from_millis(30));
        // Like an acceptance, this replaces the locked file by another.
        fs::write(folder.path().join("new"), "new").unwrap();
        fs::rename(folder.path().join("new"), &path).unwrap();
        drop(held);
        assert!(waiter.join().unwrap().unwrap(), "the lock of a file that is gone");
    }

    #[test]
    fn folders_and_missing_files_are_refused() {
        let folder = tempfile::tempdir().unwrap();
        for path in [folder.path().to_owned(), folder.path().join("missing.exr")] {
            let message = Lock::take(&path, PATIENCE, silent).unwrap_err().message;
            assert!(message.contains("cannot be read"), "{message}");
        }
    }
}

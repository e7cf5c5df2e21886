//! One `--accept` of a reference at a time: another would log a change from a reference that is no longer there.
//!
//! The lock is on the file itself. An acceptance puts another file in its place, so who had to wait looks again which file
//! is there. It ends with the process that holds it.

use std::fs::{self, File, TryLockError};
use std::os::unix::fs::MetadataExt;
use std::path::Path;
use std::thread::sleep;
use std::time::{Duration, Instant};

use cli::Failure;
use formats::ImageError;

/// Longest time that another acceptance is waited for.
pub(crate) const PATIENCE: Duration = Duration::from_secs(300);
/// Time between two looks.
const STEP: Duration = Duration::from_millis(10);

/// Held until it is dropped.
#[derive(Debug)]
pub(crate) struct Lock {
    _file: File,
}

impl Lock {
    /// Takes the lock, and tells if it has to wait for it or if there are none.
    pub(crate) fn take(path: &Path, patience: Duration, tell: impl Fn(String)) -> Result<Lock, Failure> {
        let (start, name) = (Instant::now(), path.display());
        let mut told = false;
        loop {
            let file =
                open(path).map_err(|source| ImageError::File { path: path.to_owned(), source: Box::new(source) })?;
            match file.try_lock() {
                Ok(()) if is_still(path, &file) => return Ok(Lock { _file: file }),
                // It was replaced between opening and locking, so this is the lock of a file that is gone.
                Ok(()) => {}
                Err(TryLockError::WouldBlock) => {
                    if !told {
                        tell(format!("{name}: waiting for another --accept, for {} s at most", patience.as_secs()));
                    }
                    told = true;
                    sleep(STEP);
                }
                Err(TryLockError::Error(error)) => {
                    tell(format!("warning: {name}: cannot be locked ({error}); accept one image at a time"));
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

/// For writing where that is allowed: network file systems lock nothing else.
fn open(path: &Path) -> Result<File, ImageError> {
    if !fs::metadata(path)?.is_file() {
        return Err(ImageError::NotAFile);
    }
    Ok(File::options().read(true).write(true).open(path).or_else(|_| File::open(path))?)
}

fn is_still(path: &Path, file: &File) -> bool {
    let place = |facts: fs::Metadata| (facts.dev(), facts.ino());
    fs::metadata(path).is_ok_and(|there| file.metadata().is_ok_and(|here| place(there) == place(here)))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn silent(_: String) {}

    /// Caught: no bound, so that it waited for ever.
    #[test]
    fn it_is_waited_for_and_not_for_ever() {
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
        // As an acceptance does: another file takes the place of the one that is locked.
        fs::write(folder.path().join("new"), "new").unwrap();
        fs::rename(folder.path().join("new"), &path).unwrap();
        drop(held);
        assert!(waiter.join().unwrap().unwrap(), "the lock of a file that is gone");
    }

    #[test]
    fn what_is_no_file_is_refused() {
        let folder = tempfile::tempdir().unwrap();
        for path in [folder.path().to_owned(), folder.path().join("missing.exr")] {
            let message = Lock::take(&path, PATIENCE, silent).unwrap_err().message;
            assert!(message.contains("cannot be read"), "{message}");
        }
    }
}

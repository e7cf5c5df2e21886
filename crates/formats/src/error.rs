//! Errors of files.

use std::{
    io,
    path::{Path, PathBuf},
};

/// A file that cannot be read or written; the message names it.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    #[error("{}: cannot read: {source}", path.display())]
    Read { path: PathBuf, source: io::Error },
    #[error("{}: cannot write: {source}", path.display())]
    Write { path: PathBuf, source: io::Error },
    /// The content is damaged or of another kind.
    #[error("{}: {what}", path.display())]
    Invalid { path: PathBuf, what: String },
}

impl Error {
    pub fn read(path: &Path, source: io::Error) -> Error {
        Error::Read { path: path.to_owned(), source }
    }

    pub fn write(path: &Path, source: io::Error) -> Error {
        Error::Write { path: path.to_owned(), source }
    }

    pub fn invalid(path: &Path, what: impl Into<String>) -> Error {
        Error::Invalid { path: path.to_owned(), what: what.into() }
    }
}

//! The errors of replicates.

use std::path::{Path, PathBuf};

use formats::ImageError;

/// Why replicates cannot be judged.
#[derive(Debug, thiserror::Error)]
pub enum ReplicateError {
    /// An image cannot be read.
    #[error(transparent)]
    Image(#[from] ImageError),
    /// A file cannot be written, or a folder cannot be read.
    #[error(transparent)]
    File(#[from] formats::Error),
    /// An image, a folder or a summary is not valid as a part of this test: `what` is the fault, and its remedy.
    #[error("{}: {what}", path.display())]
    Invalid { path: PathBuf, what: String },
}

impl ReplicateError {
    pub(super) fn invalid(path: &Path, what: impl Into<String>) -> ReplicateError {
        ReplicateError::Invalid { path: path.to_owned(), what: what.into() }
    }

    /// Two images were made from one cloud; `other` is an image, or the reference that contains one.
    pub(super) fn same_cloud(path: &Path, other: &Path) -> ReplicateError {
        let other = other.display();
        let what = format!("it is from the same cloud as {other}, so not independent; use a cloud with another seed");
        ReplicateError::invalid(path, what)
    }
}

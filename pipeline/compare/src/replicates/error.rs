//! Why replicates cannot be judged.

use std::path::PathBuf;

use formats::ImageError;

/// Every one is exit code 2.
#[derive(Debug, thiserror::Error)]
pub enum ReplicateError {
    /// An image cannot be read.
    #[error(transparent)]
    Image(#[from] ImageError),
    /// A file cannot be written, or a folder not be read.
    #[error(transparent)]
    File(#[from] formats::Error),
    /// Too few for a test.
    #[error(
        "{}: {found} replicates (.exr), but {wanted} are the fewest; render more, each from a cloud with a seed of its own",
        folder.display()
    )]
    TooFew {
        /// Where they were looked for.
        folder: PathBuf,
        /// How many there are.
        found: usize,
        /// How many it takes.
        wanted: usize,
    },
    /// One image does not belong to the others, or not to the reference.
    #[error("{}: {what} (the reference is {reference})", path.display())]
    Foreign {
        /// The image.
        path: PathBuf,
        /// The difference and the way out.
        what: String,
        /// What it was compared with.
        reference: String,
    },
    /// Two images of one cloud.
    #[error(
        "{}: made from the same cloud as {other}, so they are not independent; sample a cloud with another --seed for each",
        path.display()
    )]
    SameCloud {
        /// The image.
        path: PathBuf,
        /// The other, or the reference that holds it.
        other: String,
    },
    /// The header does not say which cloud or scene it was.
    #[error("{}: the header has no {attribute}, so nobody knows whether replicates are independent; use images of gather", path.display())]
    NoOrigin {
        /// The image.
        path: PathBuf,
        /// The attribute that is missing.
        attribute: &'static str,
    },
    /// The stored figures are not what they should be.
    #[error("{}: {what}; make it again with `compare --summarise`", path.display())]
    Summary {
        /// The file.
        path: PathBuf,
        /// What is wrong.
        what: String,
    },
    /// The summary would be written among images.
    #[error(
        "{}: a summary beside images such as {} would be read instead of them; give --summarise a folder without images",
        folder.display(),
        image.display()
    )]
    HoldsImages {
        /// Where it would be written.
        folder: PathBuf,
        /// One of the images there.
        image: PathBuf,
    },
    /// A reference that is no number.
    #[error("{}: holds {count} samples that are not finite, and a reference must not; render it again", path.display())]
    NotFinite {
        /// The image.
        path: PathBuf,
        /// How many.
        count: usize,
    },
}

//! Errors of a measurement.

use std::{
    fmt, io,
    path::{Path, PathBuf},
};

/// The reason why a measurement ended.
#[derive(Debug)]
pub enum Error {
    /// The command line, or what it names, cannot be used.
    Usage(String),
    /// A file or folder could not be read or written.
    File { path: PathBuf, source: io::Error },
    /// A program could not be started.
    Start { program: PathBuf, source: io::Error },
    /// A program ended with an exit code other than 0; none if a signal ended it.
    Failed { program: PathBuf, arguments: Vec<String>, code: Option<i32>, message: String },
    /// A program wrote an invalid file.
    Unreadable { path: PathBuf, message: String },
}

impl Error {
    /// An error of the file at `path`, for `map_err`.
    pub fn file(path: &Path) -> impl FnOnce(io::Error) -> Error {
        let path = path.to_owned();
        move |source| Error::File { path, source }
    }

    /// The message of a program that refused its arguments or its input (exit code 2).
    pub fn refusal(&self) -> Option<&str> {
        match self {
            Error::Failed { code: Some(2), message, .. } => Some(message),
            _ => None,
        }
    }
}

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Error::Usage(message) => write!(f, "{message}"),
            Error::File { path, source } => write!(f, "{}: {source}", path.display()),
            Error::Start { program, source } => {
                write!(f, "{}: cannot be started: {source}; build it (`make build`)", program.display())
            }
            Error::Failed { program, arguments, code, message } => {
                let how = code.map_or("was killed".into(), |c| format!("ended with {c}"));
                write!(f, "{} {} {how}: {message}", program.display(), arguments.join(" "))
            }
            Error::Unreadable { path, message } => write!(f, "{}: {message}", path.display()),
        }
    }
}

impl std::error::Error for Error {}

//! Media as they are named on a command line.

use bssrdf::{Medium, MediumError, built_in};
use std::fs;

/// Why there is no such medium.
#[derive(Debug, thiserror::Error)]
pub enum ReadMediumError {
    #[error("{0}")]
    Name(MediumError),
    #[error("{path}: {source}")]
    File { path: String, source: MediumError },
    #[error("{path}: cannot read: {source}")]
    Read { path: String, source: std::io::Error },
}

/// A medium by its built-in name, or from a file, whose name ends in `.json` or has a slash.
pub fn read_medium(name: &str) -> Result<Medium, ReadMediumError> {
    let is_file = name.ends_with(".json") || name.contains('/');
    if !is_file {
        return built_in(name).map_err(ReadMediumError::Name);
    }
    let text = fs::read_to_string(name).map_err(|source| ReadMediumError::Read { path: name.into(), source })?;
    Medium::from_json(&text).map_err(|source| ReadMediumError::File { path: name.into(), source })
}

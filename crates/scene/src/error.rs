//! What can be wrong with a scene or a view.

use std::path::PathBuf;

/// A scene or view that cannot be used. The message names the file and the field and, where there is one, the way out.
#[derive(Debug, thiserror::Error)]
pub enum SceneError {
    #[error("{}: {source}", path.display())]
    Read { path: PathBuf, source: std::io::Error },
    #[error("{}: {what}", path.display())]
    Invalid { path: PathBuf, what: String },
}

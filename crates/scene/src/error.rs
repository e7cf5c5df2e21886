//! Errors of scenes and views.

use crate::unhonoured::{first_of, quoted};
use std::path::PathBuf;

/// A scene or view that cannot be used. The message names the file and the field and, where the file can be mended,
/// how.
#[derive(Debug, thiserror::Error)]
pub enum SceneError {
    #[error("{}: {source}", path.display())]
    Read { path: PathBuf, source: std::io::Error },
    #[error("{}: {what}", path.display())]
    Invalid { path: PathBuf, what: String },
    /// There is no such pose.
    #[error("{}: {what}", path.display())]
    Pose { path: PathBuf, what: String },
    #[error("{}: the mesh is too large for float32 coordinates", path.display())]
    TooLarge { path: PathBuf },
}

/// No surface that the file marks as a volume has a triangle left. The message names the materials and the reason.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("no surface that the file marks as a volume is left ({names}): {why}")]
pub struct LostVolumes {
    names: String,
    why: String,
}

impl LostVolumes {
    /// The number of names that the message has.
    const NAMED: usize = 3;

    /// The materials of these names, at least one, lost `count` triangles without area, `rounded` of them by rounding.
    pub(crate) fn new(names: &[&str], count: u64, rounded: u64) -> LostVolumes {
        let names = first_of(names.iter().map(|name| quoted(name)), Self::NAMED);
        let why = match (count, rounded) {
            (0, _) => "it has no triangles; give it some".into(),
            (_, 0) => format!("all {count} triangles have no area (scale 0?); repair the mesh and export again"),
            _ => format!(
                "{rounded} of {count} triangles have no area once positions are rounded to float32 about the middle of \
                 so wide a scene; leave out what is far away"
            ),
        };
        LostVolumes { names, why }
    }
}

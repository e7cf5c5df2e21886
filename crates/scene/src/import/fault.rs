//! Errors of a file.

use gltf::json::Index;

/// A fault of the file, not yet with the file's name.
pub(super) type Fault = String;

/// The result of reading a part of the file.
pub(super) type Result<T, E = Fault> = std::result::Result<T, E>;

/// Why a file makes no scene.
pub(super) enum Refusal {
    Invalid(Fault),
    /// The file has no such animation.
    NoPose(Fault),
    /// Coordinates in float32 cannot hold the mesh.
    TooLarge,
}

impl From<Fault> for Refusal {
    fn from(fault: Fault) -> Refusal {
        Refusal::Invalid(fault)
    }
}

/// The element of a list of the file at an index that the file gives.
pub(super) fn get<'a, T>(list: &'a [T], index: &Index<T>, field: &str) -> Result<&'a T> {
    let i = index.value();
    list.get(i).ok_or_else(|| format!("{field}: index {i} is out of range, there are {}", list.len()))
}

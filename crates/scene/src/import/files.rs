//! The files of a scene: its own, data URIs, and files in its folder.

use super::fault::Result;
use base64::{
    Engine, alphabet,
    engine::{DecodePaddingMode, GeneralPurpose, GeneralPurposeConfig},
};
use std::{
    collections::HashMap,
    io,
    path::{Component, Path, PathBuf},
    rc::{Rc, Weak},
};

/// Base64 with or without padding, since writers differ.
const BASE64: GeneralPurpose = GeneralPurpose::new(
    &alphabet::STANDARD,
    GeneralPurposeConfig::new().with_decode_padding_mode(DecodePaddingMode::Indifferent),
);

/// Reads a regular file. A pipe or a device could be endless.
pub(crate) fn read(path: &Path) -> io::Result<Vec<u8>> {
    if !std::fs::metadata(path)?.is_file() {
        return Err(io::Error::new(io::ErrorKind::InvalidInput, "not a regular file"));
    }
    std::fs::read(path)
}

/// Resolves URIs relative to a scene, and records the files that were read.
pub(super) struct Files {
    folder: PathBuf,
    /// By canonical path. A file that many buffers name is read once, while one of them holds it.
    known: HashMap<PathBuf, Weak<Vec<u8>>>,
    /// Paths of all files that were read, the scene's own first.
    pub read: Vec<PathBuf>,
}

impl Files {
    pub fn new(scene: &Path) -> Self {
        let folder = scene.parent().unwrap_or(Path::new("")).to_owned();
        Files { folder, known: HashMap::new(), read: vec![scene.to_owned()] }
    }

    /// The path of a URI, and its canonical path. A link to its own folder gives a file any number of paths, but one
    /// canonical path.
    pub fn locate(&self, uri: &str) -> Result<(PathBuf, PathBuf)> {
        let path = self.folder.join(relative_path(uri)?);
        let canonical = path.canonicalize().unwrap_or_else(|_| path.clone());
        Ok((path, canonical))
    }

    /// The bytes of a data URI, or of a file in the scene's folder or below.
    pub fn resolve(&mut self, uri: &str) -> Result<Rc<Vec<u8>>> {
        if let Some(data) = uri.strip_prefix("data:") {
            let encoded = data.split_once(";base64,").ok_or("a data URI without `;base64,` is not supported")?.1;
            return BASE64.decode(encoded).map(Rc::new).map_err(|e| format!("the data URI is not base64: {e}"));
        }
        let (path, canonical) = self.locate(uri)?;
        if let Some(data) = self.known.get(&canonical).and_then(Weak::upgrade) {
            return Ok(data);
        }
        let data = read(&path).map(Rc::new).map_err(|e| {
            format!("{}: {e}; a .gltf needs the files it names beside it, a .glb has them inside", path.display())
        })?;
        if self.known.insert(canonical, Rc::downgrade(&data)).is_none() {
            self.read.push(path);
        }
        Ok(data)
    }
}

/// The relative path of a URI, without `.` components. Refuses a path that leads out of the folder.
fn relative_path(uri: &str) -> Result<PathBuf> {
    let decoded =
        percent_encoding::percent_decode_str(uri).decode_utf8().map_err(|_| format!("`{uri}` is not UTF-8"))?;
    let outside = || format!("`{decoded}` is not a file in the scene's folder; copy it there and export again");
    let mut relative = PathBuf::new();
    for part in Path::new(decoded.as_ref()).components() {
        match part {
            Component::Normal(name) => relative.push(name),
            Component::CurDir => {}
            _ => return Err(outside()),
        }
    }
    if relative.as_os_str().is_empty() || decoded.contains("://") {
        return Err(outside());
    }
    Ok(relative)
}

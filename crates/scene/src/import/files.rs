//! Files that a scene is made of: itself, data URIs, and what lies in its folder.

use super::Fault;
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

/// Base64 with or without its padding: writers differ.
const BASE64: GeneralPurpose = GeneralPurpose::new(
    &alphabet::STANDARD,
    GeneralPurposeConfig::new().with_decode_padding_mode(DecodePaddingMode::Indifferent),
);

/// Reads a regular file; a pipe or a device might never end.
pub(crate) fn read(path: &Path) -> io::Result<Vec<u8>> {
    if !std::fs::metadata(path)?.is_file() {
        return Err(io::Error::new(io::ErrorKind::InvalidInput, "not a regular file"));
    }
    std::fs::read(path)
}

/// Resolves URIs relative to a scene, and keeps account of what was read.
pub(super) struct Files {
    folder: PathBuf,
    /// By their places. Many buffers may name one file: it is read once, as long as one of them has it.
    known: HashMap<PathBuf, Weak<Vec<u8>>>,
    /// Paths of all that was read, the scene's own first.
    read: Vec<PathBuf>,
}

impl Files {
    pub fn new(scene: &Path) -> Self {
        let folder = scene.parent().unwrap_or(Path::new("")).to_owned();
        Files { folder, known: HashMap::new(), read: vec![scene.to_owned()] }
    }

    /// Paths of all that was read, each once and in the order of reading, the scene's own first.
    pub fn read(&self) -> &[PathBuf] {
        &self.read
    }

    /// The path that a URI means, and where its file is when all links are followed: a link to the folder that it lies in
    /// gives one file any number of paths.
    pub fn place(&self, uri: &str) -> Result<(PathBuf, PathBuf), Fault> {
        let path = self.folder.join(relative_path(uri)?);
        let place = path.canonicalize().unwrap_or_else(|_| path.clone());
        Ok((path, place))
    }

    /// The bytes of a data URI, or of a file in the scene's folder or below.
    pub fn resolve(&mut self, uri: &str) -> Result<Rc<Vec<u8>>, Fault> {
        if let Some(data) = uri.strip_prefix("data:") {
            let encoded = data.split_once(";base64,").ok_or("a data URI without `;base64,` is not read")?.1;
            return BASE64.decode(encoded).map(Rc::new).map_err(|e| format!("the data URI is not base64: {e}"));
        }
        let (path, place) = self.place(uri)?;
        if let Some(data) = self.known.get(&place).and_then(Weak::upgrade) {
            return Ok(data);
        }
        let data = read(&path).map(Rc::new).map_err(|e| {
            format!("{}: {e}; a .gltf needs the files it names beside it, a .glb has them inside", path.display())
        })?;
        if self.known.insert(place, Rc::downgrade(&data)).is_none() {
            self.read.push(path);
        }
        Ok(data)
    }
}

/// The path that a URI means, without `.` parts; refuses what leads out of the folder.
fn relative_path(uri: &str) -> Result<PathBuf, Fault> {
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

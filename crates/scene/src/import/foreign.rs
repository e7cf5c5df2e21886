//! Files of other formats than glTF: named, with the way to glTF, before a parser of JSON stumbles over them.

use std::path::Path;

/// How to convert what Blender reads.
const BLENDER: &str = "open it in Blender and export glTF (File > Export > glTF 2.0)";
/// How to convert meshes without materials.
const MESH: &str = "convert it with Blender (File > Export > glTF 2.0), or with trimesh for Python: \
                    trimesh.load('IN').export('OUT.glb')";
/// How to convert what Blender does not read.
const ASSIMP: &str = "convert it with assimp: assimp export IN OUT.glb";
/// How to convert USD.
const USD: &str = "import it in Blender (File > Import > Universal Scene Description) and export glTF";

/// Formats that their first bytes tell.
const BY_MAGIC: &[(&[u8], &str, &str)] = &[
    (b"Kaydara FBX Binary", "FBX", BLENDER),
    (b"; FBX", "FBX", BLENDER),
    (b"BLENDER", "a Blender file", BLENDER),
    (b"ply\n", "PLY", MESH),
    (b"ply\r", "PLY", MESH),
    (b"solid ", "STL", MESH),
    (b"PXR-USDC", "USD", USD),
    (b"#usda", "USD", USD),
    (b"DRACO", "a bare Draco stream", "convert it with Draco's own draco_transcoder, or export glTF"),
    (b"xof ", "DirectX X", ASSIMP),
    (b"OFF\n", "OFF", MESH),
    (b"#VRML", "VRML", ASSIMP),
    (b"ISO-10303-21", "STEP", "mesh it in a CAD program, for example FreeCAD, and export glTF"),
    (b"3D Geometry File Format", "Rhino 3DM", "export glTF from Rhino"),
    (b"b3dm", "a tile of 3D Tiles", "extract the glTF inside, for example with 3d-tiles-tools b3dmToGlb"),
];

/// Formats that the ending of the name tells, where the first bytes told none.
const BY_NAME: &[(&str, &str, &str)] = &[
    ("obj", "OBJ", MESH),
    ("mtl", "the materials of an OBJ", "give the OBJ's glTF instead"),
    ("stl", "STL", MESH),
    ("ply", "PLY", MESH),
    ("off", "OFF", MESH),
    ("fbx", "FBX", BLENDER),
    ("blend", "a Blender file", BLENDER),
    ("usd", "USD", USD),
    ("usda", "USD", USD),
    ("usdc", "USD", USD),
    ("usdz", "USD", USD),
    ("3ds", "3DS", ASSIMP),
    ("dae", "COLLADA", ASSIMP),
    ("abc", "Alembic", BLENDER),
    ("x3d", "X3D", BLENDER),
    ("wrl", "VRML", ASSIMP),
    ("lwo", "LightWave", ASSIMP),
    ("step", "STEP", "mesh it in a CAD program, for example FreeCAD, and export glTF"),
    ("stp", "STEP", "mesh it in a CAD program, for example FreeCAD, and export glTF"),
    ("3dm", "Rhino 3DM", "export glTF from Rhino"),
    ("3mf", "3MF", MESH),
    ("max", "3ds Max", "export glTF from 3ds Max"),
    ("ma", "Maya", "export FBX from Maya, then glTF from Blender"),
    ("mb", "Maya", "export FBX from Maya, then glTF from Blender"),
    ("c4d", "Cinema 4D", "export glTF from Cinema 4D"),
    ("vrm", "VRM", "rename it to .glb"),
    ("zip", "a packed folder", "unpack it and give the .gltf or .glb inside"),
];

/// What the file is and how to convert it, if it is of a known format other than glTF.
pub(super) fn name(bytes: &[u8], path: &Path) -> Option<String> {
    if bytes.is_empty() {
        return Some("not a glTF file: it is empty".into());
    }
    let text = bytes.trim_ascii_start();
    if bytes.starts_with(b"glTF") || text.starts_with(b"{") || text.starts_with(b"\xef\xbb\xbf{") {
        return None;
    }
    let extension = path.extension().and_then(|e| e.to_str()).unwrap_or_default().to_ascii_lowercase();
    let named = || BY_NAME.iter().find(|(ending, ..)| *ending == extension).map(|(_, format, way)| (*format, *way));
    let (format, way) = by_content(bytes).or_else(named)?;
    Some(format!("not a glTF file (.glb or .gltf), but {format}; {way}"))
}

/// The format and the way out by the content of the file.
fn by_content(bytes: &[u8]) -> Option<(&'static str, &'static str)> {
    if let Some((_, format, way)) = BY_MAGIC.iter().find(|(magic, ..)| bytes.starts_with(magic)) {
        return Some((format, way));
    }
    if bytes.starts_with(b"PK\x03\x04") {
        return Some(packed(bytes));
    }
    if bytes.starts_with(b"<") {
        let is_in = |word: &[u8]| bytes[..bytes.len().min(1024)].windows(word.len()).any(|w| w == word);
        let formats: [(&[u8], _); 3] = [
            (b"<COLLADA", ("COLLADA", ASSIMP)),
            (b"<X3D", ("X3D", BLENDER)),
            (b"<html", ("a web page", "download the file itself: this is the page about it")),
        ];
        return formats.into_iter().find(|(word, _)| is_in(word)).map(|(_, what)| what);
    }
    if bytes.starts_with(b"version https://git-lfs") {
        return Some(("a pointer of Git LFS", "fetch the file itself with `git lfs pull`"));
    }
    is_binary_stl(bytes).then_some(("STL", MESH))
}

/// What an archive is by the name of its first file.
fn packed(bytes: &[u8]) -> (&'static str, &'static str) {
    const NAME: usize = 30;
    let name = bytes.get(NAME..bytes.len().min(NAME + 100)).unwrap_or_default();
    let has = |word: &[u8]| name.windows(word.len()).any(|w| w == word);
    if has(b".usd") {
        return ("USD", USD);
    }
    if has(b"3dmodel") || has(b"[Content_Types].xml") {
        return ("3MF", MESH);
    }
    ("a packed folder", "unpack it and give the .gltf or .glb inside")
}

/// A binary STL has no mark, but its length follows from its number of triangles.
fn is_binary_stl(bytes: &[u8]) -> bool {
    const HEADER: u64 = 84;
    const TRIANGLE: u64 = 50;
    let count = bytes.get(80..84).and_then(|b| b.try_into().ok()).map(u32::from_le_bytes);
    count.is_some_and(|n| n > 0 && HEADER + TRIANGLE * u64::from(n) == bytes.len() as u64)
}

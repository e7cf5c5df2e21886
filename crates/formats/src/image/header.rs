//! The attributes of an OpenEXR header as bytes. Each is a name, a zero, a type, a zero, a size and a value; a zero
//! ends the list.

use super::types::{Attribute, ImageError};

/// Bytes of the magic number and of the version field, which come first.
const PREAMBLE: usize = 8;
/// The bit of the version field that states several parts.
const SEVERAL_PARTS: u8 = 0x10;

/// Attributes that describe the layout of the file. The library writes them; an image never has them.
pub(super) const LAYOUT: [&str; 11] = [
    "channels",
    "chunkCount",
    "compression",
    "dataWindow",
    "displayWindow",
    "lineOrder",
    "maxSamplesPerPixel",
    "name",
    "tiles",
    "type",
    "version",
];

pub(super) const PIXEL_ASPECT: &str = "pixelAspectRatio";
pub(super) const SCREEN_CENTER: &str = "screenWindowCenter";
pub(super) const SCREEN_WIDTH: &str = "screenWindowWidth";

/// The text between the name of an attribute and the number of the part that disagrees about it.
const OF_PART: &str = " of part ";

/// Attributes that every file has, with the bytes of their usual values.
const USUAL: [(&str, &[u8]); 3] =
    [(PIXEL_ASPECT, &1f32.to_le_bytes()), (SCREEN_CENTER, &[0; 8]), (SCREEN_WIDTH, &1f32.to_le_bytes())];

/// The types that readers expect, each with standard attributes of that type (openexr.com, "Standard Attributes").
const STANDARD: &[(&str, &[&str])] = &[
    ("box2i", &["originalDataWindow"]),
    ("chromaticities", &["chromaticities"]),
    ("deepImageState", &["deepImageState"]),
    ("envmap", &["envmap"]),
    ("float", &["altitude", "aperture", "dwaCompressionLevel", "expTime", "far", "focus", "isoSpeed", "latitude"]),
    ("float", &["fieldOfViewHorizontal", "fieldOfViewVertical", "longitude", "near", PIXEL_ASPECT, SCREEN_WIDTH]),
    ("float", &["utcOffset", "whiteLuminance", "xDensity"]),
    ("keycode", &["keyCode"]),
    ("m44f", &["worldToCamera", "worldToNDC"]),
    ("preview", &["preview"]),
    ("rational", &["framesPerSecond"]),
    ("string", &["capDate", "comments", "lookModTransform", "owner"]),
    ("string", &["renderingTransform", "software", "view", "wrapmodes"]),
    ("stringvector", &["multiView"]),
    ("timecode", &["timeCode"]),
    ("v2f", &["adoptedNeutral", SCREEN_CENTER]),
];

/// The type that readers expect of an attribute, if it is a standard one.
pub(super) fn standard_kind(name: &str) -> Option<&'static str> {
    STANDARD.iter().find(|(_, names)| names.contains(&name)).map(|(kind, _)| *kind)
}

/// An attribute as bytes of the file.
struct HeaderField<'a> {
    name: &'a [u8],
    kind: &'a [u8],
    value: &'a [u8],
    all: &'a [u8],
}

/// Sorts the attributes of a file of one part by name.
///
/// The exr crate keeps custom attributes in a hash map, so that their order changes from run to run. Sorting keeps the
/// length of the header, and the offsets of the pixels stay valid.
pub(super) fn sort(bytes: &mut [u8]) -> Result<(), ImageError> {
    let malformed = || ImageError::Unwritable("the header came out malformed".to_owned());
    let (mut entries, rest) = split(bytes.get(PREAMBLE..).ok_or_else(malformed)?).ok_or_else(malformed)?;
    let end = bytes.len() - rest.len() - 1;
    entries.sort_by_key(|entry| entry.name);
    let sorted: Vec<u8> = entries.iter().flat_map(|entry| entry.all).copied().collect();
    bytes[PREAMBLE..end].copy_from_slice(&sorted);
    Ok(())
}

/// The attributes of all parts, without those of the layout. Where a part disagrees with the parts before it, its
/// attribute is added with the name `... of part 2`.
pub(super) fn attributes(bytes: &[u8]) -> Option<std::collections::BTreeMap<String, Attribute>> {
    let several = bytes.get(5)? & SEVERAL_PARTS != 0;
    let mut found = std::collections::BTreeMap::new();
    let mut rest = bytes.get(PREAMBLE..)?;
    for part in 1.. {
        let (entries, after) = split(rest)?;
        for entry in &entries {
            let name = text(entry.name);
            let is_implied = LAYOUT.contains(&name.as_str()) || USUAL.contains(&(name.as_str(), entry.value));
            if let (false, Some(value)) = (is_implied, value(entry)) {
                match found.get(&name) {
                    Some(first) if *first == value => {}
                    Some(_) if part > 1 => drop(found.insert(format!("{name}{OF_PART}{part}"), value)),
                    Some(_) => {}
                    None => drop(found.insert(name, value)),
                }
            }
        }
        if !several || entries.is_empty() {
            break;
        }
        rest = after;
    }
    Some(found)
}

/// The number of the compression of the first part.
pub(super) fn compression(bytes: &[u8]) -> Option<u8> {
    let (entries, _) = split(bytes.get(PREAMBLE..)?)?;
    entries.iter().find(|entry| entry.name == b"compression")?.value.first().copied()
}

/// The attributes up to the zero that ends the list, and the bytes after it.
fn split(bytes: &[u8]) -> Option<(Vec<HeaderField<'_>>, &[u8])> {
    let mut entries = Vec::new();
    let mut rest = bytes;
    while *rest.first()? != 0 {
        let (name, after_name) = split_at_zero(rest)?;
        let (kind, after_kind) = split_at_zero(after_name)?;
        let (size, after_size) = after_kind.split_first_chunk::<4>()?;
        let size = usize::try_from(i32::from_le_bytes(*size)).ok()?;
        let (value, next) = after_size.split_at_checked(size)?;
        let all = &rest[..rest.len() - next.len()];
        entries.push(HeaderField { name, kind, value, all });
        rest = next;
    }
    Some((entries, &rest[1..]))
}

fn split_at_zero(bytes: &[u8]) -> Option<(&[u8], &[u8])> {
    let end = bytes.iter().position(|byte| *byte == 0)?;
    Some((&bytes[..end], &bytes[end + 1..]))
}

/// The value of an attribute; none if its size is wrong.
fn value(entry: &HeaderField<'_>) -> Option<Attribute> {
    Some(match entry.kind {
        b"string" => Attribute::Text(text(entry.value)),
        b"float" => Attribute::Float(f32::from_le_bytes(entry.value.try_into().ok()?)),
        b"double" => Attribute::Double(f64::from_le_bytes(entry.value.try_into().ok()?)),
        b"int" => Attribute::Int(i32::from_le_bytes(entry.value.try_into().ok()?)),
        b"v3f" => Attribute::Vector(floats(entry.value)?),
        b"m44f" => Attribute::Matrix(floats(entry.value)?),
        b"chromaticities" => Attribute::Chromaticities(floats(entry.value)?),
        b"stringvector" => Attribute::Texts(texts(entry.value)?),
        kind => Attribute::Other { kind: text(kind), value: entry.value.to_vec() },
    })
}

fn floats<const N: usize>(bytes: &[u8]) -> Option<[f32; N]> {
    let (values, rest) = bytes.as_chunks::<4>();
    let values: &[[u8; 4]; N] = values.try_into().ok()?;
    rest.is_empty().then(|| values.map(f32::from_le_bytes))
}

fn texts(bytes: &[u8]) -> Option<Vec<String>> {
    let mut list = Vec::new();
    let mut rest = bytes;
    while !rest.is_empty() {
        let (size, after_size) = rest.split_first_chunk::<4>()?;
        let size = usize::try_from(i32::from_le_bytes(*size)).ok()?;
        let (value, next) = after_size.split_at_checked(size)?;
        list.push(text(value));
        rest = next;
    }
    Some(list)
}

/// Text of the file: UTF-8 in current files, and Latin-1, which any bytes are, in older ones.
pub(super) fn text(bytes: &[u8]) -> String {
    match std::str::from_utf8(bytes) {
        Ok(text) => text.to_owned(),
        Err(_) => bytes.iter().copied().map(char::from).collect(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Magic number, version, and two attributes.
    fn header() -> Vec<u8> {
        let mut bytes = b"\x76\x2f\x31\x01\x02\0\0\0".to_vec();
        bytes.extend(b"b\0int\0\x04\0\0\0\x07\0\0\0");
        bytes.extend(b"a\0stringvector\0\x0b\0\0\0\x02\0\0\0xy\x01\0\0\0z\0");
        bytes
    }

    #[test]
    fn attributes_are_read_and_sorted() {
        let mut bytes = header();
        sort(&mut bytes).unwrap();
        assert_eq!((bytes[8], bytes.len()), (b'a', header().len()));
        let expected = [("a", Attribute::Texts(vec!["xy".into(), "z".into()])), ("b", Attribute::Int(7))];
        for bytes in [bytes, header()] {
            assert_eq!(attributes(&bytes), Some(expected.clone().map(|(name, value)| (name.to_owned(), value)).into()));
        }
    }

    /// Seen to catch: an attribute of the second part that is lost.
    #[test]
    fn attributes_of_disagreeing_parts_are_all_kept() {
        let mut bytes = b"\x76\x2f\x31\x01\x02\x10\0\0".to_vec();
        bytes.extend(b"a\0int\0\x04\0\0\0\x07\0\0\0b\0int\0\x04\0\0\0\x07\0\0\0\0");
        bytes.extend(b"a\0int\0\x04\0\0\0\x07\0\0\0b\0int\0\x04\0\0\0\x08\0\0\0\0\0");
        let expected = [("a", 7), ("b", 7), ("b of part 2", 8)];
        let expected = expected.map(|(name, value)| (name.to_owned(), Attribute::Int(value)));
        assert_eq!(attributes(&bytes), Some(expected.into()));
    }

    /// A size that is negative or beyond the end is no panic.
    #[test]
    fn damage_never_panics() {
        let whole = header();
        for end in 0..whole.len() {
            assert_eq!(attributes(&whole[..end]), None, "{end} bytes");
            for byte in [0, 1, 0x7f, 0x80, 0xff] {
                let mut damaged = whole.clone();
                damaged[end] = byte;
                attributes(&damaged);
                sort(&mut damaged).ok();
            }
        }
    }

    #[test]
    fn text_that_is_not_utf8_is_latin1() {
        assert_eq!(text(b"Gr\xc3\xbc\xc3\x9fe"), "Grüße");
        assert_eq!(text(b"Gr\xfc\xdfe"), "Grüße");
    }
}

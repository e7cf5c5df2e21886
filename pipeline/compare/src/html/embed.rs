//! Embeds data and code in a page in such a way that no data can become code.

use std::io::Write;

use base64::{Engine, engine::general_purpose::STANDARD};
use flate2::{Compression, write::ZlibEncoder};
use serde::Serialize;

/// The scripts that every page begins with.
pub(super) const COMMON: &str = concat!(include_str!("page/dom.js"), include_str!("page/theme.js"));

/// A data block of one line. In JSON `<` occurs in strings only, where `\u003c` means the same, so that no string can
/// end the block or begin a comment in it.
pub(super) fn json(id: &str, value: &impl Serialize) -> Result<String, serde_json::Error> {
    let text = serde_json::to_string(value)?.replace('<', "\\u003c");
    Ok(format!("{}{text}{END}", json_start(id)))
}

/// The beginning of a data block, by which the index finds the blocks of a report.
pub(super) fn json_start(id: &str) -> String {
    format!("<script type=\"application/json\" id=\"{id}\">")
}

/// The end of a data block.
pub(super) const END: &str = "</script>\n";

/// One channel of one image as text.
#[derive(Clone, Debug)]
pub(super) struct Plane {
    /// The number of its block in the page.
    pub id: usize,
    /// The deflated bytes in base64.
    pub text: String,
}

/// Encodes the first bytes of all little-endian float32, then all second, third and fourth bytes, deflated and in
/// base64.
///
/// Bytes of the same significance are similar, above all those of the exponents. Higher levels of compression gain 3 %
/// on renderings at many times the cost, because the low bits of noise do not compress.
pub(super) fn encode(samples: &[f32]) -> String {
    let bytes: Vec<u8> = (0..4).flat_map(|byte| samples.iter().map(move |s| s.to_le_bytes()[byte])).collect();
    let mut encoder = ZlibEncoder::new(Vec::new(), Compression::fast());
    // Writing to a vector cannot fail.
    let deflated = encoder.write_all(&bytes).and_then(|()| encoder.finish()).unwrap_or_default();
    STANDARD.encode(deflated)
}

/// Whether both planes have the same bits.
pub(super) fn same_bits(reference: &[f32], test: &[f32]) -> bool {
    reference.iter().map(|s| s.to_bits()).eq(test.iter().map(|s| s.to_bits()))
}

/// A data block with the samples of a plane.
pub(super) fn plane(plane: &Plane) -> String {
    format!("<script type=\"text/plain\" id=\"plane-{}\">{}{END}", plane.id, plane.text)
}

/// The page: its template with style, script and data. The security policy allows only the script and the style of the
/// template, and no network. The nonce is a hash of the data, so that no data can contain it.
pub(super) fn page(template: &str, script: &str, data: &str) -> Vec<u8> {
    let nonce = blake3::hash(data.as_bytes()).to_hex();
    let style = include_str!("page/page.css");
    fill(template, &[("nonce", nonce.as_str()), ("style", style), ("script", script), ("data", data)]).into_bytes()
}

/// Replaces each `{{name}}` by its value. Values are not searched for further names.
fn fill(template: &str, values: &[(&str, &str)]) -> String {
    let mut parts = template.split("{{");
    let mut page = parts.next().unwrap_or_default().to_owned();
    for part in parts {
        let (name, rest) = part.split_once("}}").unwrap_or((part, ""));
        page += values.iter().find(|(known, _)| *known == name).map_or("", |(_, value)| value);
        page += rest;
    }
    page
}

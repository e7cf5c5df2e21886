//! Data and code in a page, so that no data can become code.

use serde::Serialize;

use super::plane::Plane;

/// A data block. Inside JSON `<` can only stand in a text, where `\u003c` means the same: no text can end the block,
/// nor begin a comment in it. One block is one line.
pub(super) fn json(id: &str, value: &impl Serialize) -> Result<String, serde_json::Error> {
    let text = serde_json::to_string(value)?.replace('<', "\\u003c");
    Ok(format!("{}{text}{END}", json_start(id)))
}

/// How a data block begins; the index finds those of a report by it.
pub(super) fn json_start(id: &str) -> String {
    format!("<script type=\"application/json\" id=\"{id}\">")
}

/// How a data block ends.
pub(super) const END: &str = "</script>\n";

/// A block with the samples of a plane.
pub(super) fn plane(plane: &Plane) -> String {
    format!("<script type=\"text/plain\" id=\"plane-{}\">{}{END}", plane.id, plane.text)
}

/// The page: its template with style, script and data. The template's own script and style may run and nothing else
/// may; no network is allowed. The nonce is a hash of the data, so that no data can contain it.
pub(super) fn page(template: &str, script: &str, data: &str) -> Vec<u8> {
    let nonce = blake3::hash(data.as_bytes()).to_hex();
    let style = include_str!("page/page.css");
    fill(template, &[("nonce", nonce.as_str()), ("style", style), ("script", script), ("data", data)]).into_bytes()
}

/// Puts values in the place of `{{name}}`; values themselves are not looked into.
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

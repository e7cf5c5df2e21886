//! What the `extras` of a material say: a medium by name, or as a medium's file has it.
//!
//! Blender exports custom properties as extras. A property is a number, a text or a group, so that the JSON of a medium
//! may be an object, or a text that holds one.

use crate::{material::StatedMedium, unhonoured::cut};
use gltf::json::Material;
use serde_json::{Map, Value};

/// Most bytes of a medium's name or text.
const MAX_BYTES: usize = 1 << 16;

/// The medium that the extras state. A warning about one that is neither a name nor a medium goes to `note`.
pub(super) fn medium(m: &Material, note: &mut impl FnMut(String)) -> Option<StatedMedium> {
    let text = m.extras.as_ref()?.get();
    // Other programs keep anything else there.
    let medium = serde_json::from_str::<Map<String, Value>>(text).ok()?.remove("medium")?;
    if medium.is_null() {
        return None;
    }
    let stated = match medium {
        Value::Object(_) => Some(StatedMedium::Json(medium.to_string())),
        Value::String(text) if text.trim_start().starts_with('{') => Some(StatedMedium::Json(text)),
        Value::String(name) => Some(StatedMedium::Name(name.trim().to_owned())).filter(|_| !name.trim().is_empty()),
        Value::Null | Value::Bool(_) | Value::Number(_) | Value::Array(_) => None,
    };
    let short = |stated: &StatedMedium| {
        let (StatedMedium::Name(text) | StatedMedium::Json(text)) = stated;
        text.len() <= MAX_BYTES
    };
    let stated = stated.filter(short);
    if stated.is_none() {
        let what = cut(text, 60);
        note(format!("extras.medium is neither the name of a medium nor the JSON of one, and is not used: {what}"));
    }
    stated
}

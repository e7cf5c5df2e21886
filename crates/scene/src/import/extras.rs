//! What the `extras` of a material say: a medium by name, or as a medium's file has it, and a second one that it is
//! blended with.
//!
//! Blender exports custom properties as extras. A property is a number, a text or a group, so that the JSON of a medium
//! may be an object, or a text that holds one.

use super::{base_color, fault::Result};
use crate::{material::StatedMedium, unhonoured::cut};
use gltf::json::Material;
use serde_json::{Map, Value};

/// Most bytes of a medium's name or text.
const MAX_BYTES: usize = 1 << 16;

/// The medium that the extras state. A warning about one that is neither a name nor a medium goes to `note`.
pub(super) fn medium(m: &Material, note: &mut impl FnMut(String)) -> Option<StatedMedium> {
    let medium = field(m, "medium")?;
    let stated = stated(medium);
    if stated.is_none() {
        let what = cut(m.extras.as_ref()?.get(), 60);
        note(format!("extras.medium is neither the name of a medium nor the JSON of one, and is not used: {what}"));
    }
    stated
}

/// The medium that the extras blend with `first`, the material's own. Whoever states one means it, so that anything wrong
/// is a fault.
pub(super) fn blend(m: &Material, first: Option<&StatedMedium>) -> Result<Option<StatedMedium>> {
    let Some(second) = field(m, "medium_blend") else { return Ok(None) };
    let fault = |what: &str| Err(format!("extras.medium_blend {what}, or remove it"));
    if first.is_none() {
        return fault("needs a first medium: state it as extras.medium");
    }
    if base_color::texture(m).is_none() {
        return fault("needs a base color texture, whose alpha is 1 where extras.medium is: add one");
    }
    match stated(second) {
        Some(second) => Ok(Some(second)),
        None => fault("must be the name of one medium or the JSON of one: a surface holds two media at most; give one"),
    }
}

/// A field of the extras, unless it is null. Other programs keep anything else there.
fn field(m: &Material, name: &str) -> Option<Value> {
    let text = m.extras.as_ref()?.get();
    let value = serde_json::from_str::<Map<String, Value>>(text).ok()?.remove(name)?;
    (!value.is_null()).then_some(value)
}

/// A medium as a value states it; none if it is none.
fn stated(medium: Value) -> Option<StatedMedium> {
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
    stated.filter(short)
}

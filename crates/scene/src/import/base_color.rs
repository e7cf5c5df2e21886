//! The base color of a material: of the metallic-roughness model, or the diffuse color of the older
//! KHR_materials_pbrSpecularGlossiness, which takes precedence where a file has both.

use gltf::json::{self, texture::Info};
use serde_json::Value;
use std::borrow::Cow;

fn older(m: &json::Material) -> Option<&Value> {
    m.extensions.as_ref()?.others.get("KHR_materials_pbrSpecularGlossiness")
}

/// The factor, not checked.
pub(super) fn factor(m: &json::Material) -> [f64; 4] {
    let Some(older) = older(m) else { return m.pbr_metallic_roughness.base_color_factor.0.map(f64::from) };
    let given = older.get("diffuseFactor").map(|factor| serde_json::from_value(factor.clone()));
    // What is no color is refused with other factors that are none.
    given.map_or([1.0; 4], |factor| factor.unwrap_or([f64::NAN; 4]))
}

/// The texture, and the name of its field.
pub(super) fn texture(m: &json::Material) -> Option<(Cow<'_, Info>, &'static str)> {
    let Some(older) = older(m) else {
        let texture = m.pbr_metallic_roughness.base_color_texture.as_ref();
        return texture.map(|info| (Cow::Borrowed(info), "baseColorTexture"));
    };
    let info = serde_json::from_value::<Info>(older.get("diffuseTexture")?.clone()).ok()?;
    Some((Cow::Owned(info), "diffuseTexture"))
}

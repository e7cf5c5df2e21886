//! How a surface mirrors: metallic factor, roughness and their texture, KHR_materials_ior and KHR_materials_specular.
//!
//! By glTF, a material without any of these is a rough metal. Few files that leave all of them out mean that, so that
//! they are taken as matt where opaque and as smooth where translucent; so are those with a metallic factor of 0 alone.

use super::{container::Document, fault::Result, textures::Textures};
use crate::material::GlossStated;
use bsdf::Stated;
use glam::DVec3;
use gltf::json::{self, texture::Info};
use serde_json::Value;

/// The texture of metallic and roughness.
pub(super) fn texture(m: &json::Material) -> Option<&Info> {
    m.pbr_metallic_roughness.metallic_roughness_texture.as_ref()
}

/// How the material with this index mirrors; none if it states nothing about it. A texture that cannot be read is left
/// out with a warning.
pub(super) fn read(
    document: &Document,
    index: usize,
    m: &json::Material,
    textures: Option<&mut Textures>,
    mut note: impl FnMut(String),
) -> Result<Option<GlossStated>> {
    let others = m.extensions.as_ref().map(|e| &e.others);
    let is_older = others.is_some_and(|others| others.contains_key("KHR_materials_pbrSpecularGlossiness"));
    if is_older || texture(m).is_none() && !document.survey.is_glossy(index) {
        return Ok(None);
    }
    let pbr = &m.pbr_metallic_roughness;
    let (metallic, roughness) = (f64::from(pbr.metallic_factor.0), f64::from(pbr.roughness_factor.0));
    let specular = others.and_then(|others| others.get("KHR_materials_specular"));
    let number = |value: &Value| value.as_f64().unwrap_or(f64::NAN);
    let factor = specular.and_then(|s| s.get("specularFactor")).map_or(1.0, number);
    let color = specular.and_then(|s| s.get("specularColorFactor"));
    let color = color.map_or([1.0; 3], |color| serde_json::from_value(color.clone()).unwrap_or([f64::NAN; 3]));
    let ior = m.extensions.as_ref().and_then(|e| e.ior.as_ref()).map_or(1.5, |ior| f64::from(ior.ior.0));
    for (field, value, most) in [
        ("metallicFactor", metallic, 1.0),
        ("roughnessFactor", roughness, 1.0),
        ("KHR_materials_specular.specularFactor", factor, 1.0),
        ("KHR_materials_ior.ior", ior, f64::MAX),
    ] {
        if !(0.0..=most).contains(&value) {
            let range = if most > 1.0 { "must be finite and not negative" } else { "must lie in [0, 1]" };
            return Err(format!("{field} {value} {range}"));
        }
    }
    if !color.iter().all(|c| c.is_finite() && *c >= 0.0) {
        return Err(format!("KHR_materials_specular.specularColorFactor {color:?} must be finite and not negative"));
    }
    let texture = textures.and_then(|textures| {
        let read = textures.read(texture(m)?);
        read.map_err(|e| note(format!("metallicRoughnessTexture: {e}; its factors alone are used"))).ok()
    });
    let dielectric = Stated::dielectric(ior, factor, DVec3::from_array(color));
    Ok(Some(GlossStated { metallic, roughness, texture, dielectric }))
}

//! The file's materials.

use super::{Fault, ImportOptions, Material, volumes};
use glam::DVec3;
use gltf::json::{self, Root, material::AlphaMode, validation::Checked};

/// Triangles name their material with 16 bits, and one is needed for those without.
const MAX_MATERIALS: usize = u16::MAX as usize;

pub(super) fn read(root: &Root, options: &ImportOptions, warnings: &mut Vec<String>) -> Result<Vec<Material>, Fault> {
    let count = root.materials.len();
    if count > MAX_MATERIALS {
        return Err(format!(
            "materials: {count} of them, at most {MAX_MATERIALS} are read; export without unused ones"
        ));
    }
    let named = |(k, m): (usize, &json::Material)| {
        let name = m.name.clone().unwrap_or_else(|| format!("material{k}"));
        material(name.clone(), m, options, warnings).map_err(|e| format!("material `{name}`: {e}"))
    };
    root.materials.iter().enumerate().map(named).collect()
}

/// What covers triangles that name no material.
pub(super) fn default() -> Material {
    Material {
        name: "default".into(),
        base_color: DVec3::splat(0.8),
        emission: DVec3::ZERO,
        volume: false,
        medium: None,
        double_sided: false,
    }
}

fn material(
    name: String,
    m: &json::Material,
    options: &ImportOptions,
    warnings: &mut Vec<String>,
) -> Result<Material, Fault> {
    let strength = m.extensions.as_ref().and_then(|e| e.emissive_strength.as_ref());
    let strength = strength.map_or(1.0, |s| f64::from(s.emissive_strength.0));
    let emission = DVec3::from_array(m.emissive_factor.0.map(f64::from)) * strength;
    let [r, g, b, _] = m.pbr_metallic_roughness.base_color_factor.0.map(f64::from);
    let base_color = DVec3::new(r, g, b);
    for (field, value) in [("emissiveFactor times emissiveStrength", emission), ("baseColorFactor", base_color)] {
        if !value.is_finite() || value.min_element() < 0.0 {
            return Err(format!("{field} {value} must be finite and not negative"));
        }
    }
    let unused = [
        (m.pbr_metallic_roughness.base_color_texture.is_some(), "the base colour texture is not used, its factor is"),
        (m.emissive_texture.is_some(), "the emissive texture is not used, its factor is"),
        (m.alpha_mode != Checked::Valid(AlphaMode::Opaque), "alphaMode is not used: the surface is opaque"),
    ];
    warnings.extend(unused.iter().filter(|u| u.0).map(|(_, what)| format!("material `{name}`: {what}")));
    let emission = emission * options.light_unit.watts();
    let note = |what| warnings.push(format!("material `{name}`: {what}"));
    let medium = volumes::read(m, options.metres_per_unit, note)?;
    Ok(Material { name, base_color, emission, volume: volumes::is_marked(m), medium, double_sided: m.double_sided })
}

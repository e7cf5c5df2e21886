//! Import of materials.

use super::{container::Document, extras, fault::Result, textures::Textures, units::FileUnits, volumes};
use crate::material::Material;
use glam::{DVec3, DVec4};
use gltf::json::{self, material::AlphaMode, validation::Checked};

/// Triangles have a material index of 16 bits, and one index is for triangles without material.
const MAX_MATERIALS: usize = u16::MAX as usize;

pub(super) fn read(
    document: &Document,
    metres_per_unit: f64,
    units: &FileUnits,
    warnings: &mut Vec<String>,
) -> Result<Vec<Material>> {
    let root = &document.root;
    let count = root.materials.len();
    if count > MAX_MATERIALS {
        return Err(format!(
            "materials: {count} of them, at most {MAX_MATERIALS} are supported; export without unused ones"
        ));
    }
    let mut textures = Textures::new(document);
    let named = |(k, m): (usize, &json::Material)| {
        let name = m.name.clone().unwrap_or_else(|| format!("material{k}"));
        material(name.clone(), m, (metres_per_unit, units), &mut textures, warnings)
            .map_err(|e| format!("material `{name}`: {e}"))
    };
    root.materials.iter().enumerate().map(named).collect()
}

/// The material of triangles that name none.
pub(super) fn default() -> Material {
    Material {
        name: "default".into(),
        base_color: DVec3::splat(0.8).extend(1.0),
        base_texture: None,
        cutoff: None,
        emission: DVec3::ZERO,
        volume: false,
        stated: None,
        medium: None,
        double_sided: false,
    }
}

fn material(
    name: String,
    m: &json::Material,
    (metres_per_unit, units): (f64, &FileUnits),
    textures: &mut Textures,
    warnings: &mut Vec<String>,
) -> Result<Material> {
    let strength = m.extensions.as_ref().and_then(|e| e.emissive_strength.as_ref());
    let strength = strength.map_or(1.0, |s| f64::from(s.emissive_strength.0));
    let emission = DVec3::from_array(m.emissive_factor.0.map(f64::from)) * strength;
    let base_color = DVec4::from_array(m.pbr_metallic_roughness.base_color_factor.0.map(f64::from));
    let cutoff = m.alpha_cutoff.map_or(0.5, |c| c.0);
    let numbers = [
        ("emissiveFactor times emissiveStrength", &emission.to_array()[..]),
        ("baseColorFactor", &base_color.to_array()),
        ("alphaCutoff", &[f64::from(cutoff)]),
    ];
    for (field, value) in numbers {
        if !value.iter().all(|x| x.is_finite() && *x >= 0.0) {
            return Err(format!("{field} {value:?} must be finite and not negative"));
        }
    }
    let texture = m.pbr_metallic_roughness.base_color_texture.as_ref();
    let base_texture = texture.map(|t| textures.read(t)).transpose().map_err(|e| format!("baseColorTexture: {e}"))?;
    let masked = m.alpha_mode == Checked::Valid(AlphaMode::Mask);
    let blends = !masked && m.alpha_mode != Checked::Valid(AlphaMode::Opaque);
    let unused = [
        (m.emissive_texture.is_some(), "the emissive texture is not used, its factor is"),
        (blends, "alphaMode BLEND is not used: the surface is opaque"),
        (masked && emission != DVec3::ZERO, "alphaMode MASK is not used: the surface emits"),
    ];
    warnings.extend(unused.iter().filter(|u| u.0).map(|(_, what)| format!("material `{name}`: {what}")));
    let emission = emission * units.emission.watts();
    let mut note = |what| warnings.push(format!("material `{name}`: {what}"));
    let stated = extras::medium(m, &mut note);
    let medium = volumes::read(m, metres_per_unit, note)?;
    Ok(Material {
        name,
        base_color,
        base_texture,
        cutoff: masked.then_some(cutoff),
        emission,
        volume: stated.is_some() || volumes::is_marked(m),
        stated,
        medium,
        double_sided: m.double_sided,
    })
}

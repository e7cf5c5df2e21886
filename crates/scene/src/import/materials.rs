//! Import of materials.

use super::{
    base_color, container::Document, extras, fault::Result, gloss, textures::Textures, units::FileUnits, volumes,
};
use crate::{
    bumps::NormalMap,
    material::{Alpha, Material},
    texture::Texture,
};
use glam::{DVec3, DVec4};
use gltf::json::{self, material::AlphaMode, texture::Info, validation::Checked};
use std::collections::{BTreeMap, BTreeSet};

/// Triangles have a material index of 16 bits, and one index is for triangles without material.
const MAX_MATERIALS: usize = u16::MAX as usize;

/// What materials are read with.
pub(super) struct Context<'a> {
    pub document: &'a Document,
    pub metres_per_unit: f64,
    pub units: &'a FileUnits,
    /// The materials that the scene uses. Textures of others are not read.
    pub used: &'a BTreeSet<u16>,
}

/// The materials of a file.
pub(super) struct ReadMaterials {
    pub materials: Vec<Material>,
    /// Why the base color texture of some cannot be read: whether they need it is not known yet.
    pub faults: BTreeMap<u16, String>,
    /// Warnings about the media of materials with thin walls, which hold if those are rendered as solids.
    pub of_solids: Vec<(u16, String)>,
}

/// Reads the materials of a file.
pub(super) fn read(context: &Context, warnings: &mut Vec<String>) -> Result<ReadMaterials> {
    let root = &context.document.root;
    let count = root.materials.len();
    if count > MAX_MATERIALS {
        return Err(format!(
            "materials: {count} of them, at most {MAX_MATERIALS} are supported; export without unused ones"
        ));
    }
    let (mut textures, mut faults, mut materials) = (Textures::new(context.document), BTreeMap::new(), Vec::new());
    let mut of_solids = Vec::new();
    for (index, m) in (0u16..).zip(&root.materials) {
        let name = m.name.clone().unwrap_or_else(|| format!("material{index}"));
        let named = |e| format!("material `{name}`: {e}");
        let (mut material, notes) = material(name.clone(), m, context, warnings).map_err(named)?;
        let notes = notes.into_iter().map(&named);
        match &material.wall {
            Some(_) => of_solids.extend(notes.map(|note| (index, note))),
            None => warnings.extend(notes),
        }
        let is_used = context.used.contains(&index);
        let note = |what| warnings.push(format!("material `{name}`: {what}"));
        let textures_of_used = is_used.then_some(&mut textures);
        material.gloss = gloss::read(context.document, usize::from(index), m, textures_of_used, note).map_err(named)?;
        if is_used {
            match base_texture(m, &mut textures) {
                Ok(texture) => material.base_texture = texture,
                Err(e) if material.blend.is_some() => return Err(named(format!("{e}: extras.medium_blend needs it"))),
                Err(e) => _ = faults.insert(index, named(e)),
            }
            read_emission(&mut material, m, &mut textures).map_err(named)?;
            read_wall(&mut material, m, &mut textures, |what| warnings.push(named(what)));
            read_scatter(&mut material, m, &mut textures).map_err(named)?;
            // A surface without its bumps is plainer, and no fault.
            match normal_map(m, &mut textures) {
                Ok(map) => material.normal_map = map,
                Err(e) => warnings.push(format!("{}: the surface is smooth", named(e))),
            }
        }
        if material.alpha != Alpha::Ignored && material.emits() {
            warnings.push(named("alphaMode MASK and BLEND are not used where the surface emits".into()));
        }
        materials.push(material);
    }
    Ok(ReadMaterials { materials, faults, of_solids })
}

fn base_texture(m: &json::Material, textures: &mut Textures) -> Result<Option<Texture>> {
    let texture = base_color::texture(m);
    texture.map(|(info, field)| textures.read(&info).map_err(|e| format!("{field}: {e}"))).transpose()
}

fn normal_map(m: &json::Material, textures: &mut Textures) -> Result<Option<NormalMap>> {
    let Some(of_file) = &m.normal_texture else { return Ok(None) };
    let field = |e| format!("normalTexture: {e}");
    if !of_file.scale.is_finite() {
        return Err(field(format!("scale {} must be finite", of_file.scale)));
    }
    let info = normal_info(of_file).ok_or_else(|| field("KHR_texture_transform: not as the extension says".into()))?;
    let texture = textures.read(&info).map_err(field)?;
    Ok(Some(NormalMap::new(texture, f64::from(of_file.scale))))
}

/// A normal texture without its scale, if its extensions are well-formed.
pub(super) fn normal_info(texture: &json::material::NormalTexture) -> Option<Info> {
    serde_json::from_value(serde_json::to_value(texture).ok()?).ok()
}

/// Reads the texture of a material that emits; one that is black does not.
fn read_emission(material: &mut Material, m: &json::Material, textures: &mut Textures) -> Result<()> {
    let Some(info) = m.emissive_texture.as_ref().filter(|_| material.emits()) else { return Ok(()) };
    let texture = textures.read(info).map_err(|e| format!("emissiveTexture: {e}"))?;
    let emits = |texel: &[u8; 4]| (0..3).any(|c| material.emission[c] > 0.0 && texel[c] > 0);
    if texture.picture.texels.iter().any(emits) {
        material.emission_texture = Some(texture);
    } else {
        material.emission = DVec3::ZERO;
    }
    Ok(())
}

/// Reads the textures of a wall. One that cannot be read is left out with a warning.
fn read_wall(material: &mut Material, m: &json::Material, textures: &mut Textures, mut warn: impl FnMut(String)) {
    let Some(wall) = &mut material.wall else { return };
    for (texture, stated) in wall.textures.iter_mut().zip(volumes::wall_textures(m)) {
        let Some((info, field)) = stated else { continue };
        match textures.read(&info) {
            Ok(read) => *texture = Some(read),
            Err(e) => warn(format!("{field}: {e}; its factor alone is used")),
        }
    }
}

/// Reads the texture of the color after multiple scattering, without which the medium would be another. A wall has read
/// it.
fn read_scatter(material: &mut Material, m: &json::Material, textures: &mut Textures) -> Result<()> {
    material.scatter_texture = match (&material.wall, volumes::scatter_texture(m)) {
        (Some(wall), Some(_)) => wall.textures[1].clone(),
        (None, Some(info)) => {
            let field = volumes::SCATTER_TEXTURE;
            Some(textures.read(&info).map_err(|e| format!("{field}: {e}"))?)
        }
        (_, None) if volumes::has_scatter_texture(m) => {
            return Err(format!("{}: not a texture; give an object with an `index`", volumes::SCATTER_TEXTURE));
        }
        (_, None) => None,
    };
    Ok(())
}

/// The material of triangles that name none.
pub(super) fn default() -> Material {
    default_named("default".into())
}

fn default_named(name: String) -> Material {
    Material {
        name,
        base_color: DVec3::splat(0.8).extend(1.0),
        base_texture: None,
        normal_map: None,
        alpha: Alpha::Ignored,
        emission: DVec3::ZERO,
        emission_texture: None,
        gloss: None,
        volume: false,
        thin: false,
        wall: None,
        stated: None,
        blend: None,
        medium: None,
        scatter_texture: None,
        double_sided: false,
    }
}

/// A material, and the warnings about its medium.
fn material(
    name: String,
    m: &json::Material,
    context: &Context,
    warnings: &mut Vec<String>,
) -> Result<(Material, Vec<String>)> {
    let strength = m.extensions.as_ref().and_then(|e| e.emissive_strength.as_ref());
    let strength = strength.map_or(1.0, |s| f64::from(s.emissive_strength.0));
    let emission = DVec3::from_array(m.emissive_factor.0.map(f64::from)) * strength;
    let base_color = DVec4::from_array(base_color::factor(m));
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
    let mut note = |what| warnings.push(format!("material `{name}`: {what}"));
    let stated = extras::medium(m, &mut note);
    let blend = extras::blend(m, stated.as_ref())?;
    let mut notes = Vec::new();
    let medium = volumes::read(m, context.metres_per_unit, |what| notes.push(what))?;
    let material = Material {
        base_color,
        alpha: match m.alpha_mode {
            Checked::Valid(AlphaMode::Opaque) => Alpha::Ignored,
            Checked::Valid(AlphaMode::Mask) => Alpha::Cutoff(cutoff),
            Checked::Valid(AlphaMode::Blend) | Checked::Invalid => Alpha::Coverage,
        },
        emission: emission * context.units.emission.watts(),
        volume: stated.is_some() || volumes::is_marked(m),
        thin: stated.is_none() && volumes::is_thin(m),
        wall: volumes::wall(m).filter(|_| stated.is_none()),
        stated,
        blend,
        medium,
        double_sided: m.double_sided,
        ..default_named(name)
    };
    Ok((material, notes))
}

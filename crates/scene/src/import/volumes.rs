//! Import of the media below materials.

use super::fault::Result;
use crate::material::{Scatter, ScatterExtension, Volume, Wall};
use glam::DVec3;
use gltf::json::{
    self,
    extensions::material::{self, IndexOfRefraction},
    texture::Info,
};
use serde::Deserialize;
use serde_json::Value;

/// Smallest color of attenuation, whose logarithm is finite; smaller ones are raised to it.
const MIN_ATTENUATION: f64 = 1e-4;

/// The newer draft comes first, because it replaces the other.
const DRAFTS: [ScatterExtension; 2] = [ScatterExtension::Scatter, ScatterExtension::VolumeScatter];

/// Fields of both drafts. `multiscatterColor` is from a version of the older draft before February 2026.
#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
struct Fields {
    multiscatter_color_factor: Option<[f64; 3]>,
    multiscatter_color: Option<[f64; 3]>,
    /// Only in the newer draft.
    scatter_strength_factor: Option<f64>,
    #[serde(default)]
    scatter_anisotropy: f64,
}

/// True if the file says that light enters the surface, or that it bounds a medium.
pub(super) fn is_marked(m: &json::Material) -> bool {
    let is_solid = |e: &material::Material| e.volume.as_ref().is_some_and(|v| v.thickness_factor.0 > 0.0);
    let enters = |e| transmission(e) > 0.0 || diffuse_transmission(e) > 0.0;
    m.extensions.as_ref().is_some_and(|e| enters(e) || is_solid(e) || drafts(e).next().is_some())
}

/// True if light enters by transmission alone: glTF then says that the walls have no thickness.
pub(super) fn is_thin(m: &json::Material) -> bool {
    let no_volume = |e: &material::Material| e.volume.as_ref().is_none_or(|v| v.thickness_factor.0 <= 0.0);
    m.extensions.as_ref().is_some_and(|e| transmission(e) > 0.0 && no_volume(e) && drafts(e).next().is_none())
}

/// How walls without thickness scatter light, if the material describes such walls: by the newer draft for scattering, or
/// by KHR_materials_diffuse_transmission. Numbers out of range are moved into it.
pub(super) fn wall(m: &json::Material) -> Option<Wall> {
    let e = m.extensions.as_ref().filter(|e| e.volume.as_ref().is_none_or(|v| v.thickness_factor.0 <= 0.0))?;
    let within = |x: f64| x.clamp(0.0, 1.0);
    let entering = within(f64::from(transmission(e)));
    let wall = |anisotropy, share, color: [f64; 3]| Wall {
        transmission: entering,
        anisotropy,
        share,
        color: DVec3::from_array(color.map(within)),
        textures: [None, None],
    };
    match drafts(e).next() {
        None => {
            let share = within(diffuse_transmission(e));
            let color = e.others.get(DIFFUSE).and_then(|d| d.get("diffuseTransmissionColorFactor"));
            let color = color.and_then(|c| <[f64; 3]>::deserialize(c).ok()).unwrap_or([1.0; 3]);
            let is_wall = share > 0.0 && entering < 1.0;
            is_wall.then(|| wall(None, share, color))
        }
        Some((ScatterExtension::Scatter, value)) => {
            let fields = Fields::deserialize(value).ok()?;
            let strength = within(fields.scatter_strength_factor.unwrap_or(0.0));
            let color = fields.multiscatter_color_factor.or(fields.multiscatter_color).unwrap_or([1.0; 3]);
            let g = fields.scatter_anisotropy.clamp(-1.0, 1.0);
            (entering * strength > 0.0).then(|| wall(Some(g), strength, color))
        }
        Some((ScatterExtension::VolumeScatter, _)) => None,
    }
}

/// The textures of a wall's share and color with their names, if the material describes a wall.
pub(super) fn wall_textures(m: &json::Material) -> [Option<(Info, &'static str)>; 2] {
    const OF_DRAFT: [&str; 2] = ["scatterStrengthTexture", SCATTER_TEXTURE];
    const OF_DIFFUSE: [&str; 2] = ["diffuseTransmissionTexture", "diffuseTransmissionColorTexture"];
    let Some((e, wall)) = m.extensions.as_ref().zip(wall(m)) else { return [None, None] };
    let names = if wall.anisotropy.is_some() { OF_DRAFT } else { OF_DIFFUSE };
    let stated = drafts(e).next().map(|(_, value)| value).or_else(|| e.others.get(DIFFUSE));
    names.map(|name| Some((Info::deserialize(stated?.get(name)?).ok()?, name)))
}

/// The field of both drafts for the texture of a color.
pub(super) const SCATTER_TEXTURE: &str = "multiscatterColorTexture";

/// The texture of the color after multiple scattering, of either draft.
pub(super) fn scatter_texture(m: &json::Material) -> Option<Info> {
    let (_, value) = drafts(m.extensions.as_ref()?).next()?;
    Info::deserialize(value.get(SCATTER_TEXTURE)?).ok()
}

/// Whether the file has that field, with a texture or with anything else.
pub(super) fn has_scatter_texture(m: &json::Material) -> bool {
    let draft = m.extensions.as_ref().and_then(|e| drafts(e).next());
    draft.is_some_and(|(_, value)| value.get(SCATTER_TEXTURE).is_some())
}

fn transmission(e: &material::Material) -> f32 {
    e.transmission.as_ref().map_or(0.0, |t| t.transmission_factor.0)
}

const DIFFUSE: &str = "KHR_materials_diffuse_transmission";

/// The factor of KHR_materials_diffuse_transmission.
fn diffuse_transmission(e: &material::Material) -> f64 {
    let factor = e.others.get(DIFFUSE).and_then(|d| d.get("diffuseTransmissionFactor"));
    factor.and_then(Value::as_f64).unwrap_or(0.0)
}

fn drafts(e: &material::Material) -> impl Iterator<Item = (ScatterExtension, &Value)> {
    DRAFTS.into_iter().filter_map(|draft| Some((draft, e.others.get(draft.extension())?)))
}

/// The coefficients of the medium, if the material states them. Without a volume, or in one that absorbs nothing, what
/// light enters by transmission is clear. Warnings about missing or changed values go to `note`.
pub(super) fn read(m: &json::Material, metres_per_unit: f64, mut note: impl FnMut(String)) -> Result<Option<Volume>> {
    let Some(e) = &m.extensions else { return Ok(None) };
    let transmits = transmission(e) > 0.0;
    let mut drafts = drafts(e);
    let draft = drafts.next();
    if let Some((older, _)) = drafts.next() {
        note(format!("{} is not used beside the draft that replaces it", older.extension()));
    }
    // Light must enter, and there must be a volume.
    let enters = transmits || matches!(draft, Some((ScatterExtension::VolumeScatter, _)));
    let solid = e.volume.as_ref().filter(|v| draft.is_some() || v.thickness_factor.0 > 0.0);
    let (true, Some(volume)) = (enters, solid) else {
        let Some((draft, _)) = draft else { return Ok(transmits.then(|| clear(e))) };
        let needs = if enters { "KHR_materials_volume" } else { "KHR_materials_transmission" };
        note(format!("{} has no effect without {needs}: the file gives no medium", draft.extension()));
        return Ok(None);
    };
    let extinction = extinction(volume, metres_per_unit, &mut note)?;
    if extinction == DVec3::ZERO {
        let Some((draft, _)) = draft else { return Ok(Some(clear(e))) };
        note(format!("{} without attenuationDistance and attenuationColor gives no medium", draft.extension()));
        return Ok(None);
    }
    let scatter = match draft {
        Some((draft, value)) => scatter(draft, value, &mut note).map_err(|e| format!("{}: {e}", draft.extension()))?,
        None => None,
    };
    if let Some((draft, _)) = draft.filter(|_| volume.thickness_factor.0 <= 0.0) {
        let name = draft.extension();
        note(format!(
            "thicknessFactor is 0, which {name} calls a thin wall; it is rendered as the solid that it bounds"
        ));
    }
    Ok(Some(Volume { extinction, scatter, ..clear(e) }))
}

/// A medium of the material's index that neither absorbs nor scatters.
fn clear(e: &material::Material) -> Volume {
    let ior = e.ior.as_ref().map_or(IndexOfRefraction::default().0, |i| i.ior.0);
    // The decimal number of the file, and not its rounding to float32.
    let ior = ior.to_string().parse().unwrap_or(f64::from(ior));
    Volume { extinction: DVec3::ZERO, ior, scatter: None }
}

/// `σ_t = −ln(attenuationColor)/attenuationDistance`, 1/m. The distance is in units of the world and independent of the
/// scale of nodes.
fn extinction(volume: &material::Volume, metres_per_unit: f64, note: &mut impl FnMut(String)) -> Result<DVec3> {
    let color = DVec3::from_array(volume.attenuation_color.0.map(f64::from));
    check_color("attenuationColor", color)?;
    let distance = f64::from(volume.attenuation_distance.0) * metres_per_unit;
    if distance.is_nan() || distance <= 0.0 {
        return Err(format!("attenuationDistance {} must be above zero", volume.attenuation_distance.0));
    }
    if color.min_element() < MIN_ATTENUATION && distance.is_finite() {
        note(format!("attenuationColor is raised to {MIN_ATTENUATION}: a darker one has no finite extinction"));
    }
    // The maximum avoids a negative zero where the color is 1.
    Ok(color.map(|c| (-c.max(MIN_ATTENUATION).ln()).max(0.0) / distance))
}

fn scatter(draft: ScatterExtension, value: &Value, note: &mut impl FnMut(String)) -> Result<Option<Scatter>> {
    let fields = Fields::deserialize(value).map_err(|e| e.to_string())?;
    let (default_color, strength) = match draft {
        ScatterExtension::VolumeScatter => (0.0, 1.0),
        ScatterExtension::Scatter => (1.0, fields.scatter_strength_factor.unwrap_or(0.0)),
    };
    let color = fields.multiscatter_color_factor.or(fields.multiscatter_color).unwrap_or([default_color; 3]);
    let (color, asymmetry) = (DVec3::from_array(color), fields.scatter_anisotropy);
    check_color("multiscatterColorFactor", color)?;
    if !(0.0..=1.0).contains(&strength) {
        return Err(format!("scatterStrengthFactor {strength} must lie in [0, 1]"));
    }
    if !(asymmetry > -1.0 && asymmetry < 1.0) {
        return Err(format!("scatterAnisotropy {asymmetry} must lie between -1 and 1"));
    }
    let color = color * strength;
    if color == DVec3::ZERO {
        let field = if strength == 0.0 { "scatterStrengthFactor" } else { "multiscatterColorFactor" };
        note(format!("{}: {field} is 0 (its default): the medium only absorbs", draft.extension()));
        return Ok(None);
    }
    Ok(Some(Scatter { draft, color, asymmetry }))
}

fn check_color(field: &str, color: DVec3) -> Result<()> {
    let good = color.to_array().iter().all(|c| (0.0..=1.0).contains(c));
    if good { Ok(()) } else { Err(format!("{field} {color} must lie in [0, 1]")) }
}

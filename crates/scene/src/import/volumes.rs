//! Materials that bound a medium, and what the file says of it.

use super::Fault;
use crate::volume::{Scatter, ScatterExtension, Volume};
use glam::DVec3;
use gltf::json::{
    self,
    extensions::material::{self, IndexOfRefraction},
};
use serde::Deserialize;
use serde_json::Value;

/// Colors of attenuation below this are taken as this: their logarithm must be finite.
const DARKEST: f64 = 1e-4;

/// The newer draft first: it replaces the other.
const DRAFTS: [ScatterExtension; 2] = [ScatterExtension::Scatter, ScatterExtension::VolumeScatter];

/// Fields of both drafts. The older one had `multiscatterColor` until February 2026.
#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
struct Fields {
    multiscatter_color_factor: Option<[f64; 3]>,
    multiscatter_color: Option<[f64; 3]>,
    /// Of the newer draft only.
    scatter_strength_factor: Option<f64>,
    #[serde(default)]
    scatter_anisotropy: f64,
}

/// The file says that the surface bounds a medium.
pub(super) fn is_marked(m: &json::Material) -> bool {
    m.extensions
        .as_ref()
        .is_some_and(|e| e.volume.as_ref().is_some_and(|v| v.thickness_factor.0 > 0.0) || drafts(e).next().is_some())
}

fn drafts(e: &material::Material) -> impl Iterator<Item = (ScatterExtension, &Value)> {
    DRAFTS.into_iter().filter_map(|draft| Some((draft, e.others.get(draft.extension())?)))
}

/// The medium's numbers, if the material has them; `note` is told what is missing or taken otherwise.
pub(super) fn read(
    m: &json::Material,
    metres_per_unit: f64,
    mut note: impl FnMut(String),
) -> Result<Option<Volume>, Fault> {
    let Some(e) = &m.extensions else { return Ok(None) };
    let transmission = e.transmission.as_ref().map_or(0.0, |t| t.transmission_factor.0);
    let mut drafts = drafts(e);
    let draft = drafts.next();
    if let Some((older, _)) = drafts.next() {
        note(format!("{} is not used beside the draft that replaces it", older.extension()));
    }
    // Nothing enters, or there is no inside.
    let enters = transmission > 0.0 || matches!(draft, Some((ScatterExtension::VolumeScatter, _)));
    let solid = e.volume.as_ref().filter(|v| draft.is_some() || v.thickness_factor.0 > 0.0);
    let (true, Some(volume)) = (enters, solid) else {
        if let Some((draft, _)) = draft {
            let needs = if enters { "KHR_materials_volume" } else { "KHR_materials_transmission" };
            note(format!("{} has no effect without {needs}: the file gives no medium", draft.extension()));
        }
        return Ok(None);
    };
    let extinction = extinction(volume, metres_per_unit, &mut note)?;
    if extinction == DVec3::ZERO {
        if let Some((draft, _)) = draft {
            note(format!("{} without attenuationDistance and attenuationColor gives no medium", draft.extension()));
        }
        return Ok(None);
    }
    let scatter = match draft {
        Some((draft, value)) => scatter(draft, value, &mut note).map_err(|e| format!("{}: {e}", draft.extension()))?,
        None => None,
    };
    if draft.is_some() && volume.thickness_factor.0 <= 0.0 {
        note("thicknessFactor is 0, yet it is a solid".into());
    }
    let ior = e.ior.as_ref().map_or(IndexOfRefraction::default().0, |i| i.ior.0);
    // The decimal that the file has, not the float32 that was made of it.
    let ior = ior.to_string().parse().unwrap_or(f64::from(ior));
    Ok(Some(Volume { extinction, ior, scatter }))
}

/// `σ_t = −ln(attenuationColor)/attenuationDistance`, 1/m; the distance is in the world's units, whatever the node's
/// scale.
fn extinction(volume: &material::Volume, metres_per_unit: f64, note: &mut impl FnMut(String)) -> Result<DVec3, Fault> {
    let color = DVec3::from_array(volume.attenuation_color.0.map(f64::from));
    check_color("attenuationColor", color)?;
    let distance = f64::from(volume.attenuation_distance.0) * metres_per_unit;
    if distance.is_nan() || distance <= 0.0 {
        return Err(format!("attenuationDistance {} must be above zero", volume.attenuation_distance.0));
    }
    if color.min_element() < DARKEST && distance.is_finite() {
        note(format!("attenuationColor is taken as no less than {DARKEST}: a darker one has no finite extinction"));
    }
    // No negative zero where the color is 1.
    Ok(color.map(|c| (-c.max(DARKEST).ln()).max(0.0) / distance))
}

fn scatter(draft: ScatterExtension, value: &Value, note: &mut impl FnMut(String)) -> Result<Option<Scatter>, Fault> {
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

fn check_color(field: &str, color: DVec3) -> Result<(), Fault> {
    let good = color.to_array().iter().all(|c| (0.0..=1.0).contains(c));
    if good { Ok(()) } else { Err(format!("{field} {color} must lie in [0, 1]")) }
}

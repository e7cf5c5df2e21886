//! Import of lights.

use super::{
    fault::{Fault, Result, get},
    nodes::SceneNode,
    units::FileUnits,
};
use crate::{
    light::{AreaLight, DirectionalLight, Light, PointLight, Spot},
    material::Material,
    mesh::Mesh,
};
use glam::DVec3;
use gltf::json::{
    Root,
    extensions::scene::khr_lights_punctual::{Light as Punctual, Type},
    validation::Checked,
};
use std::f64::consts::FRAC_PI_2;

/// One area light for each emitting material that is on the mesh.
pub(super) fn emitters(mesh: &Mesh, materials: &[Material]) -> Vec<Box<dyn Light>> {
    let mut triangles = vec![Vec::new(); materials.len()];
    for (k, t) in mesh.triangles.iter().enumerate() {
        if materials[t.material as usize].emits() {
            triangles[t.material as usize].push(k);
        }
    }
    let light = |(m, own): (&Material, &Vec<usize>)| match &m.emission_texture {
        Some(texture) => AreaLight::textured(mesh, own, m.emission, m.double_sided, texture),
        None => AreaLight::new(mesh, own, m.emission, m.double_sided),
    };
    let lights = materials.iter().zip(&triangles).filter_map(light);
    lights.map(|light| Box::new(light) as Box<dyn Light>).collect()
}

/// The light of a node, with its position relative to `origin`.
fn light_of(
    light: &Punctual,
    node: &SceneNode,
    power: DVec3,
    origin: DVec3,
    metres_per_unit: f64,
) -> Result<Box<dyn Light>> {
    // Unit vector along which the light shines.
    let axis = || {
        let axis = node.transform.transform_vector3(DVec3::NEG_Z).try_normalize();
        axis.ok_or_else(|| Fault::from("its node's matrix has no direction (scale 0?)"))
    };
    match light.type_ {
        Checked::Valid(Type::Directional) => Ok(Box::new(DirectionalLight { direction: -axis()?, irradiance: power })),
        Checked::Valid(kind) => {
            let cone = if kind == Type::Spot { Some((axis()?, angles_of(light)?)) } else { None };
            let spot = cone.map(|(axis, [inner, outer])| Spot::new(axis, inner, outer));
            let range = range_of(light, metres_per_unit)?;
            let position = node.transform.transform_point3(DVec3::ZERO) - origin;
            Ok(Box::new(PointLight { position, intensity: power, spot, range }))
        }
        Checked::Invalid => Err("its type is not directional, point or spot".into()),
    }
}

/// The directional, point and spot lights of the nodes, with positions relative to `origin`. A light shines along the
/// −Z axis of its node, whose scale does not matter.
pub(super) fn punctual(
    root: &Root,
    nodes: &[SceneNode],
    (metres_per_unit, units): (f64, &FileUnits),
    origin: DVec3,
    warnings: &mut Vec<String>,
) -> Result<Vec<Box<dyn Light>>> {
    let mut lights = Vec::new();
    let defined = root.extensions.as_ref().and_then(|e| e.khr_lights_punctual.as_ref());
    for node in nodes {
        let Some(reference) = node.node.extensions.as_ref().and_then(|e| e.khr_lights_punctual.as_ref()) else {
            continue;
        };
        let fault = |what: Fault| format!("light of node `{}`: {what}", node.name);
        let defined = defined.ok_or("the file has no `lights` in KHR_lights_punctual".into()).map_err(fault)?;
        let light = get(&defined.lights, &reference.light, "KHR_lights_punctual.light").map_err(fault)?;
        let power = power_of(light, units).map_err(fault)?;
        if power == DVec3::ZERO {
            warnings.push(fault("its intensity is 0".into()));
            continue;
        }
        lights.push(light_of(light, node, power, origin, metres_per_unit).map_err(fault)?);
    }
    Ok(lights)
}

/// Irradiance of a directional light, W/m², or intensity of the others, W/sr.
fn power_of(light: &Punctual, units: &FileUnits) -> Result<DVec3> {
    let power = DVec3::from_array(light.color.map(f64::from)) * f64::from(light.intensity);
    if !power.is_finite() || power.min_element() < 0.0 {
        return Err(format!("color times intensity, {power}, must be finite and not negative"));
    }
    Ok(power * units.light.watts())
}

/// Inner and outer angle of a spot, rad. glTF excludes a hard edge (inner = outer), but some writers have it.
fn angles_of(light: &Punctual) -> Result<[f64; 2]> {
    let cone = light.spot.as_ref().ok_or("a spot light without its `spot` object")?;
    let (inner, outer) = (f64::from(cone.inner_cone_angle), f64::from(cone.outer_cone_angle));
    if !(inner >= 0.0 && inner <= outer && outer > 0.0 && outer <= FRAC_PI_2 + 1e-6) {
        return Err(format!("spot: innerConeAngle {inner}, outerConeAngle {outer} must be 0 <= inner < outer <= pi/2"));
    }
    Ok([inner, outer])
}

/// Range, m.
fn range_of(light: &Punctual, metres_per_unit: f64) -> Result<Option<f64>> {
    let range = light.range.map(|r| f64::from(r) * metres_per_unit);
    match range {
        Some(r) if !(r > 0.0 && r.is_finite()) => Err(format!("range {r} must be positive")),
        range => Ok(range),
    }
}

//! The file's lights, and their identity.

use super::{Fault, ImportOptions, Light, Placed, get};
use crate::{
    Material,
    light::{AreaLight, DirectionalLight, PointLight, Spot},
    mesh::Mesh,
};
use glam::DVec3;
use gltf::json::{
    Root,
    extensions::scene::khr_lights_punctual::{Light as Punctual, Type},
    validation::Checked,
};

/// Lights with a digest of everything that defines them.
#[derive(Default)]
pub(super) struct Lights {
    pub list: Vec<Box<dyn Light>>,
    pub digest: blake3::Hasher,
}

impl Lights {
    fn note(&mut self, kind: u8, numbers: &[f64]) {
        self.digest.update(&[kind]);
        numbers.iter().for_each(|x| {
            self.digest.update(&x.to_le_bytes());
        });
    }

    /// One area light for each emitting material that is on the mesh.
    pub fn add_emitters(&mut self, mesh: &Mesh, materials: &[Material]) {
        for (k, m) in materials.iter().enumerate().filter(|(_, m)| m.emits()) {
            if let Some(light) = AreaLight::new(mesh, k as u16, m.emission, m.double_sided) {
                self.note(3, &[k as f64, f64::from(u8::from(m.double_sided))]);
                self.note(3, &m.emission.to_array());
                self.list.push(Box::new(light));
            }
        }
    }
}

/// The directional, point and spot lights of the nodes; positions relative to `origin`. Lights shine along their
/// node's −Z; its scale does not matter.
pub(super) fn punctual(
    root: &Root,
    nodes: &[Placed],
    options: &ImportOptions,
    origin: DVec3,
    warnings: &mut Vec<String>,
) -> Result<Lights, Fault> {
    let mut lights = Lights::default();
    let defined = root.extensions.as_ref().and_then(|e| e.khr_lights_punctual.as_ref());
    for placed in nodes {
        let Some(reference) = placed.node.extensions.as_ref().and_then(|e| e.khr_lights_punctual.as_ref()) else {
            continue;
        };
        let defined = defined.ok_or("a node names a light but the file defines none")?;
        let light = get(&defined.lights, &reference.light, "KHR_lights_punctual.light")?;
        let fault = |what: &str| format!("light of node `{}`: {what}", placed.name);
        let color = DVec3::from_array(light.color.map(f64::from));
        let power = color * f64::from(light.intensity) * options.light_unit.watts();
        if !power.is_finite() || power.min_element() < 0.0 {
            return Err(fault("color times intensity must be finite and not negative"));
        }
        if power == DVec3::ZERO {
            warnings.push(fault("its intensity is 0"));
            continue;
        }
        let axis = placed.transform.transform_vector3(DVec3::NEG_Z).try_normalize();
        let axis = axis.ok_or_else(|| fault("its node's matrix has no direction (scale 0?)"))?;
        let position = placed.transform.transform_point3(DVec3::ZERO) - origin;
        if light.type_ == Checked::Valid(Type::Directional) {
            lights.note(1, &[axis.to_array(), power.to_array()].concat());
            lights.list.push(Box::new(DirectionalLight { direction: -axis, irradiance: power }));
            continue;
        }
        let spot = spot_of(light, axis).map_err(|e| fault(&e))?;
        let range = range_of(light, options).map_err(|e| fault(&e))?;
        lights.note(2, &[position.to_array(), power.to_array()].concat());
        lights.note(2, &spot.map_or(vec![], |s| vec![axis.x, axis.y, axis.z, s.cos_inner, s.cos_outer]));
        lights.note(2, &[range.unwrap_or(f64::INFINITY)]);
        lights.list.push(Box::new(PointLight { position, intensity: power, spot, range }));
    }
    Ok(lights)
}

fn spot_of(light: &Punctual, axis: DVec3) -> Result<Option<Spot>, Fault> {
    match (&light.type_, &light.spot) {
        (Checked::Valid(Type::Point), _) => Ok(None),
        (Checked::Valid(Type::Spot), Some(cone)) => {
            let (inner, outer) = (f64::from(cone.inner_cone_angle), f64::from(cone.outer_cone_angle));
            if !(inner >= 0.0 && inner < outer && outer <= std::f64::consts::FRAC_PI_2 + 1e-6) {
                return Err(format!("cone angles {inner}, {outer} must satisfy 0 <= inner < outer <= pi/2"));
            }
            Ok(Some(Spot { axis, cos_inner: inner.cos(), cos_outer: outer.cos() }))
        }
        (Checked::Valid(Type::Spot), None) => Err("a spot light without its `spot` object".into()),
        _ => Err("its type is not directional, point or spot".into()),
    }
}

fn range_of(light: &Punctual, options: &ImportOptions) -> Result<Option<f64>, Fault> {
    let range = light.range.map(|r| f64::from(r) * options.metres_per_unit);
    match range {
        Some(r) if !(r > 0.0 && r.is_finite()) => Err(format!("range {r} must be positive")),
        range => Ok(range),
    }
}

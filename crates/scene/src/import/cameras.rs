//! Import of cameras.

use super::{
    fault::{Fault, Result, get},
    nodes::SceneNode,
};
use crate::view::{Camera, Projection};
use glam::DVec3;
use gltf::json::{self, camera::Type, validation::Checked};
use std::f64::consts::PI;

/// Most bytes of the names of all cameras, counted for each node that carries one.
const MAX_NAME_BYTES: usize = 1 << 24;

/// One camera for each node that carries one, in the order of the nodes.
pub(super) fn read(root: &json::Root, nodes: &[SceneNode], metres_per_unit: f64) -> Result<Vec<Camera>> {
    let mut cameras = Vec::new();
    let mut room = MAX_NAME_BYTES;
    for placed in nodes {
        let Some(index) = &placed.node.camera else { continue };
        let fault = |what: Fault| format!("camera of node `{}`: {what}", placed.name);
        let camera = get(&root.cameras, index, "node.camera").map_err(fault)?;
        let left = room.checked_sub(camera.name.as_ref().map_or(0, String::len));
        let full = || format!("the names of cameras have more than {MAX_NAME_BYTES} bytes in all; shorten them");
        room = left.ok_or_else(|| fault(full()))?;
        cameras.push(of_node(placed, camera, metres_per_unit).map_err(fault)?);
    }
    Ok(cameras)
}

fn of_node(placed: &SceneNode, camera: &json::Camera, metres_per_unit: f64) -> Result<Camera> {
    let (projection, aspect) = match (&camera.type_, &camera.perspective, &camera.orthographic) {
        (Checked::Valid(Type::Perspective), Some(p), _) => {
            (perspective(f64::from(p.yfov))?, p.aspect_ratio.map(f64::from))
        }
        (Checked::Valid(Type::Orthographic), _, Some(o)) => {
            let half_height = f64::from(o.ymag) * metres_per_unit;
            if !(half_height > 0.0 && half_height.is_finite()) {
                return Err(format!("ymag {} must be positive", o.ymag));
            }
            (Projection::Orthographic { half_height }, Some(f64::from(o.xmag) / f64::from(o.ymag)))
        }
        _ => return Err("neither a perspective nor an orthographic projection".into()),
    };
    if let Some(a) = aspect.filter(|a| !(*a > 0.0 && a.is_finite())) {
        return Err(format!("its aspect ratio {a} must be positive"));
    }
    // Whatever the scale of the node.
    let axis = |v: DVec3| placed.transform.transform_vector3(v).try_normalize();
    let name = camera.name.clone().unwrap_or_else(|| placed.name.clone());
    let position = placed.transform.transform_point3(DVec3::ZERO);
    let camera = axis(-DVec3::Z).zip(axis(DVec3::Y)).and_then(|(forward, up)| {
        Camera::looking((name, placed.name.clone()), position, [forward, up], projection, aspect)
    });
    camera.ok_or_else(|| "its node's matrix has no direction (scale 0?)".into())
}

fn perspective(yfov: f64) -> Result<Projection> {
    let tangent = (0.5 * yfov).tan();
    // Beyond pi, the tangent is that of another angle.
    if !(yfov > 0.0 && yfov < PI && tangent.is_finite()) {
        return Err(format!("yfov {yfov} must lie between 0 and pi"));
    }
    Ok(Projection::Perspective { tangent })
}

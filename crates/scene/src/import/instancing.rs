//! EXT_mesh_gpu_instancing: copies of the mesh of a node, each at a place of its own.

use super::{accessor::CheckedAccessor, container::Document, fault::Result};
use glam::{DMat4, DQuat, DVec3};
use gltf::json::{Accessor, Index, accessor::Type, scene::Node};
use serde::Deserialize;

/// The name of the extension.
pub(super) const NAME: &str = "EXT_mesh_gpu_instancing";

#[derive(Deserialize)]
struct Instancing {
    attributes: Attributes,
}

/// The places of the copies. Other attributes serve applications.
#[derive(Deserialize)]
#[serde(rename_all = "UPPERCASE")]
struct Attributes {
    translation: Option<Index<Accessor>>,
    rotation: Option<Index<Accessor>>,
    scale: Option<Index<Accessor>>,
}

/// The copies of a node's mesh, checked and not read: there may be many.
pub(super) struct Copies<'a> {
    translations: Option<CheckedAccessor<'a>>,
    rotations: Option<CheckedAccessor<'a>>,
    scales: Option<CheckedAccessor<'a>>,
    pub count: usize,
}

impl<'a> Copies<'a> {
    /// The copies of a node, if it has the extension.
    pub fn of(document: &'a Document, node: &Node) -> Result<Option<Self>> {
        let Some(object) = node.extensions.as_ref().and_then(|e| e.others.get(NAME)) else { return Ok(None) };
        let Instancing { attributes } = Instancing::deserialize(object).map_err(|e| format!("{NAME}: {e}"))?;
        let column = |index: Option<Index<Accessor>>, field: &str, shape| {
            index.map(|i| CheckedAccessor::animated(document, &i, format!("{NAME}: {field}"), shape)).transpose()
        };
        let translations = column(attributes.translation, "TRANSLATION", Type::Vec3)?;
        let rotations = column(attributes.rotation, "ROTATION", Type::Vec4)?;
        let scales = column(attributes.scale, "SCALE", Type::Vec3)?;
        let counts: Vec<usize> =
            [&translations, &rotations, &scales].into_iter().flatten().map(CheckedAccessor::len).collect();
        let count = counts.first().map_or(1, |first| *first);
        if counts.iter().any(|other| *other != count) {
            return Err(format!("{NAME}: its attributes have different numbers of elements"));
        }
        Ok(Some(Copies { translations, rotations, scales, count }))
    }

    /// The transform of copy `k`, from the mesh to the node.
    pub fn transform(&self, k: usize) -> Result<DMat4> {
        let vector = |column: &Option<CheckedAccessor>, otherwise: DVec3| match column {
            Some(column) => column.real::<3>(k).map(|v| DVec3::from_array(v.map(f64::from))),
            None => Ok(otherwise),
        };
        let rotation = match &self.rotations {
            Some(column) => DQuat::from_array(column.real::<4>(k)?.map(f64::from)),
            None => DQuat::IDENTITY,
        };
        let length = rotation.length();
        if !(length > 0.0 && length.is_finite()) {
            return Err(format!("{NAME}: rotation {k} is no unit quaternion"));
        }
        let (scale, translation) = (vector(&self.scales, DVec3::ONE)?, vector(&self.translations, DVec3::ZERO)?);
        Ok(DMat4::from_scale_rotation_translation(scale, rotation / length, translation))
    }
}

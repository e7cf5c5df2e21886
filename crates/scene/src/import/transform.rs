//! Transforms of nodes in float64; the gltf crate rounds them to float32.

use super::fault::Result;
use glam::{DMat4, DQuat, DVec3, DVec4};
use serde::Deserialize;

/// The local transform of a node as in the file.
#[derive(Clone, Deserialize)]
pub(super) struct NodeTransform {
    matrix: Option<[f64; 16]>,
    translation: Option<[f64; 3]>,
    rotation: Option<[f64; 4]>,
    scale: Option<[f64; 3]>,
}

impl NodeTransform {
    pub fn matrix(&self) -> Result<DMat4> {
        if let Some(m) = &self.matrix {
            if self.translation.is_some() || self.rotation.is_some() || self.scale.is_some() {
                return Err("`matrix` excludes `translation`, `rotation` and `scale`".into());
            }
            return affine(m);
        }
        let rotation = DQuat::from_array(self.rotation.unwrap_or([0.0, 0.0, 0.0, 1.0]));
        let length = rotation.length();
        if !(length > 0.0 && length.is_finite()) {
            return Err(format!("`rotation` {rotation} is no unit quaternion"));
        }
        let scale = DVec3::from_array(self.scale.unwrap_or([1.0; 3]));
        let translation = DVec3::from_array(self.translation.unwrap_or([0.0; 3]));
        Ok(DMat4::from_scale_rotation_translation(scale, rotation / length, translation))
    }
}

/// What animations set. A matrix is taken apart first, though glTF excludes it for nodes that move.
impl NodeTransform {
    pub fn set_translation(&mut self, translation: [f64; 3]) -> Result<()> {
        self.take_apart()?;
        self.translation = Some(translation);
        Ok(())
    }

    pub fn set_rotation(&mut self, rotation: [f64; 4]) -> Result<()> {
        self.take_apart()?;
        self.rotation = Some(rotation);
        Ok(())
    }

    pub fn set_scale(&mut self, scale: [f64; 3]) -> Result<()> {
        self.take_apart()?;
        self.scale = Some(scale);
        Ok(())
    }

    fn take_apart(&mut self) -> Result<()> {
        if self.matrix.is_some() {
            let (scale, rotation, translation) = self.matrix()?.to_scale_rotation_translation();
            self.matrix = None;
            self.scale = Some(scale.to_array());
            self.rotation = Some(rotation.to_array());
            self.translation = Some(translation.to_array());
        }
        Ok(())
    }
}

/// A matrix by columns, which must be affine, because points are not divided by w.
fn affine(m: &[f64; 16]) -> Result<DMat4> {
    // Some writers compute in float32.
    const TOLERANCE: f64 = 1e-6;
    let row = DVec4::new(m[3], m[7], m[11], m[15]);
    if !row.abs_diff_eq(DVec4::W, TOLERANCE) {
        return Err(format!("the last row of `matrix` is {row}, not [0, 0, 0, 1]"));
    }
    let mut columns = *m;
    (columns[3], columns[7], columns[11], columns[15]) = (0.0, 0.0, 0.0, 1.0);
    Ok(DMat4::from_cols_array(&columns))
}

//! The content of a scene file and its view files. Lengths are in metres, Y is up.

use glam::{DMat3, DQuat, DVec3};

use crate::mesh::Mesh;

/// Index of refraction written for translucent materials. `gather` takes the one of the medium it is given; this is
/// the value of Jensen et al. 2001, so that other glTF viewers show something close.
const INDEX_OF_REFRACTION: f64 = 1.3;

pub struct Scene {
    pub name: &'static str,
    pub parts: Vec<Part>,
    pub lights: Vec<Light>,
    pub cameras: Vec<Shot>,
    pub views: Vec<View>,
}

/// A mesh and what it is made of; the node, the mesh and the material share the name.
pub struct Part {
    pub name: &'static str,
    pub mesh: Mesh,
    pub surface: Surface,
}

#[derive(Clone, Copy)]
pub enum Surface {
    /// Marked by glTF as a volume that transmits: its surface is sampled into the cloud.
    Translucent { index_of_refraction: f64 },
    /// Lambertian with this reflectance.
    Opaque { base_color: [f64; 3] },
    /// Emits this radiance, W/(m² sr), to the side that it faces.
    Emitting { radiance: [f64; 3] },
}

impl Surface {
    pub const TRANSLUCENT: Self = Self::Translucent { index_of_refraction: INDEX_OF_REFRACTION };
}

pub struct Light {
    pub name: &'static str,
    pub kind: LightKind,
    /// Directional: irradiance of a surface that faces the light, W/m². Others: radiant intensity, W/sr.
    pub intensity: f64,
    pub color: [f64; 3],
    pub position: DVec3,
    /// The direction in which the light shines; a point light ignores it.
    pub direction: DVec3,
}

#[derive(Clone, Copy)]
pub enum LightKind {
    Directional,
    Point,
    Spot { inner_cone_radians: f64, outer_cone_radians: f64 },
}

/// Position and field of view of a camera.
#[derive(Clone, Copy)]
pub struct Shot {
    pub name: &'static str,
    pub eye: DVec3,
    pub target: DVec3,
    pub up: DVec3,
    pub yfov_degrees: f64,
}

/// A view file: a shot with a resolution in pixels. Square, as every view here is.
pub struct View {
    pub name: &'static str,
    pub shot: Shot,
    pub side_pixels: u32,
}

impl Shot {
    pub fn rotation(&self) -> DQuat {
        facing(self.target - self.eye, self.up)
    }
}

impl Light {
    pub fn rotation(&self) -> DQuat {
        // Lights are symmetric about their axis: any up direction that is not along the beam gives the same light.
        let up = if self.direction.normalize().y.abs() < 0.9 { DVec3::Y } else { DVec3::Z };
        facing(self.direction, up)
    }
}

impl View {
    /// The text is formatted by hand to keep the order of the fields.
    pub fn to_json(&self) -> String {
        let Shot { eye, target, up, yfov_degrees, .. } = self.shot;
        let triple = |v: DVec3| format!("[{}, {}, {}]", v.x, v.y, v.z);
        format!(
            "{{\n  \"eye\": {},\n  \"target\": {},\n  \"up\": {},\n  \"yfov\": {yfov_degrees},\n  \"width\": {},\n  \"height\": {}\n}}\n",
            triple(eye),
            triple(target),
            triple(up),
            self.side_pixels,
            self.side_pixels,
        )
    }
}

/// Rotation that turns the node's -Z, along which glTF cameras look and lights shine, to `direction`.
fn facing(direction: DVec3, up: DVec3) -> DQuat {
    let back = -direction.normalize();
    let right = up.cross(back).normalize();
    DQuat::from_mat3(&DMat3::from_cols(right, back.cross(right), back)).normalize()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rotation_turns_minus_z_to_the_target() {
        for (direction, up) in [
            (DVec3::NEG_Y, DVec3::NEG_Z),
            (DVec3::NEG_Z, DVec3::Y),
            (DVec3::Z, DVec3::Y),
            (DVec3::new(1.0, -2.0, 0.3), DVec3::Y),
        ] {
            let turned = facing(direction, up) * DVec3::NEG_Z;
            assert!(turned.distance(direction.normalize()) < 1e-12, "{direction} became {turned}");
        }
    }

    #[test]
    fn views_are_json_with_exactly_the_fields_of_a_view() {
        for scene in crate::SCENES.iter() {
            for view in &scene.views {
                let value: serde_json::Value = serde_json::from_str(&view.to_json()).expect("valid JSON");
                let mut fields: Vec<_> = value.as_object().expect("an object").keys().cloned().collect();
                fields.sort();
                assert_eq!(fields, ["eye", "height", "target", "up", "width", "yfov"]);
            }
        }
    }
}

//! The content of a scene file and its view files. Lengths are in metres, Y is up.

use glam::{DMat3, DQuat, DVec2, DVec3};
use picture::Picture;

use crate::mesh::Mesh;

/// Index of refraction written for translucent materials. `gather` takes the one of the medium it is given; this is
/// the value of Jensen et al. 2001, so that other glTF viewers show something close.
const INDEX_OF_REFRACTION: f64 = 1.3;

pub struct Scene {
    pub name: &'static str,
    pub parts: Vec<Part>,
    pub lights: Vec<Light>,
    pub indices: Indices,
    pub cameras: Vec<Shot>,
    pub views: Vec<View>,
}

/// How a file counts vertices.
#[derive(Clone, Copy, PartialEq)]
pub enum Indices {
    /// By 32 bits.
    Long,
    /// By 16 bits where a mesh is small enough.
    Short,
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
    Translucent { index_of_refraction: f64, finish: Finish },
    /// Lambertian with this reflectance.
    Opaque { base_color: [f64; 3] },
    /// Lambertian, with the colors of these pictures.
    Pictured { pictures: Pictures },
    /// Opaque by the metallic-roughness model of glTF.
    Glossy { finish: Finish },
    /// Emits this radiance, W/(m² sr), to the side that it faces.
    Emitting { radiance: [f64; 3] },
}

impl Surface {
    pub const TRANSLUCENT: Self = Self::rough(0.0);

    /// Translucent, with this roughness.
    pub const fn rough(roughness: f64) -> Self {
        let finish = Finish { roughness, ..Finish::SMOOTH };
        Self::Translucent { index_of_refraction: INDEX_OF_REFRACTION, finish }
    }

    /// A plastic, a glaze or a varnish of this roughness.
    pub const fn glossy(base_color: [f64; 3], roughness: f64) -> Self {
        Self::Glossy { finish: Finish { base_color, roughness, ..Finish::SMOOTH } }
    }

    pub fn pictures(&self) -> Option<Pictures> {
        match *self {
            Self::Translucent { finish, .. } | Self::Glossy { finish } => finish.pictures,
            Self::Pictured { pictures } => Some(pictures),
            Self::Opaque { .. } | Self::Emitting { .. } => None,
        }
    }
}

/// What a surface looks like from near.
#[derive(Clone, Copy)]
pub struct Finish {
    /// A factor of the picture; translucent surfaces have none.
    pub base_color: [f64; 3],
    pub metallic: f64,
    pub roughness: f64,
    pub pictures: Option<Pictures>,
}

impl Finish {
    pub const SMOOTH: Self = Self { base_color: [1.0; 3], metallic: 0.0, roughness: 0.0, pictures: None };
}

/// The pictures on a surface.
#[derive(Clone, Copy)]
pub struct Pictures {
    /// The texture coordinates of a place of the scene, m.
    pub coordinates: fn(DVec3) -> DVec2,
    pub base_color: fn() -> Picture,
    pub bumps: Option<Bumps>,
}

/// A normal map, which repeats so many times where the base color is shown once.
#[derive(Clone, Copy)]
pub struct Bumps {
    pub picture: fn() -> Picture,
    pub repeats: f64,
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

/// The lens of a view.
#[derive(Clone, Copy)]
pub struct Lens {
    /// Radius of its opening, m.
    pub aperture: f64,
    /// How far the plane in focus is, m.
    pub focus: f64,
}

/// A view file: a shot with a resolution in pixels. Square, as every view here is.
pub struct View {
    pub name: &'static str,
    pub shot: Shot,
    pub side_pixels: u32,
    /// None if all is in focus.
    pub lens: Option<Lens>,
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
        let lens = self.lens.map_or(String::new(), |Lens { aperture, focus }| {
            format!(",\n  \"aperture\": {aperture},\n  \"focus\": {focus}")
        });
        let triple = |v: DVec3| format!("[{}, {}, {}]", v.x, v.y, v.z);
        format!(
            "{{\n  \"eye\": {},\n  \"target\": {},\n  \"up\": {},\n  \"yfov\": {yfov_degrees},\n  \"width\": {},\n  \"height\": {}{lens}\n}}\n",
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
                let with_lens = ["aperture", "eye", "focus", "height", "target", "up", "width", "yfov"];
                let without = ["eye", "height", "target", "up", "width", "yfov"];
                assert_eq!(fields, if view.lens.is_some() { with_lens.as_slice() } else { &without });
            }
        }
    }
}

//! What a hard case is, and its files.

use crate::error::Error;
use bssrdf::DVec3;
use make_scenes::{
    glb,
    scene::{Light, LightKind, Part, Scene, Shot, View},
    sky,
};
use serde_json::json;
use std::{
    f64::consts::PI,
    fs,
    path::{Path, PathBuf},
};

/// A scene of one translucent object that is seen from two opposite sides.
pub struct Case {
    pub name: &'static str,
    /// What it is and how it is lit.
    pub what: &'static str,
    pub parts: fn() -> Vec<Part>,
    pub light: Lighting,
    pub medium: Medium,
    /// The first camera; the second stands on the other side of the target.
    pub eye: DVec3,
    pub target: DVec3,
    pub yfov_degrees: f64,
    pub normals: &'static str,
    /// Camera paths for each pixel of exact images: lamps that walks meet by chance want more, constant light less.
    pub paths: u32,
}

/// What lights a scene beside its emitting parts.
#[derive(Clone, Copy)]
pub enum Lighting {
    /// Light that shines along this direction, with the irradiance π.
    Sun(DVec3),
    /// A light of this kind at a position, as intense as it takes for the irradiance π at the distance.
    Lamp { kind: LightKind, position: DVec3, towards: DVec3, distance: f64 },
    /// A constant radiance, red, green and blue.
    Constant([f64; 3]),
    /// A hazy sky with a low sun.
    Sky,
    /// Emitting parts alone.
    Parts,
}

/// A medium.
#[derive(Clone, Copy)]
pub enum Medium {
    BuiltIn(&'static str),
    /// One of its own, 1/mm.
    Own {
        sigma_a: [f64; 3],
        sigma_s: [f64; 3],
        g: f64,
    },
}

/// A case in files.
pub struct Files {
    pub scene: PathBuf,
    pub medium: String,
    /// Arguments of all programs.
    pub shared: Vec<String>,
    /// Arguments of `gather` for each camera.
    pub views: [Vec<String>; 2],
}

impl Case {
    /// Writes what the programs read into a folder.
    pub fn write(&self, folder: &Path) -> Result<Files, Error> {
        let put = |kind: &str, bytes: &[u8]| -> Result<PathBuf, Error> {
            let path = folder.join(format!("{}.{kind}", self.name.replace(' ', "-")));
            fs::write(&path, bytes).map_err(Error::file(&path))?;
            Ok(path)
        };
        let scene = Scene {
            name: self.name,
            parts: (self.parts)(),
            lights: self.light.lights(),
            indices: make_scenes::scene::Indices::Long,
            cameras: Vec::new(),
            views: Vec::new(),
        };
        let medium = match self.medium {
            Medium::BuiltIn(name) => name.to_owned(),
            Medium::Own { sigma_a, sigma_s, g } => {
                let facts = json!({
                    "name": self.name, "unit": "1/mm", "sigma_a": sigma_a, "sigma_s": sigma_s, "g": g, "eta": 1.3,
                    "source": "chosen for this report",
                });
                put("medium.json", facts.to_string().as_bytes())?.display().to_string()
            }
        };
        let mut shared = vec!["--normals".to_owned(), self.normals.to_owned()];
        match self.light {
            Lighting::Constant(radiance) => {
                shared.extend(["--environment".into(), radiance.map(|x| x.to_string()).join(",")]);
            }
            Lighting::Sky => shared.extend(["--environment".into(), put("hdr", &sky::encode())?.display().to_string()]),
            _ => {}
        }
        let view = |name: &str, eye: DVec3| -> Result<Vec<String>, Error> {
            let shot = Shot { name: "View", eye, target: self.target, up: DVec3::Y, yfov_degrees: self.yfov_degrees };
            let text = View { name: "view", shot, side_pixels: 128, lens: None }.to_json();
            Ok(vec!["--view".to_owned(), put(name, text.as_bytes())?.display().to_string()])
        };
        let views = [view("front.json", self.eye)?, view("back.json", 2.0 * self.target - self.eye)?];
        Ok(Files { scene: put("glb", &glb::encode(&scene))?, medium, shared, views })
    }
}

impl Lighting {
    fn lights(self) -> Vec<Light> {
        let (kind, intensity, position, direction) = match self {
            Lighting::Sun(direction) => (LightKind::Directional, PI, -direction, direction),
            Lighting::Lamp { kind, position, towards, distance } => {
                (kind, PI * distance * distance, position, towards - position)
            }
            Lighting::Constant(_) | Lighting::Sky | Lighting::Parts => return Vec::new(),
        };
        vec![Light { name: "Light", kind, intensity, color: [1.0; 3], position, direction }]
    }
}

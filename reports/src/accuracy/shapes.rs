//! The shapes that images are measured on: each under one sun, whose irradiance is π, and without opaque surfaces.

use crate::error::Error;
use bssrdf::{DVec3, Medium};
use make_scenes::{
    chess, figure, glb,
    lattice::{Lattice, even_cuts},
    mesh::Mesh,
    piglet,
    scene::{Light, LightKind, Part, Scene, Shot, Surface, View},
    sphere,
};
use std::{
    f64::consts::PI,
    fs,
    path::{Path, PathBuf},
};

/// A shape with its light and its camera.
pub struct Shape {
    pub name: &'static str,
    /// What it is and how it is lit, as a sentence.
    pub what: &'static str,
    mesh: fn(&Medium) -> Mesh,
    /// Towards the sun, of any length.
    to_sun: DVec3,
    eye: DVec3,
    target: DVec3,
    yfov_degrees: f64,
    /// Paths for each pixel of an exact image, so many that two of skim milk take about a minute of processor time.
    pub exact_paths: u32,
}

/// All shapes. Two are lit from the side of the camera, three from behind.
pub const SHAPES: [Shape; 5] = [
    Shape {
        name: "sphere",
        what: "A sphere of 40 mm, lit from the right.",
        mesh: |_| part(sphere::scene(), "Sphere"),
        to_sun: DVec3::X,
        eye: DVec3::new(0.0, 0.0, 0.12),
        target: DVec3::ZERO,
        yfov_degrees: 24.0,
        exact_paths: 64,
    },
    Shape {
        name: "chess",
        what: "A queen and a pawn of chess, the queen 39 mm high, lit from the right and the front: waists of 5 mm, \
               folds and shadows.",
        mesh: |_| part(chess::scene(), "Marble"),
        to_sun: DVec3::new(1.0, 0.6, 0.4),
        eye: DVec3::new(0.01, 0.06, 0.15),
        target: DVec3::new(-0.02, 0.018, 0.0),
        yfov_degrees: 18.0,
        exact_paths: 24,
    },
    Shape {
        name: "piglet",
        what: "A piglet, 100 mm high, with ears of 3 mm, lit from behind.",
        mesh: |_| part(piglet::scene(), "Skin"),
        to_sun: DVec3::new(0.35, 0.5, -1.0),
        eye: DVec3::new(0.07, 0.1, 0.3),
        target: DVec3::new(0.001, 0.045, 0.0),
        yfov_degrees: 23.0,
        exact_paths: 24,
    },
    Shape {
        name: "bear",
        what: "A seated bear, 60 mm high, lit from behind.",
        mesh: |_| part(figure::scene(), "Figure"),
        to_sun: DVec3::new(-0.4, 0.5, -1.0),
        eye: DVec3::new(0.002, 0.08, 0.178),
        target: DVec3::new(0.002, 0.028, 0.002),
        yfov_degrees: 25.0,
        exact_paths: 24,
    },
    Shape {
        name: "sheet",
        what: "A bent sheet of 50 x 50 mm, lit from behind. It is two reduced mean free paths thick in the green, which \
               is 0.8 mm of marble and 1.9 mm of ketchup.",
        mesh: sheet,
        to_sun: DVec3::new(0.3, 0.3, -1.0),
        eye: DVec3::new(0.04, 0.05, 0.2),
        target: DVec3::new(0.0, 0.0, -0.003),
        yfov_degrees: 19.0,
        exact_paths: 24,
    },
];

/// A shape of a medium in files.
pub struct Files {
    pub scene: PathBuf,
    /// Arguments of `gather`.
    pub view: [String; 2],
}

/// Arguments of both programs: walks know no other normals than those of the triangles.
pub fn shared() -> [String; 2] {
    ["--normals", "geometric"].map(String::from)
}

impl Shape {
    /// Writes the scene and its camera into a folder.
    pub fn write(&self, medium: &Medium, folder: &Path) -> Result<Files, Error> {
        let shot =
            Shot { name: "Front", eye: self.eye, target: self.target, up: DVec3::Y, yfov_degrees: self.yfov_degrees };
        let scene = Scene {
            name: self.name,
            parts: vec![Part { name: "Shape", mesh: (self.mesh)(medium), surface: Surface::TRANSLUCENT }],
            lights: vec![Light {
                name: "Sun",
                kind: LightKind::Directional,
                intensity: PI,
                color: [1.0; 3],
                position: self.to_sun,
                direction: -self.to_sun,
            }],
            indices: make_scenes::scene::Indices::Long,
            cameras: vec![shot],
            views: Vec::new(),
        };
        let name = format!("{}-{}", self.name, medium.name);
        let [file, view] = ["glb", "json"].map(|kind| folder.join(format!("{name}.{kind}")));
        fs::write(&file, glb::encode(&scene)).map_err(Error::file(&file))?;
        let camera = View { name: "front", shot, side_pixels: 128, lens: None };
        fs::write(&view, camera.to_json()).map_err(Error::file(&view))?;
        Ok(Files { scene: file, view: ["--view".into(), view.display().to_string()] })
    }
}

/// The mesh of a part of a scene of the gallery.
fn part(scene: Scene, name: &str) -> Mesh {
    let found = scene.parts.into_iter().find(|part| part.name == name);
    found.map(|part| part.mesh).expect("the scene has this part: a test builds all shapes")
}

/// A sheet bent about a vertical axis, with its hollow side to the sun.
fn sheet(medium: &Medium) -> Mesh {
    const HALF_WIDTH_M: f64 = 0.025;
    const RADIUS_M: f64 = 0.04;
    let half_thickness = 1.0 / medium.channels[1].reduced_extinction();
    let across = even_cuts(-HALF_WIDTH_M, HALF_WIDTH_M, 40);
    let through = even_cuts(-half_thickness, half_thickness, 1);
    let flat = Lattice { cuts_m: [across.clone(), across, through] }.surface();
    let bent = |p: &DVec3| {
        let (sine, cosine) = (p.x / RADIUS_M).sin_cos();
        let radius = RADIUS_M + p.z;
        DVec3::new(radius * sine, p.y, radius * cosine - RADIUS_M).as_vec3()
    };
    Mesh { positions: flat.positions_m.iter().map(bent).collect(), normals: Vec::new(), triangles: flat.triangles }
}

#[cfg(test)]
mod tests {
    use super::*;
    use bssrdf::built_in;

    /// Objects are 20 to 150 mm large, and all of them are in view.
    #[test]
    fn shapes_are_of_a_plausible_size_and_in_view() {
        let medium = built_in("marble").unwrap();
        for shape in SHAPES {
            let mesh = (shape.mesh)(&medium);
            let (low, high) = mesh.bounds();
            let size = (high - low).max_element();
            assert!((0.02..0.15).contains(&size), "{}: {size} m", shape.name);
            let forward = (shape.target - shape.eye).normalize();
            let right = forward.cross(DVec3::Y).normalize();
            let up = right.cross(forward);
            let edge = (0.5 * shape.yfov_degrees).to_radians().tan();
            for p in &mesh.positions {
                let from_eye = p.as_dvec3() - shape.eye;
                let depth = from_eye.dot(forward);
                let [x, y] = [right, up].map(|axis| from_eye.dot(axis) / depth / edge);
                assert!(x.abs() < 1.0 && y.abs() < 1.0, "{}: ({x}, {y})", shape.name);
            }
        }
    }
}

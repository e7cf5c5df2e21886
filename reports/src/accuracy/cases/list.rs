//! The hard cases. Lights give an irradiance near π, so that a white surface has a radiance near 1.

use super::scenes::{Case, Lighting, Medium};
use bssrdf::DVec3;
use make_scenes::{
    lattice::{Lattice, even_cuts},
    mesh::Mesh,
    piglet,
    scene::{LightKind, Part, Surface},
};
use test_support::meshes;

const RADIUS_M: f64 = 0.02;
const FROM_THE_SIDE: Lighting = Lighting::Sun(DVec3::new(-1.0, -0.3, -0.4));
const MILK: Medium = Medium::BuiltIn("skimmilk");

/// A sphere of skim milk in front of the camera.
const SPHERE: Case = Case {
    name: "sphere",
    what: "a sphere of 40 mm, skim milk, for comparison",
    parts: || vec![translucent(ball(RADIUS_M, DVec3::ZERO))],
    light: FROM_THE_SIDE,
    medium: MILK,
    eye: DVec3::new(0.0, 0.0, 0.12),
    target: DVec3::ZERO,
    yfov_degrees: 24.0,
    normals: "geometric",
    paths: 128,
};

/// The piglet of marble, 15 m high.
const LARGE: Case = Case {
    parts: || vec![translucent(skin(150.0))],
    medium: Medium::BuiltIn("marble"),
    eye: DVec3::new(0.0, 9.0, 45.0),
    target: DVec3::new(0.0, 7.5, 0.0),
    paths: 64,
    ..SPHERE
};

/// All cases.
pub const CASES: [Case; 17] = [
    SPHERE,
    Case {
        name: "sheet",
        what: "a sheet of 40 x 40 x 1.5 mm lit from behind: 1, 2 and 3 mean free paths of skim milk",
        parts: || vec![translucent(sheet())],
        light: Lighting::Sun(DVec3::new(0.2, -0.3, 1.0)),
        eye: DVec3::new(0.03, 0.02, 0.12),
        yfov_degrees: 22.0,
        ..SPHERE
    },
    Case {
        name: "ear",
        what: "an ear of the piglet, 3.4 mm thin and bent, lit from behind, skin1",
        parts: || vec![translucent(skin(1.0))],
        light: Lighting::Sun(DVec3::new(-0.1, -0.3, 1.0)),
        medium: Medium::BuiltIn("skin1"),
        eye: DVec3::new(0.0, 0.1, 0.25),
        target: DVec3::new(0.023, 0.08, -0.003),
        yfov_degrees: 11.0,
        ..SPHERE
    },
    Case {
        name: "shell",
        what: "a hollow sphere with a wall of 3 mm, skim milk: two surfaces, one inside the other",
        parts: || vec![translucent(ball(RADIUS_M, DVec3::ZERO).and(inverted(ball(0.017, DVec3::ZERO))))],
        ..SPHERE
    },
    Case {
        name: "pair",
        what: "two spheres of 22 mm, 2 mm apart, of one material, the one in the shadow of the other",
        parts: || {
            let [left, right] = [-0.012, 0.012].map(|x| ball(0.011, DVec3::new(x, 0.0, 0.0)));
            vec![translucent(left.and(right))]
        },
        ..SPHERE
    },
    Case {
        name: "nested",
        what: "a sphere of 20 mm inside one of 40 mm, of one material",
        parts: || vec![translucent(ball(RADIUS_M, DVec3::ZERO).and(ball(0.01, DVec3::ZERO)))],
        ..SPHERE
    },
    Case {
        name: "forward",
        what: "the sphere with g = 0.9 and ten times the scattering, skim milk",
        medium: Medium::Own { sigma_a: [0.0014, 0.0025, 0.0142], sigma_s: [7.0, 12.2, 19.0], g: 0.9 },
        paths: 96,
        ..SPHERE
    },
    Case {
        name: "forward skin",
        what: "the sphere with g = 0.9 and ten times the scattering, skin1",
        medium: Medium::Own { sigma_a: [0.032, 0.17, 0.48], sigma_s: [7.4, 8.8, 10.1], g: 0.9 },
        ..SPHERE
    },
    Case {
        name: "point",
        what: "the sphere with a point light 15 mm from its surface",
        light: Lighting::Lamp {
            kind: LightKind::Point,
            position: DVec3::new(0.025, 0.01, 0.022),
            towards: DVec3::ZERO,
            distance: 0.015,
        },
        ..SPHERE
    },
    Case {
        name: "spot",
        what: "the sphere with a spot of 12 mm on it",
        light: Lighting::Lamp {
            kind: LightKind::Spot { inner_cone_radians: 0.1, outer_cone_radians: 0.16 },
            position: DVec3::new(0.055, 0.02, 0.042),
            towards: DVec3::new(0.0, 0.0, 0.012),
            distance: 0.05,
        },
        ..SPHERE
    },
    Case {
        name: "constant",
        what: "the sphere in a constant environment",
        light: Lighting::Constant([1.0, 0.6, 0.3]),
        paths: 32,
        ..SPHERE
    },
    Case { name: "sky", what: "the sphere under a sky with a low sun", light: Lighting::Sky, paths: 256, ..SPHERE },
    Case {
        name: "area",
        what: "the sphere with an emitting square of 40 mm, 30 mm from its surface",
        parts: || vec![translucent(ball(RADIUS_M, DVec3::ZERO)), emitter()],
        light: Lighting::Parts,
        paths: 256,
        ..SPHERE
    },
    Case {
        name: "normals",
        what: "the sphere of 512 triangles with smooth normals and `--normals shading`",
        parts: || vec![translucent(smooth(RADIUS_M, 3))],
        normals: "shading",
        ..SPHERE
    },
    Case {
        name: "large",
        what: "the piglet, 1.5 m high, marble: samples lie ten times as far apart as light travels",
        parts: || vec![translucent(skin(15.0))],
        eye: DVec3::new(0.0, 0.9, 4.5),
        target: DVec3::new(0.0, 0.75, 0.0),
        ..LARGE
    },
    Case { name: "huge", what: "the same, 15 m high", ..LARGE },
    Case {
        name: "white",
        what: "the sphere without absorption in a constant environment: everything that enters leaves",
        light: Lighting::Constant([1.0; 3]),
        medium: Medium::Own { sigma_a: [0.0; 3], sigma_s: [1.0, 2.0, 3.0], g: 0.0 },
        paths: 32,
        ..SPHERE
    },
];

fn translucent(mesh: Mesh) -> Part {
    Part { name: "Object", mesh, surface: Surface::TRANSLUCENT }
}

/// A sphere of 8192 triangles.
fn ball(radius_m: f64, center: DVec3) -> Mesh {
    smooth(radius_m, 5).moved(center)
}

/// A sphere of `8 * 4^splits` triangles with the normals of a sphere.
fn smooth(radius_m: f64, splits: u32) -> Mesh {
    let test_support::meshes::Mesh { positions, triangles } = meshes::sphere(radius_m, splits);
    let normals = positions.iter().map(|p| p.normalize()).collect();
    Mesh { positions, normals, triangles }
}

/// The piglet without its eyes, which is 0.1 m high at the scale 1.
fn skin(scale: f32) -> Mesh {
    let parts = piglet::scene().parts.into_iter().filter(|part| part.name == "Skin");
    let mut mesh = parts.fold(Mesh::default(), |mesh, part| mesh.and(part.mesh));
    mesh.positions.iter_mut().for_each(|p| *p *= scale);
    mesh
}

/// The same surface, seen from the other side.
fn inverted(mut mesh: Mesh) -> Mesh {
    mesh.normals.iter_mut().for_each(|n| *n = -*n);
    mesh.triangles.iter_mut().for_each(|t| t.swap(1, 2));
    mesh
}

/// A box whose cells are 1 mm wide.
fn sheet() -> Mesh {
    let across = even_cuts(-0.02, 0.02, 40);
    let surface = Lattice { cuts_m: [across.clone(), across, even_cuts(-0.00075, 0.00075, 2)] }.surface();
    let positions = surface.positions_m.iter().map(|p| p.as_vec3()).collect();
    Mesh { positions, normals: Vec::new(), triangles: surface.triangles }
}

/// A square that faces the origin.
fn emitter() -> Part {
    let center = DVec3::new(0.047, 0.01, 0.014);
    Part {
        name: "Lamp",
        mesh: Mesh::lamp(center, DVec3::ZERO, 0.02, 0.02),
        surface: Surface::Emitting { radiance: [2.0; 3] },
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;

    /// All of an object is in view, but for the ear, which is cropped.
    #[test]
    fn cases_are_in_view_and_have_names_of_their_own() {
        let names: BTreeSet<&str> = CASES.iter().map(|case| case.name).collect();
        assert_eq!(names.len(), CASES.len());
        for case in CASES.iter().filter(|case| case.name != "ear") {
            let parts = (case.parts)();
            let object = parts.iter().find(|part| part.name == "Object").expect("every case has an object");
            let edge = (0.5 * case.yfov_degrees).to_radians().tan();
            for eye in [case.eye, 2.0 * case.target - case.eye] {
                let direction = (case.target - eye).normalize();
                for p in &object.mesh.positions {
                    let from_eye = p.as_dvec3() - eye;
                    let depth = from_eye.dot(direction);
                    let beside = (from_eye - depth * direction).length();
                    assert!(beside < depth * edge * 2f64.sqrt(), "{}: {p}", case.name);
                }
            }
        }
    }
}

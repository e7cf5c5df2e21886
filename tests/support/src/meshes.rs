//! Small scenes: meshes and lights written as glTF into a temporary folder and read back by the importer, so that the
//! tests see what users' files become.

use crate::{
    bench::{Bench, data},
    glb::{Asset, OPTIONS},
};
use glam::{DQuat, DVec3, Vec3};
use scene::{ImportOptions, NormalKind, Rays, Scene, SurfacePoint, warp};
use serde_json::{Value, json};
use std::{collections::HashMap, f64::consts::TAU, path::Path};

/// Vertices and triangles, wound counter-clockwise seen from outside, m.
#[derive(Clone, Debug, Default)]
pub struct Mesh {
    pub positions: Vec<Vec3>,
    pub triangles: Vec<[u32; 3]>,
}

/// A mesh and what it is made of.
#[derive(Clone, Debug)]
pub struct Part {
    pub mesh: Mesh,
    /// Marked as the boundary of a volume, else opaque.
    pub translucent: bool,
    /// Diffuse albedo of an opaque one.
    pub color: DVec3,
    /// Radiance, W/(m² sr).
    pub emission: DVec3,
}

impl Part {
    pub fn translucent(mesh: Mesh) -> Part {
        Part { mesh, translucent: true, color: DVec3::ONE, emission: DVec3::ZERO }
    }

    pub fn opaque(mesh: Mesh) -> Part {
        Part { mesh, translucent: false, color: DVec3::ONE, emission: DVec3::ZERO }
    }
}

/// A light of KHR_lights_punctual.
#[derive(Clone, Copy, Debug)]
pub enum Light {
    /// Unit direction towards the light; irradiance on a plane across it, W/m².
    Directional { towards: DVec3, irradiance: DVec3 },
    /// Position, m; intensity, W/sr.
    Point { position: DVec3, intensity: DVec3 },
}

/// A scene with its ray tree.
pub struct World {
    pub scene: Scene,
    pub rays: Rays<'static>,
}

/// Writes the parts and lights to a file and imports it; `environment` is a constant radiance, W/(m² sr).
pub fn world(parts: &[Part], lights: &[Light], environment: DVec3) -> World {
    imported(&asset(parts, lights), 1.0, environment)
}

/// A scene in a file of its own, in metres, under a constant environment.
pub fn scene_file(path: &Path, environment: DVec3) -> World {
    imported_with(path, &OPTIONS, environment)
}

/// A scene of the repository's `data/scenes`, by name.
pub fn repository_scene(name: &str) -> World {
    scene_file(Path::new(&data(&format!("scenes/{name}.glb"))), DVec3::ZERO)
}

/// A glTF asset through a file and the importer.
pub fn imported(asset: &Asset, metres_per_unit: f64, environment: DVec3) -> World {
    let bench = Bench::new();
    let path = bench.write("scene.glb", asset.glb());
    imported_with(&path, &ImportOptions { metres_per_unit, ..OPTIONS }, environment)
}

fn imported_with(path: &Path, options: &ImportOptions, environment: DVec3) -> World {
    let mut scene = Scene::import(path, options).expect("the file is valid glTF");
    scene.environment = environment.into();
    let rays = Rays::new(&scene.mesh);
    World { scene, rays }
}

/// The parts and lights as a file.
pub fn asset(parts: &[Part], lights: &[Light]) -> Asset {
    let mut asset = Asset::new();
    for (k, part) in parts.iter().enumerate() {
        let positions: Vec<[f32; 3]> = part.mesh.positions.iter().map(Vec3::to_array).collect();
        let position = asset.vectors(&positions);
        let indices = asset.long_indices(part.mesh.triangles.as_flattened());
        asset.push("materials", material(k, part));
        asset.mesh(json!({ "attributes": { "POSITION": position }, "indices": indices, "material": k }));
        asset.node(json!({ "mesh": k }));
    }
    lights.iter().for_each(|light| {
        asset.light(light_entry(light), light_node(light));
    });
    asset
}

fn material(index: usize, part: &Part) -> Value {
    let strength = part.emission.max_element().max(1.0);
    let mut extensions = json!({ "KHR_materials_emissive_strength": { "emissiveStrength": strength } });
    if part.translucent {
        extensions["KHR_materials_volume"] = json!({ "thicknessFactor": 1.0 });
    }
    let emissive = (part.emission / strength).to_array();
    let base = json!({ "baseColorFactor": part.color.extend(1.0).to_array() });
    let name = format!("part {index}");
    json!({ "name": name, "pbrMetallicRoughness": base, "emissiveFactor": emissive, "extensions": extensions })
}

fn light_entry(light: &Light) -> Value {
    let (kind, power) = match light {
        Light::Directional { irradiance, .. } => ("directional", irradiance),
        Light::Point { intensity, .. } => ("point", intensity),
    };
    let intensity = power.max_element();
    json!({ "type": kind, "intensity": intensity, "color": (*power / intensity).to_array() })
}

/// Lights shine along their node's −Z.
fn light_node(light: &Light) -> Value {
    match light {
        Light::Directional { towards, .. } => {
            json!({ "rotation": DQuat::from_rotation_arc(DVec3::NEG_Z, -*towards).to_array() })
        }
        Light::Point { position, .. } => json!({ "translation": position.to_array() }),
    }
}

/// A rectangle in the plane of height `z`, facing +Z, with `cells` × `cells` × 2 triangles: from `x[0]` to `x[1]`
/// along X, and `half_width` to either side along Y.
pub fn rectangle(x: [f64; 2], half_width: f64, z: f64, cells: u32) -> Mesh {
    let mut mesh = Mesh::default();
    let share = |k: u32| f64::from(k) / f64::from(cells);
    for j in 0..=cells {
        for i in 0..=cells {
            let at = DVec3::new(x[0] + (x[1] - x[0]) * share(i), half_width * (2.0 * share(j) - 1.0), z);
            mesh.positions.push(at.as_vec3());
        }
    }
    for j in 0..cells {
        for i in 0..cells {
            let a = j * (cells + 1) + i;
            let (b, c, d) = (a + 1, a + cells + 2, a + cells + 1);
            mesh.triangles.extend([[a, b, c], [a, c, d]]);
        }
    }
    mesh
}

/// A square about the origin in the plane of height `z`, facing +Z.
pub fn quad(half_width: f64, z: f64, cells: u32) -> Mesh {
    rectangle([-half_width, half_width], half_width, z, cells)
}

/// A disc about the origin facing +Z, whose triangles shrink towards the center: the uniform choice among them puts
/// the same number of samples into every octave of the distance.
pub fn graded_disc(inner: f64, outer: f64, rings: u32) -> Mesh {
    const SECTORS: u32 = 24;
    let mut mesh = Mesh { positions: vec![Vec3::ZERO], triangles: Vec::new() };
    for ring in 0..=rings {
        let radius = inner * (outer / inner).powf(f64::from(ring) / f64::from(rings));
        for sector in 0..SECTORS {
            let (sine, cosine) = (TAU * f64::from(sector) / f64::from(SECTORS)).sin_cos();
            mesh.positions.push((radius * DVec3::new(cosine, sine, 0.0)).as_vec3());
        }
    }
    let index = |ring: u32, sector: u32| 1 + ring * SECTORS + sector % SECTORS;
    for sector in 0..SECTORS {
        mesh.triangles.push([0, index(0, sector), index(0, sector + 1)]);
        for ring in 0..rings {
            let (a, b) = (index(ring, sector), index(ring, sector + 1));
            let (c, d) = (index(ring + 1, sector + 1), index(ring + 1, sector));
            mesh.triangles.extend([[a, d, c], [a, c, b]]);
        }
    }
    mesh
}

/// A closed box about the origin; each side has `cells` × `cells` × 2 triangles, which narrow towards one edge so
/// that areas are uneven.
pub fn slab(half_size: DVec3, cells: u32) -> Mesh {
    let square = quad(1.0, 1.0, cells);
    let mut mesh = Mesh::default();
    for axis in 0..3 {
        for sign in [1.0, -1.0] {
            let first = mesh.positions.len() as u32;
            for p in &square.positions {
                let [u, v] = [f64::from(p.x), f64::from(p.y)].map(|t| 0.5 * (t + 1.0) * (t + 1.0) - 1.0);
                let mut at = DVec3::ZERO;
                at[axis] = sign;
                at[(axis + 1) % 3] = u;
                at[(axis + 2) % 3] = sign * v;
                mesh.positions.push((at * half_size).as_vec3());
            }
            mesh.triangles.extend(square.triangles.iter().map(|t| t.map(|i| i + first)));
        }
    }
    mesh
}

/// A sphere about the origin: an octahedron whose triangles are split in four, that many times.
pub fn sphere(radius: f64, splits: u32) -> Mesh {
    let axes = [Vec3::X, Vec3::Y, Vec3::Z, Vec3::NEG_X, Vec3::NEG_Y, Vec3::NEG_Z];
    let mut mesh = Mesh { positions: axes.to_vec(), triangles: Vec::new() };
    for [x, y, z] in [[0, 1, 2], [1, 3, 2], [3, 4, 2], [4, 0, 2]] {
        mesh.triangles.extend([[x, y, z], [y, x, z + 3]]);
    }
    for _ in 0..splits {
        let mut middles = HashMap::new();
        let triangles = std::mem::take(&mut mesh.triangles);
        for [a, b, c] in triangles {
            let mut middle = |i: u32, j: u32| {
                *middles.entry((i.min(j), i.max(j))).or_insert_with(|| {
                    let sum = mesh.positions[i as usize] + mesh.positions[j as usize];
                    mesh.positions.push(sum.normalize());
                    mesh.positions.len() as u32 - 1
                })
            };
            let (ab, bc, ca) = (middle(a, b), middle(b, c), middle(c, a));
            mesh.triangles.extend([[a, ab, ca], [b, bc, ab], [c, ca, bc], [ab, bc, ca]]);
        }
    }
    mesh.positions.iter_mut().for_each(|p| *p *= radius as f32);
    mesh
}

/// A uniform point of a mesh by three uniform numbers, and the mesh's area, m².
pub fn uniform_point(mesh: &scene::Mesh, [choice, u, v]: [f64; 3]) -> (SurfacePoint, f64) {
    let areas: Vec<f64> = (0..mesh.triangles.len()).map(|k| mesh.area(k)).collect();
    let total: f64 = areas.iter().sum();
    let mut rest = choice * total;
    let chosen = areas.iter().position(|area| {
        rest -= area;
        rest < 0.0
    });
    (mesh.point(chosen.unwrap_or(0) as u32, warp::triangle([u, v]), NormalKind::Geometric), total)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The volume that a closed surface encloses, by the divergence theorem: positive if its normals point outward.
    fn volume(mesh: &Mesh) -> f64 {
        let corner = |i: u32| mesh.positions[i as usize].as_dvec3();
        mesh.triangles.iter().map(|[a, b, c]| corner(*a).dot(corner(*b).cross(corner(*c))) / 6.0).sum()
    }

    #[test]
    fn closed_meshes_face_outward() {
        assert!((volume(&slab(DVec3::new(1.0, 2.0, 3.0), 4)) - 48.0).abs() < 1e-5);
        let ball = volume(&sphere(2.0, 4));
        assert!((ball / (32.0 / 3.0 * std::f64::consts::PI) - 1.0).abs() < 0.01, "{ball}");
    }

    #[test]
    fn flat_meshes_face_up_and_have_their_area() {
        for (mesh, area) in [(quad(2.0, 0.0, 3), 16.0), (graded_disc(0.1, 1.0, 5), 12.0 * (TAU / 24.0).sin())] {
            let world = world(&[Part::translucent(mesh)], &[], DVec3::ONE);
            let total: f64 = (0..world.scene.mesh.triangles.len()).map(|k| world.scene.mesh.area(k)).sum();
            assert!((total - area).abs() < 1e-5, "{total}");
            let point = world.scene.mesh.point(0, [0.3, 0.3, 0.4], scene::NormalKind::Geometric);
            assert!((point.normal - DVec3::Z).length() < 1e-6);
        }
    }
}

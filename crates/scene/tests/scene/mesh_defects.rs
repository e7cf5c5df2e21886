//! Faults of meshes that are planted and counted.

use crate::meshes::{bumpy, cube, mesh, sphere};
use scene::{DVec3, Mesh, MeshDefects, Triangle};
use serde_json::json;
use test_support::glb::tetrahedron;

fn defects(mesh: &Mesh) -> MeshDefects {
    mesh.defects(|_| true)
}

/// Both meshes in one, the second moved.
fn with(one: &Mesh, other: &Mesh, offset: DVec3) -> Mesh {
    let mut both = one.clone();
    let first = both.positions.len() as u32;
    both.positions.extend(other.positions.iter().map(|p| (p.as_dvec3() + offset).as_vec3()));
    both.normals.extend(&other.normals);
    both.triangles.extend(other.triangles.iter().map(|t| Triangle { vertices: t.vertices.map(|i| i + first), ..*t }));
    both
}

fn turned(mut mesh: Mesh) -> Mesh {
    mesh.triangles.iter_mut().for_each(|t| t.vertices.swap(1, 2));
    mesh
}

/// Every triangle with vertices of its own, as a mesh with hard edges has.
fn split(mesh: &Mesh) -> Mesh {
    let positions = mesh.triangles.iter().flat_map(|t| t.vertices.map(|i| mesh.positions[i as usize].as_dvec3()));
    let triangles: Vec<[u32; 3]> = (0..mesh.triangles.len() as u32).map(|k| [3 * k, 3 * k + 1, 3 * k + 2]).collect();
    crate::meshes::mesh(&positions.collect::<Vec<_>>(), &triangles)
}

#[test]
fn closed_meshes_have_no_faults() {
    for mesh in [cube(1.0), sphere(3, 2.0), bumpy(4, 0.01), split(&cube(1.0)), split(&sphere(3, 2.0))] {
        assert_eq!(defects(&mesh), MeshDefects::default());
    }
    // Two bodies that touch along an edge, and zeros of either sign.
    let neighbors = with(&cube(1.0), &cube(1.0), DVec3::new(2.0, 2.0, 0.0));
    assert_eq!(defects(&neighbors), MeshDefects::default());
    let mut signs = split(&with(&cube(1.0), &cube(0.0), DVec3::ZERO));
    signs.positions.iter_mut().step_by(2).for_each(|p| *p += -0.0);
    signs.triangles.truncate(12);
    assert!(defects(&signs).is_good());
}

#[test]
fn each_fault_is_counted() {
    let mut holed = sphere(2, 1.0);
    holed.triangles.swap_remove(7);
    assert_eq!(defects(&holed), MeshDefects { open_edges: 3, ..MeshDefects::default() });
    let mut flipped = sphere(2, 1.0);
    flipped.triangles[7].vertices.swap(0, 1);
    assert_eq!(defects(&flipped), MeshDefects { flipped_edges: 3, ..MeshDefects::default() });
    for again in [[0, 1, 2], [1, 2, 0], [1, 0, 2]] {
        let mut twice = sphere(2, 1.0);
        let t = twice.triangles[7];
        twice.triangles.push(Triangle { vertices: again.map(|k: usize| t.vertices[k]), ..t });
        assert_eq!(defects(&twice), MeshDefects { duplicate_triangles: 1, ..MeshDefects::default() }, "{again:?}");
    }
    assert_eq!(defects(&turned(cube(1.0))), MeshDefects { inward_parts: 1, ..MeshDefects::default() });
    let sheet = mesh(&[DVec3::ZERO, DVec3::X, DVec3::Y], &[[0, 1, 2]]);
    assert_eq!(defects(&sheet), MeshDefects { open_edges: 3, ..MeshDefects::default() });
}

/// Seen to catch: cavities taken for bodies that are inside out.
#[test]
fn cavities_are_wound_inwards() {
    let hollow = with(&cube(1.0), &turned(sphere(2, 0.5)), DVec3::ZERO);
    assert_eq!(defects(&hollow), MeshDefects::default());
    let beside = with(&cube(1.0), &turned(sphere(2, 0.5)), DVec3::new(3.0, 0.0, 0.0));
    assert_eq!(defects(&beside).inward_parts, 1);
    assert_eq!(defects(&turned(with(&cube(1.0), &sphere(2, 0.5), DVec3::ZERO))).inward_parts, 2);
}

#[test]
fn only_the_materials_asked_for_count_and_count_together() {
    let mut two = cube(1.0);
    two.triangles.iter_mut().skip(6).for_each(|t| t.material = 1);
    assert!(defects(&two).is_good(), "a body of two materials");
    assert!(two.defects(|m| m == 0).open_edges > 0);
    assert!(two.defects(|_| false).is_good());
}

/// As the programs see it: through the file, with what was left out.
#[test]
fn faults_of_a_file() {
    let mut asset = tetrahedron();
    let indices = asset.indices(&[0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3, 1, 2, 3, 0, 0, 1]);
    asset.set("/meshes/0/primitives/0/indices", json!(indices));
    let scene = asset.import().expect("a good file");
    assert_eq!(scene.defects(|m| m == 0).to_string(), "1 duplicate triangles, 1 degenerate triangles");
    assert!(scene.defects(|m| m == 1).is_good(), "what is left out of others does not count");
}

/// A tenth of a second on a machine at rest.
#[test]
fn a_large_mesh_takes_a_moment() {
    let large = bumpy(7, 1.0);
    assert_eq!(large.triangles.len(), 131_072);
    let start = std::time::Instant::now();
    assert!(defects(&large).is_good());
    let seconds = start.elapsed().as_secs_f64();
    println!("{} triangles: {seconds:.3} s", large.triangles.len());
    assert!(seconds < 2.0, "{seconds} s");
}

//! The frames of normal maps: by the tangents of the file or, where it has none, by MikkTSpace (Mikkelsen 2008), which
//! programs that make normal maps use.

use crate::{
    bumps::{Bumps, Frame, NormalMap},
    material::Material,
    mesh::{Mesh, unit},
};
use bevy_mikktspace::{Geometry, TangentSpace, generate_tangents};
use glam::{Vec3, Vec4};
use std::collections::BTreeMap;

/// Most triangles around a point whose tangents are made: the library calls itself once for each.
const MAX_AROUND: u32 = 1 << 10;

/// The normal maps of a mesh in the world, if it has any.
pub(super) fn bumps(
    mesh: &Mesh,
    materials: &[Material],
    coordinates: Vec<[f32; 2]>,
    tangents: &[[f32; 4]],
    warnings: &mut Vec<String>,
) -> Option<Bumps> {
    let maps: Vec<Option<NormalMap>> = materials.iter().map(|m| m.normal_map.clone()).collect();
    let has_map = |k: usize| maps[usize::from(mesh.triangles[k].material)].is_some();
    let mapped: Vec<u32> = (0..mesh.triangles.len()).filter(|k| has_map(*k)).map(|k| k as u32).collect();
    if mapped.is_empty() {
        return None;
    }
    let mut frames = vec![[Frame::default(); 3]; mesh.triangles.len()];
    let mut without = Vec::new();
    for k in mapped {
        let vertices = mesh.triangles[k as usize].vertices;
        let own = vertices.map(|i| tangents.get(i as usize).copied().map_or(Vec4::ZERO, Vec4::from_array));
        // A file has tangents for all vertices of a primitive or for none.
        match own.iter().all(|t| *t == Vec4::ZERO) {
            true => without.push(k),
            false => frames[k as usize] = own.map(|t| Frame { tangent: t.truncate(), sign: t.w }),
        }
    }
    let finite = |k: &u32| {
        let of = |i: u32| coordinates.get(i as usize).is_some_and(|uv| uv.iter().all(|x| x.is_finite()));
        mesh.triangles[*k as usize].vertices.iter().all(|i| of(*i))
    };
    without.retain(finite);
    let count = without.len();
    drop_crowded(mesh, &mut without);
    if without.len() < count {
        let left_out = count - without.len();
        warnings.push(format!(
            "{left_out} triangles share points with over {MAX_AROUND} others and stay without normal map"
        ));
    }
    let mut mesh_without = Untangented { mesh, coordinates: &coordinates, triangles: &without, frames: &mut frames };
    // The library has no error to return.
    if generate_tangents(&mut mesh_without).is_err() {
        warnings.push("no tangents can be made: normal maps are left out".into());
    }
    Some(Bumps { maps, coordinates, frames })
}

/// Leaves out triangles around points that too many of them share.
fn drop_crowded(mesh: &Mesh, triangles: &mut Vec<u32>) {
    let corners =
        |k: u32| mesh.triangles[k as usize].vertices.map(|i| mesh.positions[i as usize].to_array().map(f32::to_bits));
    let mut around: BTreeMap<[u32; 3], u32> = BTreeMap::new();
    triangles.iter().flat_map(|k| corners(*k)).for_each(|corner| *around.entry(corner).or_default() += 1);
    triangles.retain(|k| corners(*k).iter().all(|corner| around[corner] <= MAX_AROUND));
}

/// Triangles without tangents.
struct Untangented<'a> {
    mesh: &'a Mesh,
    coordinates: &'a [[f32; 2]],
    triangles: &'a [u32],
    frames: &'a mut [[Frame; 3]],
}

impl Untangented<'_> {
    fn vertex(&self, face: usize, corner: usize) -> usize {
        self.mesh.triangles[self.triangles[face] as usize].vertices[corner] as usize
    }
}

impl Geometry for Untangented<'_> {
    fn num_faces(&self) -> usize {
        self.triangles.len()
    }

    fn num_vertices_of_face(&self, _: usize) -> usize {
        3
    }

    fn position(&self, face: usize, corner: usize) -> [f32; 3] {
        self.mesh.positions[self.vertex(face, corner)].to_array()
    }

    fn normal(&self, face: usize, corner: usize) -> [f32; 3] {
        let own = self.mesh.normals[self.vertex(face, corner)];
        if own != Vec3::ZERO {
            return own.to_array();
        }
        let [a, b, c] = self.mesh.corners(self.triangles[face] as usize);
        unit((b - a).cross(c - a)).as_vec3().to_array()
    }

    fn tex_coord(&self, face: usize, corner: usize) -> [f32; 2] {
        // glTF has `v` downwards, and MikkTSpace upwards.
        let [u, v] = self.coordinates[self.vertex(face, corner)];
        [u, 1.0 - v]
    }

    fn set_tangent(&mut self, space: Option<TangentSpace>, face: usize, corner: usize) {
        let Some(space) = space else { return };
        let [x, y, z, sign] = space.tangent_encoded();
        let tangent = Vec3::new(x, y, z);
        if tangent.is_finite() {
            self.frames[self.triangles[face] as usize][corner] = Frame { tangent, sign };
        }
    }
}

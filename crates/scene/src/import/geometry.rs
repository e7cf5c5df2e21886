//! Joins all primitives to one mesh in float32, relative to its center.

use super::{
    accessor::CheckedAccessor,
    fault::{Fault, Refusal, Result},
    instancing::Copies,
    nodes::SceneNode,
    primitive::{CheckedMesh, CheckedPrimitive},
    skin::Influences,
};
use crate::mesh::{Mesh, Triangle, area, bounds};
use glam::{DMat3, DMat4, DVec3, Vec3};
use memmap2::MmapMut;
use std::collections::BTreeMap;

/// Limits with all instances. They are checked before memory is allocated, because a small file can have many instances
/// of a large mesh.
const MAX_TRIANGLES: u64 = 1 << 26;
const MAX_VERTICES: u64 = 1 << 27;
const MAX_PRIMITIVES: u64 = 1 << 22;
/// Morph targets and sets of joints of all vertices: each is a few nanoseconds of work and takes no memory.
const MAX_CHANGES: u64 = 1 << 29;

/// Bytes of a triangle with its vertices, and its part of the ray tree while that is built. 360 were measured.
const BYTES_PER_TRIANGLE: usize = 512;

/// Longest diagonal, m, with which squares of distances are finite in float32.
const MAX_DIAGONAL: f64 = 1e18;

/// A mesh on a node.
pub(super) struct Instance<'a> {
    pub parts: &'a CheckedMesh<'a>,
    pub placed: &'a SceneNode<'a>,
    /// The copies of the node's mesh, if it has any.
    pub copies: Option<Copies<'a>>,
    /// Weights of the morph targets.
    pub weights: &'a [f32],
    /// Matrices of the joints, from the mesh to the world. A mesh with joints is where they are, not where its node is.
    pub joints: Option<&'a [DMat4]>,
}

impl Instance<'_> {
    fn count(&self) -> usize {
        let copies = self.copies.as_ref().filter(|_| self.joints.is_none());
        copies.map_or(1, |copies| copies.count)
    }

    /// From the mesh to the world.
    fn transform(&self, copy: usize) -> Result<DMat4> {
        let Some(copies) = &self.copies else { return Ok(self.placed.transform) };
        let transform = copies.transform(copy).map_err(|e| format!("node `{}`: {e}", self.placed.name))?;
        Ok(self.placed.transform * transform)
    }

    /// Changes to each vertex before it is placed.
    fn changes(&self) -> u64 {
        let sets = if self.joints.is_some() { self.parts.sets } else { 0 };
        (sets + self.weights.iter().filter(|weight| **weight != 0.0).count()) as u64
    }
}

pub(super) struct Geometry {
    pub mesh: Mesh,
    pub origin: DVec3,
    /// Texture coordinates of normal maps; vertices at the end may have none.
    pub normal_coordinates: Vec<[f32; 2]>,
    /// Tangents of the file with the signs of bitangents, in the world; 0 where it has none.
    pub tangents: Vec<[f32; 4]>,
    /// Number of triangles without area, which are left out, by material.
    pub degenerate: BTreeMap<u16, u64>,
    /// Number of those that have an area before their positions are rounded to float32.
    pub rounded: BTreeMap<u16, u64>,
}

/// Joins all instances, in their order.
pub(super) fn join(instances: &[Instance]) -> Result<Geometry, Refusal> {
    let mut builder = Builder::default();
    builder.reserve(instances)?;
    for instance in instances {
        for copy in 0..instance.count() {
            let transform = instance.transform(copy)?;
            for part in &instance.parts.list {
                builder.add(part, instance, transform)?;
            }
        }
    }
    builder.finish()
}

#[derive(Default)]
struct Builder {
    /// World positions, m, in float64 until the center is known.
    positions: Vec<DVec3>,
    normals: Vec<Vec3>,
    triangles: Vec<Triangle>,
    /// Texture coordinates; vertices at the end may have none.
    coordinates: Vec<[f32; 2]>,
    /// The same of emission.
    emission_coordinates: Vec<[f32; 2]>,
    /// The same of metallic and roughness.
    gloss_coordinates: Vec<[f32; 2]>,
    /// The same of the shares and colors of scattered light.
    scatter_coordinates: [Vec<[f32; 2]>; 2],
    /// The same of normal maps.
    normal_coordinates: Vec<[f32; 2]>,
    /// Tangents of the file; vertices at the end may have none.
    tangents: Vec<[f32; 4]>,
    /// Vertex colors; vertices at the end may have none.
    colors: Vec<[f32; 4]>,
}

impl Builder {
    /// Counts all vertices and triangles, checks the limits, and reserves the memory.
    fn reserve(&mut self, instances: &[Instance]) -> Result<()> {
        let total = |of: fn(&Instance) -> u64| {
            let all = instances.iter().map(|i| of(i).saturating_mul(i.count() as u64));
            all.fold(0, u64::saturating_add)
        };
        let counts = [
            (total(|i| i.parts.triangles), MAX_TRIANGLES, "triangles"),
            (total(|i| i.parts.vertices), MAX_VERTICES, "vertices"),
            (total(|i| i.parts.list.len() as u64), MAX_PRIMITIVES, "primitives"),
            (total(|i| i.parts.vertices.saturating_mul(i.changes())), MAX_CHANGES, "joints and morphs of vertices"),
        ];
        for (count, limit, what) in counts {
            if count > limit {
                let way_out = "export fewer instances, or a coarser mesh";
                return Err(format!(
                    "nodes: {count} {what} with all instances, at most {limit} are supported; {way_out}"
                ));
            }
        }
        let [triangles, vertices, ..] = counts.map(|(count, ..)| count as usize);
        // The system is asked first, because an allocator may end the process instead of returning an error.
        let room = MmapMut::map_anon((triangles * BYTES_PER_TRIANGLE).max(1)).is_ok()
            && self.triangles.try_reserve_exact(triangles).is_ok()
            && self.positions.try_reserve_exact(vertices).is_ok()
            && self.normals.try_reserve_exact(vertices).is_ok();
        let scarce = || format!("not enough memory for {triangles} triangles with {vertices} vertices; export fewer");
        room.then_some(()).ok_or_else(scarce)
    }

    /// Adds a primitive of an instance whose transform is this.
    fn add(&mut self, part: &CheckedPrimitive, instance: &Instance, transform: DMat4) -> Result<()> {
        let vectors =
            |column: &CheckedAccessor| Ok::<_, Fault>(column.read_reals()?.into_iter().map(Vec3::from_array).collect());
        let mut positions: Vec<Vec3> = vectors(&part.positions)?;
        let mut normals = match &part.normals {
            Some(normals) => vectors(normals)?,
            None => vec![Vec3::ZERO; positions.len()],
        };
        // Without normals there are none to change.
        let changed = if part.normals.is_some() { &mut normals[..] } else { &mut [] };
        part.morph(instance.weights, &mut positions, changed)?;
        let indices = match &part.indices {
            Some(indices) => indices.read_indices(positions.len())?,
            None => (0..positions.len() as u32).collect(),
        };
        // The limits keep it in range.
        let first = self.positions.len() as u32;
        self.add_colors(part)?;
        let name = &instance.placed.name;
        let tangents = part.tangents.as_ref().map_or(Ok(Vec::new()), CheckedAccessor::read_reals)?;
        if !tangents.is_empty() {
            self.tangents.resize(self.positions.len(), [0.0; 4]);
        }
        let vertices = Vertices { positions: &positions, normals: &normals, tangents: &tangents };
        let mirrored = match instance.joints {
            Some(joints) if !part.influences.is_empty() => {
                Mirrored::Each(self.add_skinned(&vertices, (&Influences::read(&part.influences)?, joints), name)?)
            }
            _ => Mirrored::All(self.add_vertices(&vertices, transform, name)?),
        };
        for mut vertices in part.triangles(&indices) {
            if mirrored.at(vertices[0]) {
                vertices.swap(1, 2);
            }
            self.triangles.push(Triangle { vertices: vertices.map(|i| i + first), material: part.material });
        }
        Ok(())
    }

    /// Adds texture coordinates and colors of the next vertices.
    fn add_colors(&mut self, part: &CheckedPrimitive) -> Result<()> {
        let [share, color] = &mut self.scatter_coordinates;
        let of_textures = [
            (&part.scatter_coordinates[0], share),
            (&part.scatter_coordinates[1], color),
            (&part.coordinates, &mut self.coordinates),
            (&part.emission_coordinates, &mut self.emission_coordinates),
            (&part.gloss_coordinates, &mut self.gloss_coordinates),
            (&part.normal_coordinates, &mut self.normal_coordinates),
        ];
        for (part, all) in of_textures {
            if let Some((column, transform)) = part {
                all.resize(self.positions.len(), [0.0; 2]);
                all.extend(column.read_reals()?.into_iter().map(|uv| transform.apply(uv)));
            }
        }
        if let Some(column) = &part.colors {
            self.colors.resize(self.positions.len(), [1.0; 4]);
            // glTF says that colors are clamped.
            self.colors.extend(column.read_reals::<4>()?.into_iter().map(|c| c.map(|x| x.clamp(0.0, 1.0))));
        }
        Ok(())
    }

    /// Adds vertices in world space. True if the transform is a reflection, which reverses the winding.
    fn add_vertices(&mut self, vertices: &Vertices, transform: DMat4, name: &str) -> Result<bool> {
        let (normal_matrix, mirrored) = of_normals(transform);
        for p in vertices.positions {
            self.positions.push(finite(transform.transform_point3(p.as_dvec3()), name)?);
        }
        self.normals.extend(vertices.normals.iter().map(|n| turned(normal_matrix, *n)));
        self.tangents.extend(vertices.tangents.iter().map(|t| placed_tangent(transform, mirrored, *t)));
        Ok(mirrored)
    }

    /// Adds vertices, each of which follows its joints. Tells of each whether it is mirrored.
    fn add_skinned(
        &mut self,
        vertices: &Vertices,
        (influences, joints): (&Influences, &[DMat4]),
        name: &str,
    ) -> Result<Vec<bool>> {
        let mut all_mirrored = Vec::with_capacity(vertices.positions.len());
        for (vertex, (p, n)) in vertices.positions.iter().zip(vertices.normals).enumerate() {
            let transform = influences.matrix(vertex, joints).map_err(|e| format!("node `{name}`: {e}"))?;
            let (normal_matrix, mirrored) = of_normals(transform);
            self.positions.push(finite(transform.transform_point3(p.as_dvec3()), name)?);
            self.normals.push(turned(normal_matrix, *n));
            self.tangents.extend(vertices.tangents.get(vertex).map(|t| placed_tangent(transform, mirrored, *t)));
            all_mirrored.push(mirrored);
        }
        Ok(all_mirrored)
    }

    /// Center of the box around all triangles.
    fn center(&self) -> Result<DVec3, Refusal> {
        let corners = self.triangles.iter().flat_map(|t| t.vertices.map(|i| self.positions[i as usize]));
        let (low, high) = bounds(corners);
        let size = high - low;
        if size.length() > MAX_DIAGONAL {
            return Err(Refusal::TooLarge);
        }
        let center = low + size * 0.5;
        // Beyond this distance, float64 resolves less than the float32 of relative positions.
        if size != DVec3::ZERO && center.length() * f64::EPSILON > size.length() * f64::from(f32::EPSILON) {
            let way_out = "move it to the origin and export again";
            return Err(format!("the mesh is too far from the origin for its size, at {center}; {way_out}").into());
        }
        Ok(center)
    }

    /// Positions relative to an origin, m, in float32.
    fn relative_to(&self, origin: DVec3) -> Result<Vec<Vec3>, Refusal> {
        let positions: Vec<Vec3> = self.positions.iter().map(|p| (*p - origin).as_vec3()).collect();
        if !positions.iter().all(|p| p.is_finite()) {
            return Err(Refusal::TooLarge);
        }
        Ok(positions)
    }

    /// Drops triangles without area, and makes positions relative to the center of the rest. Triangles that have no
    /// area in float32 relative to their own center are dropped first: a needle to a stray vertex far away would move
    /// the center of all and cost the others their precision.
    fn finish(mut self) -> Result<Geometry, Refusal> {
        if self.triangles.is_empty() {
            return Err(Refusal::Invalid("no triangles: nothing to light or to see".into()));
        }
        let count = self.triangles.len();
        let (mut degenerate, mut rounded) = (BTreeMap::new(), BTreeMap::new());
        let has_area = |t: &Triangle| area_alone(t.vertices.map(|i| self.positions[i as usize])) > 0.0;
        retain(&mut self.triangles, &mut degenerate, has_area);
        // Dropping a triangle can move the center, so this repeats until none is dropped. A dropped triangle is 2^24
        // times smaller than the mesh, so that there are few iterations.
        let (origin, positions) = loop {
            if self.triangles.is_empty() {
                return Err(format!("all {count} triangles have no area (scale 0?)").into());
            }
            let origin = self.center()?;
            let (positions, before) = (self.relative_to(origin)?, self.triangles.len());
            let has_area = |t: &Triangle| area(t.vertices.map(|i| positions[i as usize].as_dvec3())) > 0.0;
            retain(&mut self.triangles, &mut rounded, has_area);
            if self.triangles.len() == before {
                break (origin, positions);
            }
        };
        for (material, count) in &rounded {
            *degenerate.entry(*material).or_default() += count;
        }
        let Builder { normals, triangles, coordinates, emission_coordinates, gloss_coordinates, colors, .. } = self;
        let (normal_coordinates, tangents) = (self.normal_coordinates, self.tangents);
        let mesh = Mesh {
            positions,
            normals,
            triangles,
            coordinates,
            emission_coordinates,
            gloss_coordinates,
            scatter_coordinates: self.scatter_coordinates,
            colors,
            bumps: None,
        };
        Ok(Geometry { mesh, origin, normal_coordinates, tangents, degenerate, rounded })
    }
}

/// The vertices of a primitive, not placed yet; there are no tangents, or as many as positions.
struct Vertices<'a> {
    positions: &'a [Vec3],
    normals: &'a [Vec3],
    tangents: &'a [[f32; 4]],
}

/// Whether the transform of a vertex is a reflection.
enum Mirrored {
    All(bool),
    Each(Vec<bool>),
}

impl Mirrored {
    fn at(&self, vertex: u32) -> bool {
        match self {
            Mirrored::All(mirrored) => *mirrored,
            Mirrored::Each(list) => list[vertex as usize],
        }
    }
}

/// The matrix that turns normals with a transform, and whether the transform is a reflection.
fn of_normals(transform: DMat4) -> (DMat3, bool) {
    let linear = DMat3::from_mat4(transform);
    let determinant = linear.determinant();
    let matrix = if determinant == 0.0 { DMat3::ZERO } else { linear.inverse().transpose() };
    (matrix, determinant < 0.0)
}

/// A normal in the world.
fn turned(matrix: DMat3, normal: Vec3) -> Vec3 {
    (matrix * normal.as_dvec3()).normalize_or_zero().as_vec3()
}

/// A tangent in the world. A reflection turns the cross product of normal and tangent around.
fn placed_tangent(transform: DMat4, mirrored: bool, [x, y, z, sign]: [f32; 4]) -> [f32; 4] {
    let tangent = transform.transform_vector3(Vec3::new(x, y, z).as_dvec3()).normalize_or_zero().as_vec3();
    let sign = if (sign < 0.0) != mirrored { -1.0 } else { 1.0 };
    tangent.extend(sign).to_array()
}

/// A position in the world.
fn finite(position: DVec3, name: &str) -> Result<DVec3> {
    if position.is_finite() {
        Ok(position)
    } else {
        Err(format!("node `{name}`: a vertex is not finite in world space"))
    }
}

/// Drops the triangles that `keep` refuses, and counts them by material.
pub(super) fn retain(
    triangles: &mut Vec<Triangle>,
    dropped: &mut BTreeMap<u16, u64>,
    mut keep: impl FnMut(&Triangle) -> bool,
) {
    triangles.retain(|triangle| {
        let keep = keep(triangle);
        if !keep {
            *dropped.entry(triangle.material).or_default() += 1;
        }
        keep
    });
}

/// Area of a triangle in a scene of its own: the smaller of those in float64 and, relative to its center, in float32.
fn area_alone(corners: [DVec3; 3]) -> f64 {
    let [a, b, c] = corners;
    let (low, high) = (a.min(b).min(c), a.max(b).max(c));
    let center = low + (high - low) * 0.5;
    area(corners).min(area(corners.map(|p| (p - center).as_vec3().as_dvec3())))
}

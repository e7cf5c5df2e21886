//! Joins all primitives to one mesh in float32, relative to its center.

use super::{
    accessor::CheckedAccessor,
    fault::{Fault, Refusal, Result},
    nodes::SceneNode,
    primitive::{CheckedMesh, CheckedPrimitive},
};
use crate::mesh::{Mesh, Triangle, area, bounds};
use glam::{DMat3, DVec3, Vec3};
use memmap2::MmapMut;
use std::collections::BTreeMap;

/// Limits with all instances. They are checked before memory is allocated, because a small file can have many instances
/// of a large mesh.
const MAX_TRIANGLES: u64 = 1 << 26;
const MAX_VERTICES: u64 = 1 << 27;
const MAX_PRIMITIVES: u64 = 1 << 22;

/// Bytes of a triangle with its vertices, and its part of the ray tree while that is built. 360 were measured.
const BYTES_PER_TRIANGLE: usize = 512;

/// Longest diagonal, m, with which squares of distances are finite in float32.
const MAX_DIAGONAL: f64 = 1e18;

/// A mesh on a node.
pub(super) struct Instance<'a> {
    pub parts: &'a CheckedMesh<'a>,
    pub placed: &'a SceneNode<'a>,
}

pub(super) struct Geometry {
    pub mesh: Mesh,
    pub origin: DVec3,
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
        for part in &instance.parts.list {
            builder.add(part, instance.placed)?;
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
    /// Vertex colors; vertices at the end may have none.
    colors: Vec<[f32; 4]>,
}

impl Builder {
    /// Counts all vertices and triangles, checks the limits, and reserves the memory.
    fn reserve(&mut self, instances: &[Instance]) -> Result<()> {
        let total = |of: fn(&CheckedMesh) -> u64| instances.iter().map(|i| of(i.parts)).fold(0, u64::saturating_add);
        let counts = [
            (total(|p| p.triangles), MAX_TRIANGLES, "triangles"),
            (total(|p| p.vertices), MAX_VERTICES, "vertices"),
            (total(|p| p.list.len() as u64), MAX_PRIMITIVES, "primitives"),
        ];
        for (count, limit, what) in counts {
            if count > limit {
                let way_out = "export fewer instances, or a coarser mesh";
                return Err(format!(
                    "nodes: {count} {what} with all instances, at most {limit} are supported; {way_out}"
                ));
            }
        }
        let [triangles, vertices, _] = counts.map(|(count, ..)| count as usize);
        // The system is asked first, because an allocator may end the process instead of returning an error.
        let room = MmapMut::map_anon((triangles * BYTES_PER_TRIANGLE).max(1)).is_ok()
            && self.triangles.try_reserve_exact(triangles).is_ok()
            && self.positions.try_reserve_exact(vertices).is_ok()
            && self.normals.try_reserve_exact(vertices).is_ok();
        let scarce = || format!("not enough memory for {triangles} triangles with {vertices} vertices; export fewer");
        room.then_some(()).ok_or_else(scarce)
    }

    /// Adds a primitive on a node.
    fn add(&mut self, part: &CheckedPrimitive, placed: &SceneNode) -> Result<()> {
        let vectors =
            |column: &CheckedAccessor| Ok::<_, Fault>(column.read_reals()?.into_iter().map(Vec3::from_array).collect());
        let positions: Vec<Vec3> = vectors(&part.positions)?;
        let normals = match &part.normals {
            Some(normals) => vectors(normals)?,
            None => vec![Vec3::ZERO; positions.len()],
        };
        let indices = match &part.indices {
            Some(indices) => indices.read_indices(positions.len())?,
            None => (0..positions.len() as u32).collect(),
        };
        // The limits keep it in range.
        let first = self.positions.len() as u32;
        self.add_colors(part)?;
        let mirrored = self.add_vertices(&positions, &normals, placed)?;
        for mut vertices in part.triangles(&indices) {
            if mirrored {
                vertices.swap(1, 2);
            }
            self.triangles.push(Triangle { vertices: vertices.map(|i| i + first), material: part.material });
        }
        Ok(())
    }

    /// Adds texture coordinates and colors of the next vertices.
    fn add_colors(&mut self, part: &CheckedPrimitive) -> Result<()> {
        let of_textures =
            [(&part.coordinates, &mut self.coordinates), (&part.emission_coordinates, &mut self.emission_coordinates)];
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
    fn add_vertices(&mut self, positions: &[Vec3], normals: &[Vec3], placed: &SceneNode) -> Result<bool> {
        let linear = DMat3::from_mat4(placed.transform);
        let determinant = linear.determinant();
        let normal_matrix = if determinant == 0.0 { DMat3::ZERO } else { linear.inverse().transpose() };
        for p in positions {
            let world = placed.transform.transform_point3(p.as_dvec3());
            if !world.is_finite() {
                return Err(format!("node `{}`: a vertex is not finite in world space", placed.name));
            }
            self.positions.push(world);
        }
        let in_world = |n: &Vec3| (normal_matrix * n.as_dvec3()).normalize_or_zero().as_vec3();
        self.normals.extend(normals.iter().map(in_world));
        Ok(determinant < 0.0)
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
        let Builder { normals, triangles, coordinates, emission_coordinates, colors, .. } = self;
        let mesh = Mesh { positions, normals, triangles, coordinates, emission_coordinates, colors };
        Ok(Geometry { mesh, origin, degenerate, rounded })
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

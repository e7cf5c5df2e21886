//! Primitives to one triangle mesh, centred, in float32.

use super::{Fault, Placed, accessor::Buffers};
use crate::mesh::{Mesh, Triangle};
use glam::{DMat3, DVec3, Vec3};
use gltf::json::{
    self,
    mesh::{Mode, Primitive, Semantic},
    validation::Checked,
};

/// More triangles than this are refused before memory is asked for: the tree indexes them with 32 bits.
const MAX_TRIANGLES: usize = 1 << 28;

pub(super) struct GeometryBuilder<'a> {
    buffers: Buffers<'a>,
    /// World positions, m, in float64 until the centre is known.
    positions: Vec<DVec3>,
    normals: Vec<Vec3>,
    triangles: Vec<Triangle>,
    default_material: usize,
    pub uses_default_material: bool,
    warnings: Vec<String>,
}

pub(super) struct Geometry {
    pub mesh: Mesh,
    pub origin: DVec3,
    pub degenerate: u64,
    pub warnings: Vec<String>,
}

impl<'a> GeometryBuilder<'a> {
    pub fn new(buffers: Buffers<'a>, material_count: usize) -> Self {
        GeometryBuilder {
            buffers,
            positions: Vec::new(),
            normals: Vec::new(),
            triangles: Vec::new(),
            default_material: material_count,
            uses_default_material: false,
            warnings: Vec::new(),
        }
    }

    /// Adds an instance of a mesh.
    pub fn add(&mut self, mesh: &json::Mesh, placed: &Placed) -> Result<(), Fault> {
        let name = mesh.name.as_deref().unwrap_or(&placed.name);
        for (k, primitive) in mesh.primitives.iter().enumerate() {
            self.add_primitive(primitive, placed, &format!("mesh `{name}`, primitive {k}"))?;
        }
        Ok(())
    }

    fn add_primitive(&mut self, primitive: &Primitive, placed: &Placed, name: &str) -> Result<(), Fault> {
        let Checked::Valid(mode) = primitive.mode else {
            return Err(format!("{name}: unknown mode"));
        };
        if matches!(mode, Mode::Points | Mode::Lines | Mode::LineLoop | Mode::LineStrip) {
            self.warnings.push(format!("{name}: points and lines are left out"));
            return Ok(());
        }
        let attribute = |semantic| primitive.attributes.get(&Checked::Valid(semantic));
        let Some(position) = attribute(Semantic::Positions) else {
            return Err(format!("{name}: no POSITION"));
        };
        let positions = self.buffers.vectors(position, &format!("{name}: POSITION"))?;
        let normals = match attribute(Semantic::Normals) {
            Some(index) => self.buffers.vectors(index, &format!("{name}: NORMAL"))?,
            None => vec![Vec3::ZERO; positions.len()],
        };
        if normals.len() != positions.len() {
            return Err(format!("{name}: {} normals for {} positions", normals.len(), positions.len()));
        }
        let indices = match &primitive.indices {
            Some(index) => self.buffers.indices(index, positions.len(), &format!("{name}: indices"))?,
            None => (0..positions.len() as u32).collect(),
        };
        let material = self.material(primitive, name)?;
        let first = u32::try_from(self.positions.len()).ok().filter(|n| n.checked_add(positions.len() as u32).is_some());
        let first = first.ok_or("more than 2^32 vertices")?;
        let mirrored = self.add_vertices(&positions, &normals, placed)?;
        for mut vertices in triangles_of(mode, &indices) {
            if mirrored {
                vertices.swap(1, 2);
            }
            self.triangles.push(Triangle { vertices: vertices.map(|i| i + first), material });
        }
        if self.triangles.len() > MAX_TRIANGLES {
            return Err(format!("more than {MAX_TRIANGLES} triangles, instances included"));
        }
        Ok(())
    }

    fn material(&mut self, primitive: &Primitive, name: &str) -> Result<u16, Fault> {
        let index = primitive.material.as_ref().map_or(self.default_material, |m| m.value());
        if primitive.material.is_some() && index >= self.default_material {
            return Err(format!("{name}: material index {index} is out of range"));
        }
        self.uses_default_material |= primitive.material.is_none();
        u16::try_from(index).map_err(|_| format!("{name}: more than 65535 materials"))
    }

    /// Places vertices in the world; true if the transform mirrors, so that winding must be turned.
    fn add_vertices(&mut self, positions: &[Vec3], normals: &[Vec3], placed: &Placed) -> Result<bool, Fault> {
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
        let place = |n: &Vec3| (normal_matrix * n.as_dvec3()).normalize_or_zero().as_vec3();
        self.normals.extend(normals.iter().map(place));
        Ok(determinant < 0.0)
    }

    /// Centres the mesh and drops triangles without area.
    pub fn finish(mut self) -> Result<Geometry, Fault> {
        let used = |t: &Triangle| t.vertices.map(|i| self.positions[i as usize]);
        let corners = self.triangles.iter().flat_map(used);
        let (low, high) =
            corners.fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(low, high), p| (low.min(p), high.max(p)));
        if self.triangles.is_empty() {
            return Err("no triangles: nothing to light or to see".into());
        }
        let origin = low + (high - low) * 0.5;
        let relative = |p: &DVec3| (*p - origin).as_vec3();
        let positions: Vec<Vec3> = self.positions.iter().map(relative).collect();
        if !positions.iter().all(|p| p.is_finite()) {
            return Err("the mesh is too large for float32 coordinates; set --metres-per-unit".into());
        }
        let triangles = std::mem::take(&mut self.triangles);
        let count = triangles.len();
        let mut mesh = Mesh { positions, normals: self.normals, triangles };
        let keep: Vec<bool> = (0..count).map(|k| mesh.area(k) > 0.0).collect();
        let mut flags = keep.iter();
        mesh.triangles.retain(|_| *flags.next().unwrap_or(&true));
        let degenerate = (count - mesh.triangles.len()) as u64;
        if mesh.triangles.is_empty() {
            return Err(format!("all {count} triangles have no area"));
        }
        if degenerate > 0 {
            self.warnings.push(format!("{degenerate} triangles without area are left out"));
        }
        Ok(Geometry { mesh, origin, degenerate, warnings: self.warnings })
    }
}

/// Corner indices of the triangles of a primitive; a remainder that makes no triangle is dropped, as glTF says.
fn triangles_of(mode: Mode, indices: &[u32]) -> Vec<[u32; 3]> {
    match mode {
        Mode::TriangleStrip => {
            let turn = |(k, w): (usize, &[u32])| if k % 2 == 0 { [w[0], w[1], w[2]] } else { [w[1], w[0], w[2]] };
            indices.windows(3).enumerate().map(turn).collect()
        }
        Mode::TriangleFan => indices.windows(2).skip(1).map(|w| [indices[0], w[0], w[1]]).collect(),
        _ => indices.chunks_exact(3).map(|c| [c[0], c[1], c[2]]).collect(),
    }
}

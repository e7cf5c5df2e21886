//! The primitives of a mesh, checked and not read yet: a mesh may have many instances, or be too large to be read.

use super::{
    accessor::CheckedAccessor,
    base_color,
    container::Document,
    draco,
    fault::{Fault, Result},
    gloss,
    materials::normal_info,
    textures::Coordinates,
    volumes,
};
use glam::Vec3;
use gltf::json::{
    self, Accessor, Index,
    mesh::{Mode, MorphTarget, Primitive, Semantic},
    texture::Info,
    validation::Checked,
};

/// The triangles of a mesh.
#[derive(Default)]
pub(super) struct CheckedMesh<'a> {
    pub list: Vec<CheckedPrimitive<'a>>,
    pub triangles: u64,
    pub vertices: u64,
    /// Most sets of joints of a vertex.
    pub sets: usize,
}

/// A primitive with the accessors of its vertices and triangles.
pub(super) struct CheckedPrimitive<'a> {
    pub positions: CheckedAccessor<'a>,
    pub normals: Option<CheckedAccessor<'a>>,
    pub indices: Option<CheckedAccessor<'a>>,
    /// Texture coordinates, and their transform by the texture.
    pub coordinates: Option<(CheckedAccessor<'a>, Coordinates)>,
    /// The same of the emissive texture.
    pub emission_coordinates: Option<(CheckedAccessor<'a>, Coordinates)>,
    /// The same of the texture of metallic and roughness.
    pub gloss_coordinates: Option<(CheckedAccessor<'a>, Coordinates)>,
    /// The same of the textures of a thin wall's share, and of the color of scattered light.
    pub scatter_coordinates: [Option<(CheckedAccessor<'a>, Coordinates)>; 2],
    /// The same of the normal map.
    pub normal_coordinates: Option<(CheckedAccessor<'a>, Coordinates)>,
    /// Tangents with the sign of the bitangent, where there are normals and a normal map.
    pub tangents: Option<CheckedAccessor<'a>>,
    pub colors: Option<CheckedAccessor<'a>>,
    targets: Vec<Target<'a>>,
    /// Joints and weights, four to a vertex in each set.
    pub influences: Vec<[CheckedAccessor<'a>; 2]>,
    /// Index of the material. Primitives without one have the number of materials.
    pub material: u16,
    mode: Mode,
}

/// Displacements of the vertices, to be added by their weight.
struct Target<'a> {
    positions: Option<CheckedAccessor<'a>>,
    normals: Option<CheckedAccessor<'a>>,
}

impl<'a> CheckedMesh<'a> {
    /// Checks the primitives of a mesh, and warns of those without triangles. Each primitive keeps the name of the mesh
    /// for messages, so that a long name is cut.
    pub fn new(document: &'a Document, mesh: &json::Mesh, name: &str, warnings: &mut Vec<String>) -> Result<Self> {
        let mut parts = CheckedMesh::default();
        let name = short(name);
        for (k, primitive) in mesh.primitives.iter().enumerate() {
            let name = format!("mesh `{name}`, primitive {k}");
            let Checked::Valid(mode) = primitive.mode else {
                return Err(format!("{name}: unknown mode"));
            };
            if matches!(mode, Mode::Points | Mode::Lines | Mode::LineLoop | Mode::LineStrip) {
                warnings.push(format!("{name}: points and lines are left out"));
                continue;
            }
            let part = CheckedPrimitive::new(document, primitive, mode, &name, warnings)?;
            let triangles = part.triangle_count();
            if triangles == 0 {
                warnings.push(format!("{name}: makes no triangle"));
            }
            parts.triangles += triangles;
            parts.vertices += part.positions.len() as u64;
            parts.sets = parts.sets.max(part.influences.len());
            parts.list.push(part);
        }
        Ok(parts)
    }
}

/// The first characters of a name.
fn short(name: &str) -> String {
    const LONGEST: usize = 200;
    match name.char_indices().nth(LONGEST) {
        Some((end, _)) => format!("{}...", &name[..end]),
        None => name.to_owned(),
    }
}

/// The function that checks an attribute, and how many numbers an element of it has in a decoded stream.
type AttributeKind<'a> = (fn(&'a Document, &Index<Accessor>, String) -> Result<CheckedAccessor<'a>>, usize);

/// A primitive of the file, with its stream if it is compressed.
struct Source<'a, 'b> {
    document: &'a Document,
    primitive: &'b Primitive,
    draco: Option<draco::Decoded>,
    name: &'b str,
}

impl<'a> Source<'a, '_> {
    /// An attribute, if the primitive has it.
    fn attribute(
        &self,
        semantic: Semantic,
        (check, components): AttributeKind<'a>,
    ) -> Result<Option<CheckedAccessor<'a>>> {
        let key = semantic.to_string();
        let Some(index) = self.primitive.attributes.get(&Checked::Valid(semantic)) else { return Ok(None) };
        let field = format!("{}: {key}", self.name);
        if let Some(draco) = &self.draco
            && let Some(column) = draco.attribute(self.document, (&key, index), components, field.clone())?
        {
            return Ok(Some(column));
        }
        check(self.document, index, field).map(Some)
    }

    /// An attribute of as many elements as there are vertices.
    fn beside(
        &self,
        positions: &CheckedAccessor,
        semantic: Semantic,
        kind: AttributeKind<'a>,
    ) -> Result<Option<CheckedAccessor<'a>>> {
        let field = format!("{}: {}", self.name, semantic.to_string());
        match self.attribute(semantic, kind)? {
            Some(column) if column.len() != positions.len() => {
                Err(format!("{field} has {} elements, POSITION {}", column.len(), positions.len()))
            }
            column => Ok(column),
        }
    }

    fn indices(&self) -> Result<Option<CheckedAccessor<'a>>> {
        let field = format!("{}: indices", self.name);
        match (&self.draco, &self.primitive.indices) {
            (Some(draco), _) => Ok(Some(draco.indices(field))),
            (None, Some(index)) => CheckedAccessor::indices(self.document, index, field).map(Some),
            (None, None) => Ok(None),
        }
    }

    /// The morph targets.
    fn targets(&self, positions: &CheckedAccessor) -> Result<Vec<Target<'a>>> {
        let column = |k: usize, name: &str, index: &Option<Index<Accessor>>| {
            let field = format!("{}: targets[{k}].{name}", self.name);
            let Some(index) = index else { return Ok(None) };
            let column = CheckedAccessor::vectors(self.document, index, field.clone())?;
            match column.len() == positions.len() {
                true => Ok(Some(column)),
                false => Err(format!("{field} has {} elements, POSITION {}", column.len(), positions.len())),
            }
        };
        let target = |(k, target): (usize, &MorphTarget)| {
            let positions = column(k, "POSITION", &target.positions)?;
            Ok(Target { positions, normals: column(k, "NORMAL", &target.normals)? })
        };
        self.primitive.targets.iter().flatten().enumerate().map(target).collect()
    }

    /// The sets of joints and weights.
    fn influences(&self, positions: &CheckedAccessor) -> Result<Vec<[CheckedAccessor<'a>; 2]>> {
        let mut sets = Vec::new();
        loop {
            let set = sets.len() as u32;
            let joints = self.beside(positions, Semantic::Joints(set), (CheckedAccessor::joints, 4))?;
            let weights = self.beside(positions, Semantic::Weights(set), (CheckedAccessor::weights, 4))?;
            match (joints, weights) {
                (Some(joints), Some(weights)) => sets.push([joints, weights]),
                (None, None) => return Ok(sets),
                _ => return Err(format!("{}: JOINTS_{set} and WEIGHTS_{set} need each other", self.name)),
            }
        }
    }

    /// Index of the material, or the number of materials.
    fn material(&self) -> Result<u16> {
        let (name, materials) = (self.name, self.document.root.materials.len());
        let material = self.primitive.material.as_ref().map_or(materials, |m| m.value());
        if self.primitive.material.is_some() && material >= materials {
            return Err(format!("{name}: material index {material} is out of range, there are {materials}"));
        }
        u16::try_from(material).map_err(|_| format!("{name}: too many materials"))
    }
}

impl<'a> CheckedPrimitive<'a> {
    fn new(
        document: &'a Document,
        primitive: &Primitive,
        mode: Mode,
        name: &str,
        warnings: &mut Vec<String>,
    ) -> Result<Self> {
        let draco = draco::Decoded::of(document, primitive).map_err(|e| format!("{name}: {e}"))?;
        // A stream holds a list of triangles in either mode.
        let mode = if draco.is_some() { Mode::Triangles } else { mode };
        let source = Source { document, primitive, draco, name };
        let positions = source.attribute(Semantic::Positions, (CheckedAccessor::vectors, 3))?;
        let positions = positions.ok_or_else(|| format!("{name}: no POSITION"))?;
        let normals = source.beside(&positions, Semantic::Normals, (CheckedAccessor::vectors, 3))?;
        let colors = source.beside(&positions, Semantic::Colors(0), (CheckedAccessor::colors, 4))?;
        let (indices, material) = (source.indices()?, source.material()?);
        let mut coordinates = |info: Option<&Info>| {
            let transform = info.map(Coordinates::new).transpose().map_err(|e| format!("{name}: {e}"))?;
            let Some(transform) = transform else { return Ok::<_, Fault>(None) };
            let set = transform.set;
            let column = source.beside(&positions, Semantic::TexCoords(set), (CheckedAccessor::coordinates, 2))?;
            if column.is_none() {
                warnings.push(format!("{name}: no TEXCOORD_{set}: one texel of its texture is taken"));
            }
            Ok(column.map(|column| (column, transform)))
        };
        let own = document.root.materials.get(usize::from(material));
        let base = own.and_then(base_color::texture);
        let emission = own.filter(|m| m.emissive_factor.0 != [0.0; 3]).and_then(|m| m.emissive_texture.as_ref());
        let bumps = own.and_then(|m| m.normal_texture.as_ref()).and_then(normal_info);
        let [share, color] =
            own.map_or([None, None], volumes::wall_textures).map(|stated| stated.map(|(info, _)| info));
        let color = color.or_else(|| own.and_then(volumes::scatter_texture));
        let scatter_coordinates = [coordinates(share.as_ref())?, coordinates(color.as_ref())?];
        let [coordinates, emission_coordinates, gloss_coordinates, normal_coordinates] = [
            coordinates(base.as_ref().map(|(info, _)| &**info))?,
            coordinates(emission)?,
            coordinates(own.and_then(gloss::texture))?,
            coordinates(bumps.as_ref())?,
        ];
        let tangents = match bumps.is_some() && normals.is_some() {
            true => source.beside(&positions, Semantic::Tangents, (CheckedAccessor::tangents, 4))?,
            false => None,
        };
        let (targets, influences) = (source.targets(&positions)?, source.influences(&positions)?);
        Ok(CheckedPrimitive {
            positions,
            normals,
            indices,
            coordinates,
            emission_coordinates,
            gloss_coordinates,
            scatter_coordinates,
            normal_coordinates,
            tangents,
            colors,
            targets,
            influences,
            material,
            mode,
        })
    }

    /// Adds the morph targets to positions and normals.
    pub fn morph(&self, weights: &[f32], positions: &mut [Vec3], normals: &mut [Vec3]) -> Result<()> {
        for (target, weight) in self.targets.iter().zip(weights).filter(|(_, weight)| **weight != 0.0) {
            for (column, vectors) in [(&target.positions, &mut *positions), (&target.normals, &mut *normals)] {
                let Some(column) = column else { continue };
                for (vector, change) in vectors.iter_mut().zip(column.read_reals()?) {
                    *vector += *weight * Vec3::from_array(change);
                }
            }
        }
        Ok(())
    }

    fn triangle_count(&self) -> u64 {
        let corners = self.indices.as_ref().map_or(self.positions.len(), CheckedAccessor::len) as u64;
        match self.mode {
            Mode::TriangleStrip | Mode::TriangleFan => corners.saturating_sub(2),
            _ => corners / 3,
        }
    }

    /// Corner indices of the triangles. Indices at the end that make no triangle are dropped, as glTF says.
    pub fn triangles(&self, indices: &[u32]) -> Vec<[u32; 3]> {
        match self.mode {
            Mode::TriangleStrip => {
                let turn = |(k, w): (usize, &[u32])| if k % 2 == 0 { [w[0], w[1], w[2]] } else { [w[1], w[0], w[2]] };
                indices.windows(3).enumerate().map(turn).collect()
            }
            Mode::TriangleFan => indices.windows(2).skip(1).map(|w| [indices[0], w[0], w[1]]).collect(),
            _ => indices.chunks_exact(3).map(|c| [c[0], c[1], c[2]]).collect(),
        }
    }
}

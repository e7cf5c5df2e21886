//! The primitives of a mesh, checked and not read yet: a mesh may have many instances, or be too large to be read.

use super::{
    accessor::CheckedAccessor,
    base_color,
    container::Document,
    fault::{Fault, Result},
    textures::Coordinates,
};
use gltf::json::{
    self, Accessor, Index,
    mesh::{Mode, Primitive, Semantic},
    texture::Info,
    validation::Checked,
};

/// The triangles of a mesh.
#[derive(Default)]
pub(super) struct CheckedMesh<'a> {
    pub list: Vec<CheckedPrimitive<'a>>,
    pub triangles: u64,
    pub vertices: u64,
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
    pub colors: Option<CheckedAccessor<'a>>,
    /// Index of the material. Primitives without one have the number of materials.
    pub material: u16,
    mode: Mode,
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

/// The function that checks an attribute.
type AttributeCheck<'a> = fn(&'a Document, &Index<Accessor>, String) -> Result<CheckedAccessor<'a>>;

impl<'a> CheckedPrimitive<'a> {
    fn new(
        document: &'a Document,
        primitive: &Primitive,
        mode: Mode,
        name: &str,
        warnings: &mut Vec<String>,
    ) -> Result<Self> {
        let attribute = |semantic| primitive.attributes.get(&Checked::Valid(semantic));
        let position = attribute(Semantic::Positions).ok_or_else(|| format!("{name}: no POSITION"))?;
        let positions = CheckedAccessor::vectors(document, position, format!("{name}: POSITION"))?;
        let beside = |semantic: Semantic, column: AttributeCheck<'a>| {
            let field = format!("{name}: {}", semantic.to_string());
            let column = attribute(semantic).map(|a| column(document, a, field.clone())).transpose()?;
            match column {
                Some(column) if column.len() != positions.len() => {
                    Err(format!("{field} has {} elements, POSITION {}", column.len(), positions.len()))
                }
                column => Ok(column),
            }
        };
        let normals = beside(Semantic::Normals, CheckedAccessor::vectors)?;
        let colors = beside(Semantic::Colors(0), CheckedAccessor::colors)?;
        let indices = primitive.indices.as_ref();
        let indices = indices.map(|i| CheckedAccessor::indices(document, i, format!("{name}: indices"))).transpose()?;
        let materials = document.root.materials.len();
        let material = primitive.material.as_ref().map_or(materials, |m| m.value());
        if primitive.material.is_some() && material >= materials {
            return Err(format!("{name}: material index {material} is out of range, there are {materials}"));
        }
        let material = u16::try_from(material).map_err(|_| format!("{name}: too many materials"))?;
        let mut coordinates = |info: Option<&Info>| {
            let transform = info.map(Coordinates::new).transpose().map_err(|e| format!("{name}: {e}"))?;
            let Some(transform) = transform else { return Ok::<_, Fault>(None) };
            let set = transform.set;
            let column = beside(Semantic::TexCoords(set), CheckedAccessor::coordinates)?;
            if column.is_none() {
                warnings.push(format!("{name}: no TEXCOORD_{set}: one texel of its texture is taken"));
            }
            Ok(column.map(|column| (column, transform)))
        };
        let own = document.root.materials.get(usize::from(material));
        let base = own.and_then(base_color::texture);
        let emission = own.filter(|m| m.emissive_factor.0 != [0.0; 3]).and_then(|m| m.emissive_texture.as_ref());
        let [coordinates, emission_coordinates] =
            [coordinates(base.as_ref().map(|(info, _)| &**info))?, coordinates(emission)?];
        Ok(CheckedPrimitive { positions, normals, indices, coordinates, emission_coordinates, colors, material, mode })
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

//! Skins: each vertex follows several nodes, its joints.

use super::{
    accessor::CheckedAccessor,
    container::Document,
    fault::{Result, get},
    nodes::SceneNode,
};
use crate::unhonoured::quoted;
use glam::DMat4;
use gltf::json::{Index, Skin};

/// The matrices of the joints of each skin, from the mesh at rest to the world, once they were needed.
pub(super) struct Skins {
    matrices: Vec<Option<Vec<DMat4>>>,
}

impl Skins {
    /// The matrices of all skins that nodes of the scene with meshes have. They do not depend on these nodes, so that
    /// many may share a skin.
    pub fn new(document: &Document, nodes: &[SceneNode]) -> Result<Skins> {
        let mut world: Vec<Option<DMat4>> = vec![None; document.root.nodes.len()];
        for placed in nodes {
            world[placed.index] = Some(placed.transform);
        }
        let mut matrices: Vec<Option<Vec<DMat4>>> = vec![None; document.root.skins.len()];
        for placed in nodes.iter().filter(|placed| placed.node.mesh.is_some()) {
            let Some(index) = &placed.node.skin else { continue };
            let skin = get(&document.root.skins, index, "node.skin")?;
            let slot = &mut matrices[index.value()];
            if slot.is_none() {
                let name = skin.name.clone().unwrap_or_else(|| format!("skin{}", index.value()));
                let own = matrices_of(document, skin, &world).map_err(|e| format!("skin {}: {e}", quoted(&name)))?;
                *slot = Some(own);
            }
        }
        Ok(Skins { matrices })
    }

    /// The matrices of a skin.
    pub fn of(&self, index: &Index<Skin>) -> Option<&[DMat4]> {
        self.matrices.get(index.value())?.as_deref()
    }
}

/// The joints that each vertex follows, and their weights, in sets of four.
pub(super) struct Influences {
    sets: Vec<[Vec<[f32; 4]>; 2]>,
}

impl Influences {
    /// Reads sets of joints and weights, one set at least.
    pub fn read(sets: &[[CheckedAccessor; 2]]) -> Result<Influences> {
        let read = |[joints, weights]: &[CheckedAccessor; 2]| Ok([joints.read_reals()?, weights.read_reals()?]);
        Ok(Influences { sets: sets.iter().map(read).collect::<Result<_>>()? })
    }

    /// The weighted sum of the matrices of a vertex. Weights that do not sum to 1 are scaled; without any, the vertex
    /// follows its first joint.
    pub fn matrix(&self, vertex: usize, matrices: &[DMat4]) -> Result<DMat4> {
        let (mut sum, mut total) = (DMat4::ZERO, 0.0);
        let of_joint = |joint: f32| {
            let matrix = matrices.get(joint as usize);
            matrix.ok_or_else(|| format!("vertex {vertex} follows a joint that its skin does not have"))
        };
        for [joints, weights] in &self.sets {
            for (joint, weight) in joints[vertex].into_iter().zip(weights[vertex]).filter(|(_, w)| *w > 0.0) {
                sum += *of_joint(joint)? * f64::from(weight);
                total += f64::from(weight);
            }
        }
        if total > 0.0 { Ok(sum * (1.0 / total)) } else { of_joint(self.sets[0][0][vertex][0]).copied() }
    }
}

fn matrices_of(document: &Document, skin: &Skin, world: &[Option<DMat4>]) -> Result<Vec<DMat4>> {
    let inverse = skin.inverse_bind_matrices.as_ref();
    let field = || "inverseBindMatrices".to_owned();
    let inverse = inverse.map(|index| CheckedAccessor::matrices(document, index, field())).transpose()?;
    let joints = skin.joints.iter().enumerate();
    let matrix = |(k, joint): (usize, &Index<_>)| {
        let index = joint.value();
        let place = world.get(index).ok_or_else(|| format!("joint {index} is no node"))?;
        let place = place.ok_or_else(|| format!("its joint, node {index}, is not in the scene; put it there"))?;
        let Some(inverse) = &inverse else { return Ok(place) };
        if k >= inverse.len() {
            return Err(format!("{} inverseBindMatrices for {} joints", inverse.len(), skin.joints.len()));
        }
        Ok(place * DMat4::from_cols_array(&inverse.real::<16>(k)?.map(f64::from)))
    };
    joints.map(matrix).collect()
}

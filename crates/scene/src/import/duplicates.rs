//! Copies of triangles, each of which would transmit or emit light of its own.

use super::geometry::retain;
use crate::{
    material::Material,
    mesh::{Mesh, Triangle},
    random::mix,
};
use std::collections::BTreeMap;

/// Drops triangles with the three positions of an earlier one of the same material, in any winding. Returns their
/// number by material.
///
/// A triangle of a one-sided emitter keeps a copy with the opposite winding: some lamps with two sides are modeled so.
pub(super) fn drop_duplicates(mesh: &mut Mesh, materials: &[Material]) -> BTreeMap<u16, u64> {
    let mut dropped = BTreeMap::new();
    let later = later_copies(mesh, |material| {
        materials.get(usize::from(material)).is_some_and(|m| m.emits() && !m.double_sided)
    });
    let (mut indices, mut later) = (0.., later.into_iter().peekable());
    let is_first = |_: &Triangle| indices.next().is_some_and(|index| later.next_if_eq(&index).is_none());
    retain(&mut mesh.triangles, &mut dropped, is_first);
    dropped
}

/// Triangles with equal keys are copies.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
struct Key {
    positions: [[u32; 3]; 3],
    material: u16,
    /// The winding, for materials whose sides differ.
    turned: bool,
}

/// Indices of the triangles that repeat an earlier one, ascending. Sorts a word for each triangle: 32 bits of hash
/// above its index. Triangles of equal hash are then compared with the first of them, in the order of the mesh for the
/// sake of the cache. A few in a million share only the hash; they are sorted by their keys.
fn later_copies(mesh: &Mesh, has_sides: impl Fn(u16) -> bool) -> Vec<u32> {
    let word = |high: u64, low: u32| high << 32 | u64::from(low);
    let mut words: Vec<u64> = (0..mesh.triangles.len() as u32).map(|k| word(hash(mesh, k), k)).collect();
    words.sort_unstable();
    let mut pairs = Vec::new();
    for group in words.chunk_by(|a, b| a >> 32 == b >> 32) {
        // The cast keeps the index.
        pairs.extend(group[1..].iter().map(|other| word(*other, group[0] as u32)));
    }
    drop(words);
    pairs.sort_unstable();
    let (mut later, mut others) = (Vec::new(), Vec::new());
    for pair in pairs {
        let (index, first) = ((pair >> 32) as u32, pair as u32);
        let own = key(mesh, index, &has_sides);
        if own == key(mesh, first, &has_sides) {
            later.push(index);
        } else {
            others.push((own, index));
        }
    }
    others.sort_unstable();
    later.extend(others.windows(2).filter(|two| two[0].0 == two[1].0).map(|two| two[1].1));
    later.sort_unstable();
    later
}

/// Positions of the corners as bits, without negative zeros.
fn corners(mesh: &Mesh, triangle: u32) -> [[u32; 3]; 3] {
    mesh.triangles[triangle as usize]
        .vertices
        .map(|i| mesh.positions[i as usize].to_array().map(|x| (x + 0.0).to_bits()))
}

/// A hash of 32 bits, equal for any order of the corners.
fn hash(mesh: &Mesh, triangle: u32) -> u64 {
    let corner = |[x, y, z]: [u32; 3]| {
        let (xy, z) = (u64::from(x) << 32 | u64::from(y), u64::from(z));
        mix(xy.wrapping_mul(0x9e37_79b9_7f4a_7c15) ^ z.wrapping_mul(0xc2b2_ae3d_27d4_eb4f))
    };
    let material = u64::from(mesh.triangles[triangle as usize].material);
    mix(corners(mesh, triangle).into_iter().map(corner).fold(material, u64::wrapping_add)) >> 32
}

fn key(mesh: &Mesh, triangle: u32, has_sides: impl Fn(u16) -> bool) -> Key {
    let [a, b, c] = corners(mesh, triangle);
    let mut positions = [a, b, c];
    positions.sort_unstable();
    let [p, q, r] = positions;
    let material = mesh.triangles[triangle as usize].material;
    let turned = has_sides(material) && ![[p, q, r], [q, r, p], [r, p, q]].contains(&[a, b, c]);
    Key { positions, material, turned }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;

    /// Triangles that share a hash are distinguished, and copies are found among them.
    ///
    /// Seen to catch: triangles of equal hash that are compared only with the first.
    #[test]
    fn equal_hashes_are_not_copies() {
        let strip = |z: f32| (0..1 << 17).map(move |k| Vec3::new(k as f32, (k % 2) as f32, z));
        let positions: Vec<Vec3> = strip(0.0).chain(strip(1.0)).collect();
        let corners = |k: u32| Triangle { vertices: [k, k + 1, k + 2], material: 0 };
        let of_strip = |first: u32| (first..first + (1 << 17) - 2).map(corners);
        let mut triangles: Vec<Triangle> = of_strip(0).chain(of_strip(1 << 17)).collect();
        let count = triangles.len() as u32;
        let mut mesh = Mesh { positions, triangles: triangles.clone(), ..Mesh::default() };
        let hashes: std::collections::BTreeSet<u64> = (0..count).map(|k| hash(&mesh, k)).collect();
        assert!(hashes.len() < triangles.len(), "no two hashes are equal");
        assert_eq!(later_copies(&mesh, |_| false), Vec::<u32>::new());
        triangles.extend_from_within(..);
        mesh.triangles = triangles;
        assert!(later_copies(&mesh, |_| false).into_iter().eq(count..2 * count));
    }
}

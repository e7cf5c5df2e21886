//! Triangle meshes as the files hold them: float32 positions, shared vertices, wound counterclockwise seen from
//! outside.

use glam::{DVec3, Vec3};

#[derive(Default)]
pub struct Mesh {
    /// Metres.
    pub positions: Vec<Vec3>,
    /// One per position on smooth shapes; empty on flat ones, whose normals glTF then takes from the triangles.
    pub normals: Vec<Vec3>,
    pub triangles: Vec<[u32; 3]>,
}

impl Mesh {
    /// A flat rectangle around `center` (m) that faces `u` × `v`; these lead from there to the middles of two sides.
    pub fn panel(center: DVec3, u: DVec3, v: DVec3) -> Self {
        let corners = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)];
        Self {
            positions: corners.map(|(x, y)| (center + x * u + y * v).as_vec3()).to_vec(),
            normals: Vec::new(),
            triangles: vec![[0, 1, 2], [0, 2, 3]],
        }
    }

    /// A panel of this half width and height that faces `target` from `center`, level at its lower side.
    pub fn lamp(center: DVec3, target: DVec3, half_width: f64, half_height: f64) -> Self {
        let facing = (target - center).normalize();
        let side = if facing.y.abs() < 0.999 { DVec3::Y.cross(facing).normalize() } else { DVec3::X };
        Self::panel(center, half_width * side, half_height * facing.cross(side))
    }

    /// Both meshes as one.
    pub fn and(mut self, other: Self) -> Self {
        let first = self.positions.len() as u32;
        self.positions.extend(other.positions);
        self.normals.extend(other.normals);
        self.triangles.extend(other.triangles.iter().map(|t| t.map(|vertex| vertex + first)));
        self
    }

    /// Moved by `offset`, m.
    pub fn moved(mut self, offset: DVec3) -> Self {
        self.positions.iter_mut().for_each(|p| *p = (p.as_dvec3() + offset).as_vec3());
        self
    }

    pub fn corners(&self, triangle: [u32; 3]) -> [DVec3; 3] {
        triangle.map(|vertex| self.positions[vertex as usize].as_dvec3())
    }

    /// Area of each triangle, m², in float64 since the areas of one mesh may span eight decades.
    pub fn triangle_area(&self, triangle: [u32; 3]) -> f64 {
        let [a, b, c] = self.corners(triangle);
        0.5 * (b - a).cross(c - a).length()
    }

    /// Smallest box around the vertices, (low, high).
    pub fn bounds(&self) -> (Vec3, Vec3) {
        let empty = (Vec3::INFINITY, Vec3::NEG_INFINITY);
        self.positions.iter().fold(empty, |(low, high), &p| (low.min(p), high.max(p)))
    }
}

#[cfg(test)]
mod tests {
    use std::collections::{BTreeMap, BTreeSet};

    use super::*;
    use crate::scene::Surface;

    /// Enclosed volume, m³, as the sum of tetrahedra with the origin; positive when triangles face outward.
    fn volume(mesh: &Mesh) -> f64 {
        let tetrahedron = |[a, b, c]: [DVec3; 3]| a.dot(b.cross(c)) / 6.0;
        mesh.triangles.iter().map(|&t| tetrahedron(mesh.corners(t))).sum()
    }

    fn translucent_meshes() -> impl Iterator<Item = (&'static str, &'static Mesh)> {
        let parts = crate::SCENES.iter().flat_map(|scene| &scene.parts);
        parts.filter(|part| matches!(part.surface, Surface::Translucent { .. })).map(|part| (part.name, &part.mesh))
    }

    #[test]
    fn translucent_meshes_are_closed_and_face_outward() {
        for (name, mesh) in translucent_meshes() {
            let mut edges = BTreeSet::new();
            for &[a, b, c] in &mesh.triangles {
                for edge in [(a, b), (b, c), (c, a)] {
                    assert!(edges.insert(edge), "{name}: directed edge {edge:?} occurs twice");
                }
            }
            let open = edges.iter().find(|&&(a, b)| !edges.contains(&(b, a)));
            assert_eq!(open, None, "{name}: edge without its reverse");
            assert!(volume(mesh) > 0.0, "{name}: inside out");
        }
    }

    /// Each vertex's triangles form one fan, and no vertex is unused: two sheets that meet in a point would pass the
    /// edge test.
    #[test]
    fn translucent_meshes_are_manifold_at_each_vertex() {
        for (name, mesh) in translucent_meshes() {
            let mut next_around = vec![BTreeMap::new(); mesh.positions.len()];
            for &[a, b, c] in &mesh.triangles {
                for [center, from, to] in [[a, b, c], [b, c, a], [c, a, b]] {
                    next_around[center as usize].insert(from, to);
                }
            }
            for (vertex, next) in next_around.iter().enumerate() {
                let start = *next.keys().next().unwrap_or_else(|| panic!("{name}: vertex {vertex} is unused"));
                let mut fan = 1;
                let mut at = next[&start];
                while at != start && fan <= next.len() {
                    at = next[&at];
                    fan += 1;
                }
                assert_eq!(fan, next.len(), "{name}: vertex {vertex} joins several sheets");
            }
        }
    }

    #[test]
    fn no_triangle_is_degenerate() {
        for scene in crate::SCENES.iter() {
            for part in &scene.parts {
                for &triangle in &part.mesh.triangles {
                    let area_m2 = part.mesh.triangle_area(triangle);
                    assert!(area_m2 > 1e-12, "{}: triangle {triangle:?} has {area_m2} m²", part.name);
                }
            }
        }
    }

    #[test]
    fn vertex_normals_are_unit_and_agree_with_the_triangles() {
        for (name, mesh) in translucent_meshes().filter(|(_, mesh)| !mesh.normals.is_empty()) {
            assert_eq!(mesh.normals.len(), mesh.positions.len());
            for &triangle in &mesh.triangles {
                let [a, b, c] = mesh.corners(triangle);
                let facing = (b - a).cross(c - a).normalize();
                for vertex in triangle {
                    let normal = mesh.normals[vertex as usize].as_dvec3();
                    assert!((normal.length() - 1.0).abs() < 1e-6, "{name}: normal {normal}");
                    assert!(normal.dot(facing) > 0.3, "{name}: normal {normal} on a triangle facing {facing}");
                }
            }
        }
    }
}

//! Defects of a mesh that is to hold a medium: it should be closed, wound outwards, and without duplicates.

use crate::{mesh::Mesh, scene::Scene};
use glam::{DVec3, Vec3};
use std::{collections::BTreeMap, fmt};

/// Defects of the surfaces that bound media. Vertices at the same position are one, whatever their normals.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct MeshDefects {
    /// Edges where the surface ends.
    pub open_edges: u64,
    /// Edges whose two triangles are wound against each other.
    pub flipped_edges: u64,
    /// Closed parts that are wound inwards, other than cavities.
    pub inward_parts: u64,
    /// Triangles with the same corners as another, wound either way. Those of one material were left out; those of two
    /// materials are two surfaces, and each lets in light.
    pub duplicate_triangles: u64,
    /// Triangles without area; they were left out.
    pub degenerate_triangles: u64,
}

impl MeshDefects {
    pub fn is_good(&self) -> bool {
        *self == MeshDefects::default()
    }

    /// From counts by the names of [`MeshDefects::counts`]; a count without a name is 0.
    pub fn from_counts(count: impl Fn(&str) -> Option<u64>) -> MeshDefects {
        let [open_edges, flipped_edges, inward_parts, duplicate_triangles, degenerate_triangles] =
            MeshDefects::default().counts().map(|(name, _)| count(name).unwrap_or(0));
        MeshDefects { open_edges, flipped_edges, inward_parts, duplicate_triangles, degenerate_triangles }
    }

    /// The counts in order, with their names in statistics.
    pub fn counts(&self) -> [(&'static str, u64); 5] {
        [
            ("open_edges", self.open_edges),
            ("flipped_edges", self.flipped_edges),
            ("inward_parts", self.inward_parts),
            ("duplicate_triangles", self.duplicate_triangles),
            ("degenerate_triangles", self.degenerate_triangles),
        ]
    }
}

/// The defects as one line.
impl fmt::Display for MeshDefects {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let found = self.counts().into_iter().filter(|(_, count)| *count > 0);
        let found: Vec<String> = found.map(|(name, count)| format!("{count} {}", name.replace('_', " "))).collect();
        f.write_str(&if found.is_empty() { "no faults".into() } else { found.join(", ") })
    }
}

impl Scene {
    /// Examines the surfaces of the materials that `belong`, as [`Mesh::defects`] does, and counts triangles that were
    /// left out on import.
    pub fn defects(&self, belong: impl Fn(u16) -> bool) -> MeshDefects {
        let left_out = |counts: &BTreeMap<u16, u64>| -> u64 {
            counts.iter().filter(|(material, _)| belong(**material)).map(|(_, count)| count).sum()
        };
        let mut defects = self.mesh.defects(&belong);
        defects.duplicate_triangles += left_out(&self.duplicate_triangles);
        defects.degenerate_triangles = left_out(&self.degenerate_triangles);
        defects
    }
}

impl Mesh {
    /// Examines the triangles whose material `belongs`, all together, since a body may have several materials. For `n`
    /// triangles it takes `n log n` steps.
    pub fn defects(&self, belongs: impl Fn(u16) -> bool) -> MeshDefects {
        let (welded, points) = self.weld();
        let own = self.triangles.iter().filter(|t| belongs(t.material));
        let mut triangles: Vec<[u32; 3]> = own.map(|t| t.vertices.map(|i| welded[i as usize])).collect();
        let count = triangles.len();
        // The first of several triangles with the same corners is kept.
        triangles.sort_by_key(sorted);
        triangles.dedup_by_key(|t| sorted(t));
        let mut parts = Parts::new(&points, &triangles);
        let [open_edges, flipped_edges] = unmatched_edges(&triangles, |corner| parts.open(corner));
        MeshDefects {
            open_edges,
            flipped_edges,
            inward_parts: parts.inward(),
            duplicate_triangles: (count - triangles.len()) as u64,
            degenerate_triangles: 0,
        }
    }

    /// For each vertex the index of the point that it lies at, and the different points.
    fn weld(&self) -> (Vec<u32>, Vec<DVec3>) {
        // Adding 0 makes -0 and 0 equal.
        let key = |p: &Vec3| p.to_array().map(|x| (x + 0.0).to_bits());
        let mut order: Vec<([u32; 3], u32)> = self.positions.iter().map(key).zip(0..).collect();
        order.sort_unstable();
        let (mut welded, mut points) = (vec![0; order.len()], Vec::new());
        for group in order.chunk_by(|a, b| a.0 == b.0) {
            group.iter().for_each(|(_, vertex)| welded[*vertex as usize] = points.len() as u32);
            points.push(self.positions[group[0].1 as usize].as_dvec3());
        }
        (welded, points)
    }
}

fn sorted(triangle: &[u32; 3]) -> [u32; 3] {
    let mut corners = *triangle;
    corners.sort_unstable();
    corners
}

/// The number of open edges, of an odd number of triangles, and of flipped ones, which triangles pass more often in one
/// direction than in the other. `tell` is given an end point of each.
fn unmatched_edges(triangles: &[[u32; 3]], mut tell: impl FnMut(u32)) -> [u64; 2] {
    // The two end points, the lower one first, and in the last bit the direction.
    let edge = |a: u32, b: u32| u64::from(a.min(b)) << 33 | u64::from(a.max(b)) << 1 | u64::from(a > b);
    let mut edges: Vec<u64> =
        triangles.iter().flat_map(|[a, b, c]| [edge(*a, *b), edge(*b, *c), edge(*c, *a)]).collect();
    edges.sort_unstable();
    let (mut open, mut flipped) = (0, 0);
    for group in edges.chunk_by(|a, b| a >> 1 == b >> 1) {
        let back = group.iter().filter(|e| *e & 1 == 1).count();
        let surplus = group.len().abs_diff(2 * back) as u64;
        if surplus > 0 {
            open += surplus % 2;
            flipped += surplus / 2;
            tell((group[0] >> 33) as u32);
        }
    }
    [open, flipped]
}

/// A connected part of the surface.
#[derive(Clone, Copy)]
struct Part {
    closed: bool,
    /// The volume that it encloses, m³; negative if it is wound inwards.
    volume: f64,
    /// m².
    area: f64,
    low: DVec3,
    high: DVec3,
}

struct Parts {
    /// For each point, the next one on its path to the root of its part (union-find).
    parents: Vec<u32>,
    /// For each root, the index of its part.
    of_root: Vec<u32>,
    list: Vec<Part>,
}

impl Parts {
    fn new(points: &[DVec3], triangles: &[[u32; 3]]) -> Parts {
        let mut parents: Vec<u32> = (0..points.len() as u32).collect();
        for [a, b, c] in triangles {
            for other in [b, c] {
                let (one, other) = (root(&mut parents, *a), root(&mut parents, *other));
                parents[one as usize] = other;
            }
        }
        let empty = Part { closed: true, volume: 0.0, area: 0.0, low: DVec3::INFINITY, high: DVec3::NEG_INFINITY };
        let (mut of_root, mut list) = (vec![u32::MAX; points.len()], Vec::new());
        for triangle in triangles {
            let number = &mut of_root[root(&mut parents, triangle[0]) as usize];
            if *number == u32::MAX {
                *number = list.len() as u32;
                list.push(empty);
            }
            let part = &mut list[*number as usize];
            let [a, b, c] = triangle.map(|k| points[k as usize]);
            part.volume += a.dot(b.cross(c)) / 6.0;
            part.area += 0.5 * (b - a).cross(c - a).length();
            part.low = part.low.min(a).min(b).min(c);
            part.high = part.high.max(a).max(b).max(c);
        }
        Parts { parents, of_root, list }
    }

    /// Marks the part of this point as not closed.
    fn open(&mut self, point: u32) {
        let root = root(&mut self.parents, point);
        self.list[self.of_root[root as usize] as usize].closed = false;
    }

    /// The number of closed parts that are wound inwards and are not cavities. A part is a cavity if its box lies in
    /// that of a body wound outwards; only the largest bodies are tested, so that the time is linear in the number of
    /// parts.
    fn inward(&self) -> u64 {
        const BODIES: usize = 256;
        // A sheet of two sides encloses nothing: its volume is rounding error of either sign.
        let inside_out = |p: &&Part| p.closed && p.volume < -1e-6 * p.area.powf(1.5);
        let mut bodies: Vec<&Part> = self.list.iter().filter(|p| p.volume > 0.0).collect();
        bodies.sort_by(|a, b| b.volume.total_cmp(&a.volume));
        bodies.truncate(BODIES);
        let within = |p: &Part, body: &Part| body.low.cmplt(p.low).all() && body.high.cmpgt(p.high).all();
        let no_cavity = |p: &&Part| !bodies.iter().any(|body| within(p, body));
        self.list.iter().filter(inside_out).filter(no_cavity).count() as u64
    }
}

/// The root of a point's part; the path to it is halved on the way.
fn root(parents: &mut [u32], mut point: u32) -> u32 {
    while parents[point as usize] != point {
        let above = parents[parents[point as usize] as usize];
        parents[point as usize] = above;
        point = above;
    }
    point
}

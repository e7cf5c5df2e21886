//! Ribbons of triangles: pairs of neighbors make quadrilaterals, and each quadrilateral continues the one before across
//! their common edge. A lattice that runs along a ribbon is broken at its two sides only, not at every edge.

use rayon::prelude::*;
use scene::{Mesh, Vec3, random::mix};

/// The part that a triangle has in a cell of a ribbon. A cell is a quadrilateral `a b d c`, mapped to the unit square
/// with `a = (0, 0)`, `b = (1, 0)`, `c = (0, 1)`, `d = (1, 1)` and cut from `b` to `c`; or the first half of one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Part {
    /// `a b c`, without a second half.
    Alone,
    /// `a b c`.
    First,
    /// `d b c`; its link follows that of the first half.
    Second,
}

/// A triangle on a ribbon.
#[derive(Clone, Copy, Debug)]
pub struct Link {
    pub triangle: u32,
    pub part: Part,
    /// Which of the triangle's corners are `a` (or `d`), `b` and `c`.
    pub corners: [u8; 3],
    /// Whether the square is mirrored with respect to the ribbon.
    pub mirrored: bool,
}

/// The index that stands for no triangle.
const NONE: u32 = u32::MAX;

/// The largest number of cells of a ribbon: longer ribbons are less compact.
const MAX_CELLS: usize = 16;

/// Squared lengths of edges within this ratio count as equal, so that rounding does not decide.
const EQUAL_RATIO: f32 = 1.01;

/// The triangle across an edge: its index in the list, and its corner that is not on the edge.
#[derive(Clone, Copy)]
struct Across {
    index: u32,
    apex: u8,
}

/// Puts the triangles of a list on ribbons, each of which starts with the first triangle that is left.
pub fn ribbons(mesh: &Mesh, triangles: &[u32]) -> Vec<Link> {
    let links = Vec::with_capacity(triangles.len());
    let across = neighbors(mesh, triangles);
    let mut weaver = Weaver { mesh, triangles, across, used: vec![false; triangles.len()], links };
    for index in 0..triangles.len() {
        if !weaver.used[index] {
            weaver.ribbon(index);
        }
    }
    weaver.links
}

struct Weaver<'a> {
    mesh: &'a Mesh,
    triangles: &'a [u32],
    /// For each triangle, the triangles across the edges that are opposite its corners.
    across: Vec<[Across; 3]>,
    used: Vec<bool>,
    links: Vec<Link>,
}

/// The first half of a cell.
struct Start {
    index: usize,
    /// `a`, `b`, `c`.
    corners: [u8; 3],
    mirrored: bool,
}

impl Weaver<'_> {
    fn ribbon(&mut self, index: usize) {
        let mut next = Some(self.start(index));
        for _ in 0..MAX_CELLS {
            let Some(start) = next else { break };
            next = self.cell(start);
        }
    }

    /// The first cell of a ribbon. It is cut along the longest edge with a free triangle across, and oriented so that
    /// the ribbon can continue.
    fn start(&self, index: usize) -> Start {
        let a = [1, 2].into_iter().fold(0, |best, a| if self.cuts_better(index, a, best) { a } else { best });
        let (p, q) = ((a + 1) % 3, (a + 2) % 3);
        let continues = self.free(index, a).is_some_and(|second| {
            let c = self.same_corner(index, q, second);
            self.free(second.index as usize, c).is_some()
        });
        Start { index, corners: if continues { [a, p, q] } else { [a, q, p] }, mirrored: false }
    }

    /// Adds a cell, and returns the start of the next one if there is one.
    fn cell(&mut self, start: Start) -> Option<Start> {
        let Start { index, corners, mirrored } = start;
        self.used[index] = true;
        let second = self.free(index, corners[0]);
        self.add(index, if second.is_some() { Part::First } else { Part::Alone }, corners, mirrored);
        let second = second?;
        let own = second.index as usize;
        let d = second.apex;
        let c = self.same_corner(index, corners[2], second);
        let b = 3 - d - c;
        self.used[own] = true;
        self.add(own, Part::Second, [d, b, c], mirrored);
        // `a` and `c` of the next cell are `b` and `d` of this one.
        let next = self.free(own, c)?;
        let (low, high) = if mirrored { (d, b) } else { (b, d) };
        let low = self.same_corner(own, low, next);
        let high = self.same_corner(own, high, next);
        let index = next.index as usize;
        let mirrored = self.cuts_better(index, high, low);
        let corners = if mirrored { [high, next.apex, low] } else { [low, next.apex, high] };
        Some(Start { index, corners, mirrored })
    }

    fn add(&mut self, index: usize, part: Part, corners: [u8; 3], mirrored: bool) {
        self.links.push(Link { triangle: self.triangles[index], part, corners, mirrored });
    }

    /// The triangle across the edge opposite a corner, if it is on no ribbon yet.
    fn free(&self, index: usize, corner: u8) -> Option<Across> {
        let across = self.across[index][corner as usize];
        (across.index != NONE && !self.used[across.index as usize]).then_some(across)
    }

    /// Whether a cell is better cut along the edge opposite corner `a` than along the one opposite `b`.
    fn cuts_better(&self, index: usize, a: u8, b: u8) -> bool {
        match [a, b].map(|corner| self.free(index, corner).is_some()) {
            [true, true] => self.opposite_edge(index, a) > EQUAL_RATIO * self.opposite_edge(index, b),
            [own, other] => own && !other,
        }
    }

    fn position(&self, index: usize, corner: u8) -> Vec3 {
        corner_position(self.mesh, self.triangles[index], corner)
    }

    /// Squared length of the edge opposite a corner, m².
    fn opposite_edge(&self, index: usize, corner: u8) -> f32 {
        self.position(index, (corner + 1) % 3).distance_squared(self.position(index, (corner + 2) % 3))
    }

    /// The corner of the triangle across that coincides with this corner.
    fn same_corner(&self, index: usize, corner: u8, across: Across) -> u8 {
        let next = (across.apex + 1) % 3;
        if self.position(across.index as usize, next) == self.position(index, corner) {
            next
        } else {
            (across.apex + 2) % 3
        }
    }
}

fn corner_position(mesh: &Mesh, triangle: u32, corner: u8) -> Vec3 {
    mesh.positions[mesh.triangles[triangle as usize].vertices[corner as usize] as usize]
}

/// The triangle across each edge: the only other triangle with the same end points, if it is of the same material.
fn neighbors(mesh: &Mesh, triangles: &[u32]) -> Vec<[Across; 3]> {
    let ends = |edge: u32| {
        let (triangle, apex) = (triangles[(edge / 3) as usize], (edge % 3) as u8);
        [1, 2].map(|k| corner_position(mesh, triangle, (apex + k) % 3))
    };
    let mut edges: Vec<(u64, u32)> = (0..3 * triangles.len() as u32)
        .into_par_iter()
        .map(|edge| {
            let [p, q] = ends(edge).map(|p| p.to_array().iter().fold(0, |key, x| mix(key ^ u64::from(x.to_bits()))));
            // A sum is the same for both directions of the edge.
            (p.wrapping_add(q), edge)
        })
        .collect();
    edges.par_sort_unstable();
    let mut across = vec![[Across { index: NONE, apex: 0 }; 3]; triangles.len()];
    let material = |edge: u32| mesh.triangles[triangles[(edge / 3) as usize] as usize].material;
    for group in edges.chunk_by(|x, y| x.0 == y.0) {
        let &[(_, x), (_, y)] = group else { continue };
        let ([p, q], [r, s]) = (ends(x), ends(y));
        let same_ends = (p, q) == (r, s) || (p, q) == (s, r);
        if same_ends && p != q && material(x) == material(y) {
            for (from, to) in [(x, y), (y, x)] {
                across[(from / 3) as usize][(from % 3) as usize] = Across { index: to / 3, apex: (to % 3) as u8 };
            }
        }
    }
    across
}

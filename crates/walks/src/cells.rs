//! Which beams of light pass each cell of a grid.
//!
//! The beam behind a triangle is a prism: the triangle moved along the refracted direction, as far as light reaches. The
//! cells that it touches hold its index, by the separating axes of a prism and a box.

use glam::{DVec3, USizeVec3};
use rayon::prelude::*;
use std::ops::Range;

/// Cells of the grid at most, and the indices that they hold together: 16 and 64 MiB.
const MAX_CELLS: usize = 1 << 22;
const MAX_ENTRIES: usize = 1 << 24;

/// The light below a triangle.
pub struct Prism {
    pub corners: [DVec3; 3],
    /// Unit normal of the triangle.
    pub normal: DVec3,
    /// From each corner to the end of its ray.
    pub depth: DVec3,
    /// The distance from the prism within which the light may be too, m.
    pub margin: f64,
}

/// For each cell of a grid, the prisms that reach it.
pub struct Cells {
    low: DVec3,
    /// 1/m.
    inverse: f64,
    size: USizeVec3,
    /// The first entry of each cell, and the end of the last.
    starts: Vec<u32>,
    entries: Vec<u32>,
}

impl Cells {
    /// A grid over the box `[low, high]` with cells of the edge `edge`, or of a longer one where memory needs it. The
    /// same for any number of threads.
    pub fn new([low, high]: [DVec3; 2], edge: f64, prisms: usize, prism: impl Fn(usize) -> Prism + Sync) -> Cells {
        let extent = high - low;
        let mut edge = edge.max(extent.max_element() / 4096.0).max(f64::MIN_POSITIVE);
        loop {
            let size = (extent / edge).floor().as_usizevec3() + 1;
            if size.element_product() <= MAX_CELLS {
                let grid = Cells { low, inverse: 1.0 / edge, size, starts: Vec::new(), entries: Vec::new() };
                let count = |k: usize| {
                    let mut count = 0;
                    grid.each(&prism(k), |_| count += 1);
                    count
                };
                // The largest cells hold every prism once, however many there are.
                let total: usize = (0..prisms).into_par_iter().map(count).sum();
                if total <= MAX_ENTRIES.max(prisms) || size == USizeVec3::ONE {
                    return grid.filled(prisms, total, prism);
                }
            }
            edge *= 1.3;
        }
    }

    fn filled(self, prisms: usize, total: usize, prism: impl Fn(usize) -> Prism + Sync) -> Cells {
        let pairs = |k: usize| {
            let mut cells = Vec::new();
            self.each(&prism(k), |cell| cells.push((cell as u32, k as u32)));
            cells
        };
        let mut pairs: Vec<(u32, u32)> = (0..prisms).into_par_iter().flat_map_iter(pairs).collect();
        debug_assert_eq!(pairs.len(), total);
        pairs.par_sort_unstable();
        let cells = self.size.element_product() as u32;
        let mut starts = Vec::with_capacity(cells as usize + 1);
        let mut next = 0;
        for cell in 0..=cells {
            while pairs.get(next).is_some_and(|pair| pair.0 < cell) {
                next += 1;
            }
            starts.push(next as u32);
        }
        Cells { starts, entries: pairs.into_iter().map(|pair| pair.1).collect(), ..self }
    }

    /// The prisms that may hold a point; none outside the grid.
    #[inline(always)]
    pub fn at(&self, position: DVec3) -> &[u32] {
        let p = (position - self.low) * self.inverse;
        let (x, y, z) = (p.x as usize, p.y as usize, p.z as usize);
        let inside = p.x >= 0.0 && p.y >= 0.0 && p.z >= 0.0;
        if !inside || x >= self.size.x || y >= self.size.y || z >= self.size.z {
            return &[];
        }
        let cell = (z * self.size.y + y) * self.size.x + x;
        &self.entries[self.starts[cell] as usize..self.starts[cell + 1] as usize]
    }

    /// Calls `found` with every cell that a prism touches.
    fn each(&self, prism: &Prism, mut found: impl FnMut(usize)) {
        let scale = |p: DVec3| (p - self.low) * self.inverse;
        let [a, b, c] = prism.corners.map(scale);
        let depth = prism.depth * self.inverse;
        let points = [a, b, c, a + depth, b + depth, c + depth];
        let reach = 0.5 + prism.margin * self.inverse + 1e-9;
        let (low, high) = points.iter().fold((points[0], points[0]), |(l, h), p| (l.min(*p), h.max(*p)));
        // Slabs between the two planes across each axis that could separate prism and box.
        let across = |edge: DVec3| edge.cross(depth).normalize_or_zero();
        let slabs = [prism.normal, across(b - a), across(c - b), across(a - c)].map(|axis| {
            let along = points.map(|p| axis.dot(p));
            let room = reach * axis.abs().element_sum();
            let (low, high) = along.iter().fold((along[0], along[0]), |(l, h), x| (l.min(*x), h.max(*x)));
            (axis, low - room, high + room)
        });
        let range = |axis: usize| -> Range<usize> {
            let first = (low[axis] - reach - 0.5).ceil().max(0.0) as usize;
            let end = (high[axis] + reach + 0.5).floor().max(0.0) as usize;
            first.min(self.size[axis])..end.min(self.size[axis])
        };
        for z in range(2) {
            for y in range(1) {
                for x in range(0) {
                    let center = DVec3::new(x as f64, y as f64, z as f64) + 0.5;
                    let touches = |(axis, low, high): &(DVec3, f64, f64)| (*low..=*high).contains(&axis.dot(center));
                    if slabs.iter().all(touches) {
                        found((z * self.size.y + y) * self.size.x + x);
                    }
                }
            }
        }
    }
}

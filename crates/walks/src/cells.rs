//! Which beams of light pass each cell of a grid.
//!
//! The beam behind a triangle is a prism: the triangle moved along the refracted direction, as far as light reaches. The
//! cells that it touches hold its index, by the separating axes of a prism and a box.

use glam::{DVec3, USizeVec3};
use rayon::prelude::*;
use std::{
    ops::Range,
    sync::atomic::{AtomicU32, Ordering},
};

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
                let counts: Vec<AtomicU32> = (0..=size.element_product()).map(|_| AtomicU32::new(0)).collect();
                (0..prisms).into_par_iter().for_each(|k| {
                    grid.each(&prism(k), |cell| _ = counts[cell].fetch_add(1, Ordering::Relaxed));
                });
                // The largest cell holds every prism once, however many there are.
                let total: usize = counts.iter().map(|count| count.load(Ordering::Relaxed) as usize).sum();
                if total <= MAX_ENTRIES || size == USizeVec3::ONE {
                    return grid.filled(prisms, counts, prism);
                }
            }
            edge *= 1.3;
        }
    }

    fn filled(self, prisms: usize, counts: Vec<AtomicU32>, prism: impl Fn(usize) -> Prism + Sync) -> Cells {
        let mut total = 0;
        let starts: Vec<u32> = counts
            .iter()
            .map(|count| {
                let start = total;
                // From here on the counts are the places of the next entries.
                total += count.swap(start, Ordering::Relaxed);
                start
            })
            .collect();
        let entries: Vec<AtomicU32> = (0..total).map(|_| AtomicU32::new(0)).collect();
        (0..prisms).into_par_iter().for_each(|k| {
            self.each(&prism(k), |cell| {
                let place = counts[cell].fetch_add(1, Ordering::Relaxed) as usize;
                entries[place].store(k as u32, Ordering::Relaxed);
            });
        });
        let mut entries: Vec<u32> = entries.into_iter().map(AtomicU32::into_inner).collect();
        // Threads took their places in any order.
        let mut rest = &mut entries[..];
        let mut lists = Vec::with_capacity(starts.len());
        for bounds in starts.windows(2) {
            let (list, after) = rest.split_at_mut((bounds[1] - bounds[0]) as usize);
            lists.push(list);
            rest = after;
        }
        lists.into_par_iter().for_each(|list| list.sort_unstable());
        Cells { starts, entries, ..self }
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

    /// Calls `found` with the prisms of this grid that may touch another one; with some more than once.
    pub fn within(&self, prism: &Prism, mut found: impl FnMut(u32)) {
        self.each(prism, |cell| {
            self.entries[self.starts[cell] as usize..self.starts[cell + 1] as usize].iter().for_each(|k| found(*k));
        });
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
        let range = |axis: usize, low: f64, high: f64| -> Range<usize> {
            let first = (low - reach - 0.5).ceil().max(0.0) as usize;
            let end = (high + reach + 0.5).floor().max(0.0) as usize;
            first.min(self.size[axis])..end.min(self.size[axis])
        };
        // Layer by layer across the axis that the prism runs along, so that few cells are tried in vain.
        let w = depth.abs().max_position();
        let (u, v) = ((w + 1) % 3, (w + 2) % 3);
        let least = |axis: usize| a[axis].min(b[axis]).min(c[axis]);
        let most = |axis: usize| a[axis].max(b[axis]).max(c[axis]);
        for k in range(w, low[w], high[w]) {
            let middle = k as f64 + 0.5;
            // The part of the way that takes the triangle through the layer.
            let ends = [middle - reach - most(w), middle + reach - least(w)].map(|d| (d / depth[w]).clamp(0.0, 1.0));
            let along = |axis: usize| {
                let [one, two] = ends.map(|share| share * depth[axis]);
                range(axis, least(axis) + one.min(two), most(axis) + one.max(two))
            };
            for j in along(v) {
                for i in along(u) {
                    let mut cell = USizeVec3::ZERO;
                    (cell[u], cell[v], cell[w]) = (i, j, k);
                    let center = cell.as_dvec3() + 0.5;
                    let touches = |(axis, low, high): &(DVec3, f64, f64)| (*low..=*high).contains(&axis.dot(center));
                    if slabs.iter().all(touches) {
                        found((cell.z * self.size.y + cell.y) * self.size.x + cell.x);
                    }
                }
            }
        }
    }
}

//! A grid that knows how far the nearest triangle is at least.
//!
//! Voxels that a triangle touches, and their neighbors, are marked; the exact distance transform of Felzenszwalb and
//! Huttenlocher 2012 then gives each voxel its distance to the nearest marked one. The time of a build is that of the
//! grid, not of a search for each voxel.

use glam::{DVec3, USizeVec3};
use rayon::prelude::*;
use std::sync::atomic::{AtomicBool, Ordering};

/// Voxels at most: 2 MiB, little enough for a processor's cache, and twelve times that while the grid is built.
const MAX_VOXELS: usize = 1 << 21;

/// Voxels along an axis at most.
const MAX_SIDE: usize = 512;

/// Steps per voxel that distances are rounded down to; those beyond 64 voxels count as that.
const STEPS: f64 = 4.0;

/// What the rounding of positions at voxels' sides may add, as a share.
const ROUNDING: f64 = 1e-9;

/// Lower bounds of the distance to the nearest triangle.
pub struct Clearance {
    low: DVec3,
    /// 1/m.
    inverse: f64,
    size: USizeVec3,
    /// m per step.
    step: f64,
    /// By z, then y, then x.
    steps: Vec<u8>,
}

impl Clearance {
    /// A grid over the box `[low, high]`; `corners` gives the corners of each of `triangles`, of which those outside
    /// the box count too. The same grid for any number of threads.
    pub fn new([low, high]: [DVec3; 2], triangles: usize, corners: impl Fn(usize) -> [DVec3; 3] + Sync) -> Clearance {
        let (size, edge) = shape(high - low);
        let marked = marked(low, edge, size, triangles, corners);
        let mut squares: Vec<f32> = marked.into_iter().map(|m| if m { 0.0 } else { f32::INFINITY }).collect();
        // Each pass treats the axis whose neighbors are adjacent in memory, and turns the next one into it.
        let mut lengths = [size.x, size.y, size.z];
        for _ in 0..3 {
            squares.par_chunks_mut(lengths[0]).for_each_init(Envelope::default, |envelope, line| envelope.apply(line));
            squares = rotated(&squares, lengths);
            lengths.rotate_left(1);
        }
        let steps = squares.par_iter().map(|square| (f64::from(*square).sqrt() * STEPS) as u8).collect();
        Clearance { low, inverse: 1.0 / edge, size, step: edge / STEPS * (1.0 - ROUNDING), steps }
    }

    /// No triangle is nearer than this, m; 0 outside the grid.
    #[inline(always)]
    pub fn at(&self, position: DVec3) -> f64 {
        let p = (position - self.low) * self.inverse;
        let inside = p.x >= 0.0 && p.y >= 0.0 && p.z >= 0.0;
        let (x, y, z) = (p.x as usize, p.y as usize, p.z as usize);
        if !inside || x >= self.size.x || y >= self.size.y || z >= self.size.z {
            return 0.0;
        }
        f64::from(self.steps[(z * self.size.y + y) * self.size.x + x]) * self.step
    }
}

/// The number of voxels along each axis, and the length of their edges: as small as the limits allow.
fn shape(extent: DVec3) -> (USizeVec3, f64) {
    let longest = extent.max_element().max(f64::MIN_POSITIVE);
    let mut side = MAX_SIDE;
    loop {
        let edge = longest / side as f64;
        let size = (extent / edge).ceil().max(DVec3::ONE).min(DVec3::splat(side as f64)).as_usizevec3();
        if size.element_product() <= MAX_VOXELS {
            return (size, edge);
        }
        side -= 8;
    }
}

/// Which voxels have a triangle in them or in one of their 26 neighbors, and perhaps a few more.
fn marked(
    low: DVec3,
    edge: f64,
    size: USizeVec3,
    triangles: usize,
    corners: impl Fn(usize) -> [DVec3; 3] + Sync,
) -> Vec<bool> {
    let marks: Vec<AtomicBool> = (0..size.element_product()).map(|_| AtomicBool::new(false)).collect();
    (0..triangles).into_par_iter().for_each(|k| {
        let corners = corners(k).map(|corner| (corner - low) / edge);
        mark(&corners, size, |v| marks[(v[2] * size.y + v[1]) * size.x + v[0]].store(true, Ordering::Relaxed));
    });
    marks.into_iter().map(AtomicBool::into_inner).collect()
}

/// Half the edge of a voxel with its neighbors, and a little for rounding.
const REACH: f64 = 1.5 + 1e-6;

/// Marks the voxels that one triangle comes near, in columns along the axis nearest to its normal.
fn mark(corners: &[DVec3; 3], size: USizeVec3, mut set: impl FnMut([usize; 3])) {
    let [a, b, c] = *corners;
    let normal = (b - a).cross(c - a);
    let w = normal.abs().max_position();
    let (u, v) = ((w + 1) % 3, (w + 2) % 3);
    let range = |axis: usize| {
        let (low, high) = (a[axis].min(b[axis]).min(c[axis]), a[axis].max(b[axis]).max(c[axis]));
        voxels(low, high, size[axis])
    };
    let slopes = if normal[w] == 0.0 { None } else { Some((-normal[u] / normal[w], -normal[v] / normal[w])) };
    let (all, height) = (range(w), |x: f64, y: f64, (s, t): (f64, f64)| a[w] + s * (x - a[u]) + t * (y - a[v]));
    for j in range(v) {
        for i in range(u) {
            let (x, y) = (i as f64 + 0.5, j as f64 + 0.5);
            if !touches(corners, u, v, x, y) {
                continue;
            }
            let column = slopes.map_or(all.clone(), |slopes| {
                let (center, spread) = (height(x, y, slopes), REACH * (slopes.0.abs() + slopes.1.abs()));
                let near = voxels(center - spread, center + spread, size[w]);
                near.start.max(all.start)..near.end.min(all.end)
            });
            for k in column {
                let mut voxel = [0; 3];
                (voxel[u], voxel[v], voxel[w]) = (i, j, k);
                set(voxel);
            }
        }
    }
}

/// The voxels along an axis whose centers are within [`REACH`] of an interval.
fn voxels(low: f64, high: f64, count: usize) -> std::ops::Range<usize> {
    let first = (low - REACH - 0.5).ceil().max(0.0) as usize;
    let end = (high + REACH + 0.5).floor().max(0.0) as usize;
    first.min(count)..end.min(count)
}

/// Whether the square of half-width [`REACH`] about a point meets the triangle, both projected along an axis: no edge
/// separates them.
fn touches(corners: &[DVec3; 3], u: usize, v: usize, x: f64, y: f64) -> bool {
    (0..3).all(|k| {
        let (p, q, r) = (corners[k], corners[(k + 1) % 3], corners[(k + 2) % 3]);
        let across = [q[v] - p[v], p[u] - q[u]];
        let offset = |x: f64, y: f64| across[0] * (x - p[u]) + across[1] * (y - p[v]);
        let inner = offset(r[u], r[v]);
        let outward = if inner > 0.0 { -offset(x, y) } else { offset(x, y) };
        outward <= REACH * (across[0].abs() + across[1].abs())
    })
}

/// The axes `[a, b, c]` (the first is adjacent in memory) in the order `[b, c, a]`.
fn rotated(values: &[f32], [a, b, c]: [usize; 3]) -> Vec<f32> {
    let mut turned = vec![0.0; values.len()];
    turned.par_chunks_mut(b * c).enumerate().for_each(|(i, plane)| {
        for (k, value) in plane.iter_mut().enumerate() {
            *value = values[k * a + i];
        }
    });
    turned
}

/// The lower envelope of parabolas, by which a line of squared distances takes in those along it.
#[derive(Default)]
struct Envelope {
    values: Vec<f32>,
    /// The vertices of the parabolas in the envelope, and where each begins to be the lowest.
    vertices: Vec<(usize, f64)>,
}

impl Envelope {
    /// `line[i] ← min_j line[j] + (i − j)²`.
    fn apply(&mut self, line: &mut [f32]) {
        self.values.clear();
        self.values.extend_from_slice(line);
        self.vertices.clear();
        let value = |j: usize| f64::from(self.values[j]) + (j * j) as f64;
        for j in (0..line.len()).filter(|j| self.values[*j] < f32::INFINITY) {
            let mut begin = f64::NEG_INFINITY;
            while let Some(&(last, start)) = self.vertices.last() {
                begin = (value(j) - value(last)) / (2.0 * (j - last) as f64);
                if begin > start {
                    break;
                }
                self.vertices.pop();
                begin = f64::NEG_INFINITY;
            }
            self.vertices.push((j, begin));
        }
        let mut current = 0;
        if self.vertices.is_empty() {
            return;
        }
        for (i, square) in line.iter_mut().enumerate() {
            while self.vertices.get(current + 1).is_some_and(|(_, begin)| *begin <= i as f64) {
                current += 1;
            }
            let j = self.vertices[current].0;
            *square = self.values[j] + (i.abs_diff(j) * i.abs_diff(j)) as f32;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Sequence;
    use scene::random::{Purpose, Stream};

    fn distance(p: DVec3, [a, b, c]: [DVec3; 3]) -> f64 {
        // The nearest of many points of the triangle, which is not nearer than the true one.
        let steps = 60;
        let mut best = f64::INFINITY;
        for i in 0..=steps {
            for j in 0..=steps - i {
                let (s, t) = (f64::from(i) / f64::from(steps), f64::from(j) / f64::from(steps));
                best = best.min((a + (b - a) * s + (c - a) * t).distance(p));
            }
        }
        best
    }

    /// The bound holds, and is within two voxels' diagonals of the distance.
    ///
    /// Seen to catch: marks without neighbors; an envelope that keeps hidden parabolas; axes turned the other way.
    #[test]
    fn the_bound_is_below_the_distance_and_near_it() {
        let mut random = Sequence::new(Stream::new(5, Purpose::LightWalk).item(0));
        let mut point = || DVec3::new(random.uniform(), 2.0 * random.uniform(), 3.0 * random.uniform());
        let triangles: Vec<[DVec3; 3]> = (0..4).map(|_| [point(), point(), point()]).collect();
        let bounds = [DVec3::ZERO, DVec3::new(1.0, 2.0, 3.0)];
        let grid = Clearance::new(bounds, 4, |k| triangles[k]);
        let edge = 1.0 / grid.inverse;
        for _ in 0..2000 {
            let p = point();
            let nearest = triangles.iter().map(|t| distance(p, *t)).fold(f64::INFINITY, f64::min);
            let bound = grid.at(p);
            assert!(bound <= nearest, "{bound} {nearest}");
            assert!(bound >= nearest - 0.05 - 2.0 * 3f64.sqrt() * edge, "{bound} {nearest} {edge}");
        }
        assert_eq!(grid.at(DVec3::new(0.5, 0.5, -0.1)), 0.0);
    }

    /// Flat and tiny boxes have a grid, and it is not too large.
    #[test]
    fn every_box_has_a_grid() {
        for extent in [DVec3::ONE, DVec3::new(1.0, 1.0, 0.0), DVec3::new(1e-30, 0.0, 0.0), DVec3::ZERO] {
            let corners = [DVec3::ZERO, DVec3::new(extent.x, extent.y, 0.0), extent];
            let grid = Clearance::new([DVec3::ZERO, extent], 1, |_| corners);
            assert!(grid.steps.len() <= MAX_VOXELS);
            assert_eq!(grid.at(extent * 0.5), 0.0);
        }
    }
}

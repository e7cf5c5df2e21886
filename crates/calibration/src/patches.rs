//! The surface of one material in patches of equal area, and smooth functions on them.
//!
//! Points that are spread evenly over the surface are split by planes in the six dimensions of position and normal, each
//! time at the median of the longest dimension, or next to it where several points lie there, until the parts are small.
//! The normal counts as a length, so that the two sides of a thin part belong to different patches.

use formats::calibration::{CalibratedPatch, CalibratedSurface};
use glam::{DMat3, DVec3};

/// A point of the surface: position, m, and the normal of its triangle.
#[derive(Clone, Copy, Debug)]
pub struct Site {
    pub position: DVec3,
    pub normal: DVec3,
}

/// A point in the six dimensions, m.
type Six = [f64; 6];

/// A binary tree of splits over `2^depth` patches, the center of each patch, and the patches that are near it. While a
/// calibration is made, two more levels of splits divide each patch into four cells.
#[derive(Clone, Debug, PartialEq)]
pub struct Patches {
    /// The length that a unit normal counts as, m.
    normal_scale: f64,
    /// A heap: node `i` has the children `2i + 1` and `2i + 2`.
    splits: Vec<Split>,
    centers: Vec<Six>,
    /// The largest distance of a site from the center of its patch, m.
    radii: Vec<f64>,
    /// For each patch, the patches whose weight is positive at some of its points.
    near: Vec<Vec<u32>>,
}

/// Points whose coordinate `axis` is below `value` belong to the first child.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Split {
    pub axis: u8,
    pub value: f64,
}

/// The length that a unit normal counts as, in units of the side of a square patch. Surfaces whose normals differ by more
/// than sixty degrees are apart: across the rim of a thin part, one side is lit and the other dark.
const NORMALS: f64 = 2.0;

/// The support of a patch's weight, in units of the side of a square patch.
const SUPPORT: f64 = 2.0;

/// The weight of the one link of a patch that has no other: all to the patch, and nothing to the other's many.
const LONELY: f64 = 1e-3;

/// Levels of splits below those of the patches.
const CELL_LEVELS: u32 = 2;

impl Patches {
    /// Splits sites that are spread evenly over an area (m²) into `2^depth` patches; the cell of each site is returned
    /// as well.
    pub fn new(sites: &[Site], area: f64, depth: u32) -> (Patches, Vec<u32>) {
        let count = 1usize << depth;
        let normal_scale = NORMALS * (area / count as f64).sqrt();
        let points: Vec<Six> = sites.iter().map(|s| six(s, normal_scale)).collect();
        let mut order: Vec<u32> = (0..points.len() as u32).collect();
        let mut splits = vec![Split { axis: 0, value: 0.0 }; (count << CELL_LEVELS) - 1];
        split(&points, &mut order, &mut splits, 0);
        let mut patches =
            Patches { normal_scale, splits, centers: vec![[0.0; 6]; count], radii: vec![0.0; count], near: Vec::new() };
        let cell_of: Vec<u32> = sites.iter().map(|s| patches.cell(s)).collect();
        let mut counts = vec![0u32; count];
        for (point, cell) in points.iter().zip(&cell_of) {
            let patch = patches.patch_of_cell(*cell) as usize;
            counts[patch] += 1;
            for k in 0..6 {
                patches.centers[patch][k] += point[k];
            }
        }
        for (center, count) in patches.centers.iter_mut().zip(&counts) {
            center.iter_mut().for_each(|x| *x /= f64::from(*count).max(1.0));
        }
        for (point, cell) in points.iter().zip(&cell_of) {
            let patch = patches.patch_of_cell(*cell) as usize;
            let radius = distance2(point, &patches.centers[patch]).sqrt();
            patches.radii[patch] = patches.radii[patch].max(radius);
        }
        patches.near = patches.neighbors();
        (patches, cell_of)
    }

    /// The patches that a file holds.
    pub fn from_facts(facts: &CalibratedSurface) -> Patches {
        let mut patches = Patches {
            normal_scale: facts.normal_scale,
            splits: facts.splits.iter().map(|(axis, value)| Split { axis: *axis, value: *value }).collect(),
            centers: facts.patches.iter().map(|p| p.center).collect(),
            radii: facts.patches.iter().map(|p| p.radius).collect(),
            near: Vec::new(),
        };
        patches.near = patches.neighbors();
        patches
    }

    /// The gradient along the surface of a function that is given at the centers of the patches, 1/m: that of the plane
    /// which fits the differences to the neighbors best. Patches where the function is not finite are left out.
    pub fn gradient(&self, values: &[f64]) -> Vec<DVec3> {
        let mut sums = vec![(DMat3::ZERO, DVec3::ZERO); self.count()];
        for (i, j, weight) in self.links() {
            let (i, j) = (i as usize, j as usize);
            let step = position(&self.centers[j]) - position(&self.centers[i]);
            let change = values[j] - values[i];
            if change.is_finite() {
                for k in [i, j] {
                    let (matrix, vector) = &mut sums[k];
                    *matrix += DMat3::from_cols(step * step.x, step * step.y, step * step.z) * weight;
                    *vector += step * (weight * change);
                }
            }
        }
        let gradient = |((matrix, vector), center): (&(DMat3, DVec3), &Six)| {
            let normal = DVec3::new(center[3], center[4], center[5]).normalize_or_zero();
            let (x, y) = normal.any_orthonormal_pair();
            let [xx, xy, yy] = [x.dot(*matrix * x), x.dot(*matrix * y), y.dot(*matrix * y)];
            let (bx, by, determinant) = (x.dot(*vector), y.dot(*vector), xx * yy - xy * xy);
            // Neighbors in a line determine no plane.
            let is_plane = determinant > 1e-3 * (xx + yy).powi(2) && normal != DVec3::ZERO;
            let solve = || (x * (yy * bx - xy * by) + y * (xx * by - xy * bx)) / determinant;
            if is_plane { solve() } else { DVec3::ZERO }
        };
        sums.iter().zip(&self.centers).map(gradient).collect()
    }

    /// What a file holds of them, with the logarithms of the factors of each patch, and the gradients of the light.
    pub fn facts(&self, log_factors: &[[f32; 3]], gradients: &[[[f32; 3]; 3]]) -> CalibratedSurface {
        let patch = |k: usize| CalibratedPatch {
            center: self.centers[k],
            radius: self.radii[k],
            log_factor: log_factors[k],
            gradient: gradients[k],
        };
        CalibratedSurface {
            normal_scale: self.normal_scale,
            splits: self.splits[..self.count() - 1].iter().map(|s| (s.axis, s.value)).collect(),
            patches: (0..self.count()).map(patch).collect(),
        }
    }

    pub fn count(&self) -> usize {
        self.centers.len()
    }

    /// The number of cells.
    pub fn cells(&self) -> usize {
        self.splits.len() + 1
    }

    /// The patch of a site.
    pub fn patch(&self, site: &Site) -> u32 {
        self.descend(site, self.count() - 1)
    }

    /// The cell of a site; its patch if there are no cells.
    pub fn cell(&self, site: &Site) -> u32 {
        self.descend(site, self.splits.len())
    }

    pub fn patch_of_cell(&self, cell: u32) -> u32 {
        cell >> (self.cells().ilog2() - self.count().ilog2())
    }

    /// The number among the nodes after the first `splits`, which is that of a whole number of levels.
    fn descend(&self, site: &Site, splits: usize) -> u32 {
        let point = six(site, self.normal_scale);
        let mut node = 0;
        while node < splits {
            let split = &self.splits[node];
            node = 2 * node + 1 + usize::from(point[usize::from(split.axis)] >= split.value);
        }
        (node - splits) as u32
    }

    /// Sums over the cells of each patch.
    pub fn sums(&self, cells: &[f64]) -> Vec<f64> {
        let mut sums = vec![0.0; self.count()];
        cells.iter().enumerate().for_each(|(cell, x)| sums[self.patch_of_cell(cell as u32) as usize] += x);
        sums
    }

    /// Weights that sum to 1 and change smoothly along the surface, of the patches near a site (docs/method.md 16.4). A
    /// function with the value `f_j` at patch `j` is interpolated as `Σ w_j f_j`.
    pub fn weights(&self, site: &Site, mut tell: impl FnMut(u32, f64)) {
        let patch = self.patch(site);
        let point = six(site, self.normal_scale);
        let near = &self.near[patch as usize];
        let sum: f64 = near.iter().map(|j| self.weight(&point, *j)).sum();
        if sum <= 0.0 {
            return tell(patch, 1.0);
        }
        for j in near {
            let weight = self.weight(&point, *j);
            if weight > 0.0 {
                tell(*j, weight / sum);
            }
        }
    }

    /// The pairs of patches that are next to each other, with a weight that falls with their distance; each pair once. A
    /// patch whose center is near no other, as that of a ring, is linked to the nearest one.
    pub fn links(&self) -> Vec<(u32, u32, f64)> {
        let mut links = Vec::new();
        let mut alone = vec![true; self.count()];
        for (i, near) in self.near.iter().enumerate() {
            for j in near.iter().filter(|j| **j as usize > i) {
                let weight = self.weight(&self.centers[i], *j);
                if weight > 0.0 {
                    links.push((i as u32, *j, weight));
                    (alone[i], alone[*j as usize]) = (false, false);
                }
            }
        }
        let distance = |i: usize, j: usize| distance2(&self.centers[i], &self.centers[j]);
        for i in (0..self.count()).filter(|i| alone[*i]) {
            let others = (0..self.count()).filter(|j| *j != i);
            let nearest = others.min_by(|a, b| distance(i, *a).total_cmp(&distance(i, *b)));
            links.extend(nearest.map(|j| (i.min(j) as u32, i.max(j) as u32, LONELY)));
        }
        links
    }

    /// `(1 − d²/R²)²` of the distance `d` from the center of patch `j`; 0 beyond the support `R`.
    fn weight(&self, point: &Six, j: u32) -> f64 {
        let rest = (1.0 - distance2(point, &self.centers[j as usize]) / self.support().powi(2)).max(0.0);
        rest * rest
    }

    /// The distance from the center of a patch at which its weight ends, m.
    fn support(&self) -> f64 {
        SUPPORT / NORMALS * self.normal_scale
    }

    /// The patches whose support meets the ball of each patch with its radius in the six dimensions.
    fn neighbors(&self) -> Vec<Vec<u32>> {
        let support = self.support();
        let of = |(center, radius): (&Six, &f64)| {
            let reach2 = (support + radius).powi(2);
            let near = |j: &u32| distance2(center, &self.centers[*j as usize]) < reach2;
            (0..self.centers.len() as u32).filter(near).collect()
        };
        self.centers.iter().zip(&self.radii).map(of).collect()
    }
}

fn six(site: &Site, normal_scale: f64) -> Six {
    let (p, n) = (site.position, site.normal * normal_scale);
    [p.x, p.y, p.z, n.x, n.y, n.z]
}

fn position(six: &Six) -> DVec3 {
    DVec3::new(six[0], six[1], six[2])
}

fn distance2(a: &Six, b: &Six) -> f64 {
    (0..6).map(|k| (a[k] - b[k]).powi(2)).sum()
}

/// Splits the points in `order` at node `node` and below.
fn split(points: &[Six], order: &mut [u32], splits: &mut [Split], node: usize) {
    if node >= splits.len() {
        return;
    }
    let extent = |axis: usize| {
        let values = order.iter().map(|k| points[*k as usize][axis]);
        let (low, high) = values.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), x| (l.min(x), h.max(x)));
        high - low
    };
    let axis = (0..6).max_by(|a, b| extent(*a).total_cmp(&extent(*b))).unwrap_or(0);
    order.sort_unstable_by(|a, b| points[*a as usize][axis].total_cmp(&points[*b as usize][axis]).then(a.cmp(b)));
    let at = |k: usize| points[order[k] as usize][axis];
    // Sites with the same coordinate cannot be told apart: of a flat sheet, the normals have two values.
    let differs = |k: &usize| at(k - 1) < at(*k);
    let half = order.len() / 2;
    let below = (1..=half).rev().find(differs);
    let above = (half + 1..order.len()).find(differs);
    let middle = below.into_iter().chain(above).min_by_key(|k| k.abs_diff(half)).unwrap_or(half);
    // Between the two, coordinates may be rounded otherwise than those of the sites.
    let value = if (1..order.len()).contains(&middle) { 0.5 * (at(middle - 1) + at(middle)) } else { 0.0 };
    splits[node] = Split { axis: axis as u8, value };
    let (low, high) = order.split_at_mut(middle);
    split(points, low, splits, 2 * node + 1);
    split(points, high, splits, 2 * node + 2);
}

#[cfg(test)]
mod tests;

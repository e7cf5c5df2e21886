//! What a surface sees of an environment, by the way it faces: the light of each part of the sky times a cosine.

use super::hierarchical_sampler::HierarchicalSampler2d;
use glam::DVec3;
use std::f64::consts::{FRAC_PI_2, PI, TAU};

/// Tiles that the sky is divided into, at most.
pub(super) const TILE_COLUMNS: usize = 32;
pub(super) const TILE_ROWS: usize = 16;

/// Normals fall into bins on the sides of a cube: this many along each edge.
const BINS: usize = 16;

/// For each bin of normals, the light of every tile of the sky times a cosine.
#[derive(Debug)]
pub(super) struct CosineImportanceTable {
    normal_bins: Vec<HierarchicalSampler2d>,
}

/// Share of the largest possible cosine that a tile counts with, though its middle be below the horizon.
const MIN_SHARE: f64 = 0.5;

/// Directions within an angle of an axis.
#[derive(Clone, Copy)]
struct Cone {
    axis: DVec3,
    angle: f64,
}

impl CosineImportanceTable {
    /// The tiles of a map, whose pixels have this light: the finest level of it that has few enough cells.
    pub fn new(power: &HierarchicalSampler2d) -> CosineImportanceTable {
        let level = power.level_within(TILE_COLUMNS, TILE_ROWS);
        let (columns, rows) = power.size(level);
        let pixels = power.size(0);
        let tiles: Vec<Cone> = (0..columns * rows).map(|k| tile(pixels, level, k % columns, k / columns)).collect();
        let light = |facing: Cone| {
            HierarchicalSampler2d::new(columns, rows, |x, y| {
                power.weight(level, x, y) * likely_cosine(facing, tiles[y * columns + x])
            })
        };
        CosineImportanceTable { normal_bins: (0..6 * BINS * BINS).map(|k| light(square(k))).collect() }
    }

    /// The tiles for a unit normal, with the light that each sends to the surface.
    pub fn facing(&self, normal: DVec3) -> &HierarchicalSampler2d {
        &self.normal_bins[normal_bin_of(normal)]
    }
}

/// A number near the cosine of the normals with the directions, and positive if any of it is.
fn likely_cosine(normals: Cone, directions: Cone) -> f64 {
    normals.axis.dot(directions.axis).max(MIN_SHARE * max_cosine(normals, directions))
}

/// An upper bound of the cosine of normals of the one with directions of the other.
fn max_cosine(normals: Cone, directions: Cone) -> f64 {
    let between = normals.axis.angle_between(directions.axis);
    // Rounding must not hide what lies on the horizon.
    let least = between - normals.angle - directions.angle - 1e-6;
    if least < FRAC_PI_2 { least.max(0.0).cos() } else { 0.0 }
}

/// The cone around a cell of a level of a map of so many pixels.
fn tile((width, height): (usize, usize), level: usize, column: usize, row: usize) -> Cone {
    let share = |index: usize, count: usize| ((index << level) as f64 / count as f64).min(1.0);
    let (left, right) = (share(column, width), share(column + 1, width));
    let (top, bottom) = (share(row, height), share(row + 1, height));
    let direction = |across: f64, down: f64| {
        let ((sine, cosine), (radius, height)) = ((TAU * (across - 0.5)).sin_cos(), (PI * down).sin_cos());
        DVec3::new(radius * cosine, height, radius * sine)
    };
    // More than a quarter of a turn is not within the cone of its corners.
    if right - left > 0.25 {
        return Cone { axis: DVec3::Y, angle: PI };
    }
    let corners = [(left, top), (right, top), (left, bottom), (right, bottom)].map(|(x, y)| direction(x, y));
    around(direction(0.5 * (left + right), 0.5 * (top + bottom)), &corners)
}

/// The square of normals that holds a unit vector.
fn normal_bin_of(normal: DVec3) -> usize {
    let size = normal.abs();
    let axis = if size.x >= size.y && size.x >= size.z {
        0
    } else if size.y >= size.z {
        1
    } else {
        2
    };
    let side = 2 * axis + usize::from(normal[axis] < 0.0);
    let place = |k: usize| {
        let share = 0.5 + 0.5 * normal[(axis + k) % 3] / size[axis];
        ((share * BINS as f64) as usize).min(BINS - 1)
    };
    (side * BINS + place(1)) * BINS + place(2)
}

/// The cone around a square of normals.
fn square(index: usize) -> Cone {
    let (side, place) = (index / (BINS * BINS), [index / BINS % BINS, index % BINS]);
    let direction = |offset: [f64; 2]| {
        let mut d = DVec3::ZERO;
        let axis = side / 2;
        d[axis] = if side % 2 == 0 { 1.0 } else { -1.0 };
        (0..2).for_each(|k| d[(axis + 1 + k) % 3] = 2.0 * (place[k] as f64 + offset[k]) / BINS as f64 - 1.0);
        d.normalize()
    };
    around(direction([0.5; 2]), &[[0.0, 0.0], [0.0, 1.0], [1.0, 0.0], [1.0, 1.0]].map(direction))
}

/// The cone about an axis that holds these corners.
fn around(axis: DVec3, corners: &[DVec3]) -> Cone {
    let angle = corners.iter().map(|c| axis.angle_between(*c)).fold(0.0, f64::max);
    Cone { axis, angle }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::{Item, Purpose, Stream};

    fn direction(item: Item, first: u64) -> DVec3 {
        let z = 2.0 * item.uniform(first) - 1.0;
        let (sine, cosine) = (TAU * item.uniform(first + 1)).sin_cos();
        let radius = (1.0 - z * z).sqrt();
        DVec3::new(radius * cosine, radius * sine, z)
    }

    /// Planted: sides of the cube mixed up, columns of a partial last tile taken for whole ones.
    #[test]
    fn squares_and_windows_lie_within_their_cones() {
        let stream = Stream::new(3, Purpose::Surface);
        let (width, height) = (37, 19);
        for k in 0..20_000 {
            let d = direction(stream.item(k), 0);
            let cone = square(normal_bin_of(d));
            assert!(cone.axis.angle_between(d) < cone.angle + 1e-9 && cone.angle < 0.2);
            let across = (d.z.atan2(d.x) / TAU + 0.5) * f64::from(width as u32);
            let down = d.y.acos() / PI * f64::from(height as u32);
            for level in 0..7 {
                let cell = |x: f64| x as usize >> level;
                let cone = tile((width, height), level, cell(across), cell(down));
                assert!(cone.axis.angle_between(d) < cone.angle + 1e-9, "{d} {level}");
            }
        }
    }

    /// The largest cosine is one, and not much more than there is. Planted: angles added with the wrong sign.
    #[test]
    fn cosines_are_bounded_from_above() {
        let stream = Stream::new(4, Purpose::Surface);
        let within = |cone: Cone, d: DVec3, xi: f64| {
            let across = (d - cone.axis * d.dot(cone.axis)).normalize();
            let (sine, cosine) = (cone.angle * xi).sin_cos();
            cone.axis * cosine + across * sine
        };
        for k in 0..20_000 {
            let item = stream.item(k);
            let [one, two] = [0, 2].map(|d| Cone { axis: direction(item, d), angle: 0.3 * item.uniform(d + 20) });
            let (n, w) =
                (within(one, direction(item, 4), item.uniform(6)), within(two, direction(item, 7), item.uniform(9)));
            let most = max_cosine(one, two);
            assert!(n.dot(w) <= most + 1e-12, "{} {most}", n.dot(w));
            let [least, middle] = [one.angle + two.angle, one.axis.dot(two.axis)];
            assert!(most <= middle.max(0.0) + least + 1e-5);
        }
    }
}

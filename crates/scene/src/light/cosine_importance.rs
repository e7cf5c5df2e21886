//! The light that a surface receives from each part of an environment, by its normal: the light of each part times a
//! cosine.

use super::{direction_cone::DirectionCone, hierarchical_sampler::HierarchicalSampler2d};
use glam::DVec3;
use std::f64::consts::{PI, TAU};

/// The largest number of columns and rows of tiles that the sky is divided into.
pub(super) const TILE_COLUMNS: usize = 32;
pub(super) const TILE_ROWS: usize = 16;

/// Number of bins of normals along each edge of a cube, on whose sides the bins are squares.
const BINS: usize = 16;

/// For each bin of normals, the light of every tile of the sky times a cosine.
#[derive(Debug)]
pub(super) struct CosineImportanceTable {
    normal_bins: Vec<HierarchicalSampler2d>,
}

/// Share of the largest possible cosine that a tile counts with at least, though its center may be below the horizon.
const MIN_SHARE: f64 = 0.5;

impl CosineImportanceTable {
    /// The table of a map whose pixels have this `power`. Its tiles are the cells of the finest level with few enough
    /// cells.
    pub fn new(power: &HierarchicalSampler2d) -> CosineImportanceTable {
        let level = power.level_within(TILE_COLUMNS, TILE_ROWS);
        let (columns, rows) = power.size(level);
        let pixels = power.size(0);
        let tiles: Vec<DirectionCone> =
            (0..columns * rows).map(|k| tile(pixels, level, k % columns, k / columns)).collect();
        let light = |normals: DirectionCone| {
            HierarchicalSampler2d::new(columns, rows, |x, y| {
                power.weight(level, x, y) * likely_cosine(normals, tiles[y * columns + x])
            })
        };
        CosineImportanceTable { normal_bins: (0..6 * BINS * BINS).map(|k| light(normal_bin(k))).collect() }
    }

    /// The tiles for a unit normal, with the light that each sends to the surface.
    pub fn facing(&self, normal: DVec3) -> &HierarchicalSampler2d {
        &self.normal_bins[normal_bin_of(normal)]
    }
}

/// An estimate of the cosine between the normals and the directions, positive if that of any two of them is.
fn likely_cosine(normals: DirectionCone, directions: DirectionCone) -> f64 {
    normals.axis.dot(directions.axis).max(MIN_SHARE * normals.max_cosine(&directions))
}

/// The directions of a cell of a level of a map with these pixels.
fn tile((width, height): (usize, usize), level: usize, column: usize, row: usize) -> DirectionCone {
    let share = |index: usize, count: usize| ((index << level) as f64 / count as f64).min(1.0);
    let (left, right) = (share(column, width), share(column + 1, width));
    let (top, bottom) = (share(row, height), share(row + 1, height));
    let direction = |across: f64, down: f64| {
        let ((sine, cosine), (radius, height)) = ((TAU * (across - 0.5)).sin_cos(), (PI * down).sin_cos());
        DVec3::new(radius * cosine, height, radius * sine)
    };
    // A cell wider than a quarter turn is not within the cone of its corners.
    if right - left > 0.25 {
        return DirectionCone { axis: DVec3::Y, half_angle: PI };
    }
    let corners = [(left, top), (right, top), (left, bottom), (right, bottom)].map(|(x, y)| direction(x, y));
    DirectionCone::around(direction(0.5 * (left + right), 0.5 * (top + bottom)), &corners)
}

/// The index of the bin that holds a unit normal.
fn normal_bin_of(normal: DVec3) -> usize {
    let size = normal.abs();
    let axis = size.max_position();
    let side = 2 * axis + usize::from(normal[axis] < 0.0);
    let bin = |k: usize| {
        let share = 0.5 + 0.5 * normal[(axis + k) % 3] / size[axis];
        ((share * BINS as f64) as usize).min(BINS - 1)
    };
    (side * BINS + bin(1)) * BINS + bin(2)
}

/// The normals of a bin.
fn normal_bin(index: usize) -> DirectionCone {
    let (side, bin) = (index / (BINS * BINS), [index / BINS % BINS, index % BINS]);
    let direction = |offset: [f64; 2]| {
        let mut d = DVec3::ZERO;
        let axis = side / 2;
        d[axis] = if side % 2 == 0 { 1.0 } else { -1.0 };
        (0..2).for_each(|k| d[(axis + 1 + k) % 3] = 2.0 * (bin[k] as f64 + offset[k]) / BINS as f64 - 1.0);
        d.normalize()
    };
    DirectionCone::around(direction([0.5; 2]), &[[0.0, 0.0], [0.0, 1.0], [1.0, 0.0], [1.0, 1.0]].map(direction))
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

    /// Seen to catch: sides of the cube mixed up, columns of a partial last tile taken for whole ones.
    #[test]
    fn normal_bins_and_tiles_lie_within_their_cones() {
        let stream = Stream::new(3, Purpose::Surface);
        let (width, height) = (37, 19);
        for k in 0..20_000 {
            let d = direction(stream.item(k), 0);
            let cone = normal_bin(normal_bin_of(d));
            assert!(cone.axis.angle_between(d) < cone.half_angle + 1e-9 && cone.half_angle < 0.2);
            let across = (d.z.atan2(d.x) / TAU + 0.5) * f64::from(width as u32);
            let down = d.y.acos() / PI * f64::from(height as u32);
            for level in 0..7 {
                let cell = |x: f64| x as usize >> level;
                let cone = tile((width, height), level, cell(across), cell(down));
                assert!(cone.axis.angle_between(d) < cone.half_angle + 1e-9, "{d} {level}");
            }
        }
    }
}

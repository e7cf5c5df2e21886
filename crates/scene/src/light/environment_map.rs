//! Light from all around by a picture in the equirectangular projection.
//!
//! Seen from inside with +Y up, the middle of the picture lies in direction +X, and its columns run to the right,
//! towards +Z; the top row surrounds +Y. A rotation turns it about +Y, counter-clockwise seen from above. Radiance is
//! constant over each pixel: directions are chosen by exactly what a ray sees.

use super::{
    contract::{Illumination, channel_sum},
    cosine_importance::{CosineImportanceTable, TILE_COLUMNS, TILE_ROWS},
    hierarchical_sampler::{Cell, HierarchicalSampler2d},
};
use crate::mesh::SurfacePoint;
use glam::{DVec2, DVec3, Vec3};
use std::f64::consts::{PI, TAU};

/// The largest number of pixels of a map.
const MAX_PIXELS: usize = 1 << 27;

/// Why pixels cannot be a map.
#[derive(Debug, thiserror::Error)]
pub enum MapError {
    #[error(
        "pixel {column}, {row} is {value}; radiance must be finite and not negative: clamp the picture and save it again"
    )]
    Pixel { column: usize, row: usize, value: Vec3 },
    #[error("{width} x {height} pixels; an environment has between 1 and {MAX_PIXELS}: scale the picture down")]
    Size { width: usize, height: usize },
}

/// A picture of distant light. Its directions are chosen in proportion to radiance, solid angle and the cosine at the
/// surface.
#[derive(Debug)]
pub struct EnvironmentMap {
    width: usize,
    height: usize,
    /// Row after row from the top, W/(m² sr) before the scale is applied.
    pixels: Vec<Vec3>,
    scale: f64,
    rotation_degrees: f64,
    /// Cosine and sine of the rotation.
    rotation: DVec2,
    /// Channel sum times solid angle of each pixel.
    power: HierarchicalSampler2d,
    /// For each bin of normals, the light of each tile times a cosine.
    cosine_importance: CosineImportanceTable,
}

impl EnvironmentMap {
    /// Bytes that a map of this width and height takes: 12 for a pixel, 4 for its weight, and a third of 4 for the
    /// coarser levels, each of which has a quarter of the cells of the level below.
    pub fn bytes((width, height): (usize, usize)) -> u64 {
        (width as u64).saturating_mul(height as u64).saturating_mul(18)
    }

    /// A map of `width * height` pixels of radiance, row after row from the top, W/(m² sr) after multiplication by
    /// `scale`.
    pub fn new(
        (width, height): (usize, usize),
        pixels: Vec<Vec3>,
        scale: f64,
        rotation_degrees: f64,
    ) -> Result<EnvironmentMap, MapError> {
        let count = width.checked_mul(height).filter(|n| (1..=MAX_PIXELS).contains(n) && *n == pixels.len());
        if count.is_none() {
            return Err(MapError::Size { width, height });
        }
        let bad = |p: &Vec3| !(p.is_finite() && p.min_element() >= 0.0);
        if let Some(k) = pixels.iter().position(bad) {
            return Err(MapError::Pixel { column: k % width, row: k / width, value: pixels[k] });
        }
        let solid_angles: Vec<f64> = (0..height).map(|row| solid_angle(width, height, row)).collect();
        let power = HierarchicalSampler2d::new(width, height, |x, y| {
            channel_sum(pixels[y * width + x].as_dvec3()) * solid_angles[y]
        });
        let cosine_importance = CosineImportanceTable::new(&power);
        let (sine, cosine) = rotation_degrees.to_radians().sin_cos();
        let rotation = DVec2::new(cosine, sine);
        Ok(EnvironmentMap { width, height, pixels, scale, rotation_degrees, rotation, power, cosine_importance })
    }

    /// Radiance that a ray in this unit direction sees, W/(m² sr).
    pub fn radiance(&self, direction: DVec3) -> DVec3 {
        self.pixel_radiance(self.pixel(self.in_map(direction)))
    }

    fn pixel_radiance(&self, [column, row]: [usize; 2]) -> DVec3 {
        self.pixels[row * self.width + column].as_dvec3() * self.scale
    }

    pub(super) fn is_black(&self) -> bool {
        self.scale == 0.0 || self.power.total() == 0.0
    }

    /// A digest of the pixels, with scale and rotation.
    pub(super) fn identity(&self) -> String {
        let mut hasher = blake3::Hasher::new();
        hasher.update(&(self.width as u64).to_le_bytes());
        self.pixels.iter().flat_map(|p| p.to_array()).for_each(|x| {
            hasher.update(&x.to_le_bytes());
        });
        format!("map {} * {} turned by {} degrees", hasher.finalize().to_hex(), self.scale, self.rotation_degrees)
    }

    /// A direction of the world in the coordinates of the map.
    fn in_map(&self, d: DVec3) -> DVec3 {
        let DVec2 { x: cosine, y: sine } = self.rotation;
        DVec3::new(d.x * cosine - d.z * sine, d.y, d.x * sine + d.z * cosine)
    }

    /// A direction of the map in the coordinates of the world.
    fn in_world(&self, d: DVec3) -> DVec3 {
        let DVec2 { x: cosine, y: sine } = self.rotation;
        DVec3::new(d.x * cosine + d.z * sine, d.y, d.z * cosine - d.x * sine)
    }

    /// Column and row of the pixel in a unit direction of the map.
    fn pixel(&self, d: DVec3) -> [usize; 2] {
        let across = d.z.atan2(d.x) / TAU + 0.5;
        let down = DVec2::new(d.x, d.z).length().atan2(d.y) / PI;
        let index = |share: f64, count: usize| ((share * count as f64) as usize).min(count - 1);
        [index(across, self.width), index(down, self.height)]
    }

    /// The direction of the map to the point `cell.xi` of a pixel: uniform numbers make it uniform in solid angle.
    fn direction(&self, cell: &Cell) -> DVec3 {
        let across = (cell.column as f64 + cell.xi[0]) / self.width as f64;
        let [high, low] = [cell.row, cell.row + 1].map(|row| half_angle(row, self.height).sin().powi(2));
        // 1 - cos θ = 2 sin²(θ/2) keeps its digits at the pole.
        let height = 2.0 * (high + (low - high) * cell.xi[1]);
        let radius = (height * (2.0 - height)).max(0.0).sqrt();
        let (sine, cosine) = (TAU * (across - 0.5)).sin_cos();
        DVec3::new(radius * cosine, 1.0 - height, radius * sine).normalize()
    }

    /// The light of the tiles that the surface faces, W/m².
    pub fn importance(&self, at: &SurfacePoint) -> f64 {
        self.cosine_importance.facing(self.in_map(at.normal)).total() * self.scale
    }

    /// A tile is chosen by its light and cosine, a pixel in it by its light, and a uniform direction in the pixel:
    /// `E = L (n·ω) Ω/P` with the pixel's solid angle and probability.
    // note: [irradiance]
    pub fn illuminate(&self, at: &SurfacePoint, xi: [f64; 2]) -> Option<Illumination> {
        let tiles = self.cosine_importance.facing(self.in_map(at.normal));
        if tiles.total() == 0.0 {
            return None;
        }
        let cell = self.power.choose_below(self.tile_level(), tiles.choose(xi));
        let direction = self.in_world(self.direction(&cell));
        let cosine = at.normal.dot(direction);
        let radiance = self.pixel_radiance([cell.column, cell.row]);
        let solid_angle = solid_angle(self.width, self.height, cell.row);
        let factor = cosine * solid_angle / cell.probability;
        let density = || cell.probability / solid_angle;
        (cosine > 0.0).then(|| Illumination::distant(direction, radiance * factor, density()))
    }

    /// `P/Ω` of the pixel in this direction.
    pub fn pdf_solid_angle(&self, at: &SurfacePoint, direction: DVec3) -> f64 {
        let tiles = self.cosine_importance.facing(self.in_map(at.normal));
        let ([column, row], level) = (self.pixel(self.in_map(direction)), self.tile_level());
        let tile = tiles.probability(tiles.top(), column >> level, row >> level);
        tile * self.power.probability(level, column, row) / solid_angle(self.width, self.height, row)
    }

    /// The level of `power` whose cells are the tiles.
    fn tile_level(&self) -> usize {
        self.power.level_within(TILE_COLUMNS, TILE_ROWS)
    }
}

/// Half of the polar angle of the border above a row.
fn half_angle(row: usize, height: usize) -> f64 {
    0.5 * PI * row as f64 / height as f64
}

/// Solid angle of each pixel of a row, sr: the difference of the borders' cosines, times the width.
fn solid_angle(width: usize, height: usize, row: usize) -> f64 {
    let (high, low) = (half_angle(row, height), half_angle(row + 1, height));
    2.0 * (high + low).sin() * (low - high).sin() * TAU / width as f64
}

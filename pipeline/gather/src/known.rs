//! Light that is known before a path is traced: the light below the point that the ray through a pixel's center meets,
//! and below the one that is mirrored there. It is found when it is first asked for, and is the same whoever asks.

use crate::path_state::Way;
use scene::{DVec3, SurfacePoint};
use std::sync::OnceLock;

/// Side of the square tiles in which pixels are kept.
const TILE: usize = 8;

/// A center counts for a point if it lies off the point's tangent plane by at most this share of their distance, and if
/// the cosine of the angle between their normals exceeds this.
const OFF_PLANE: f64 = 0.5;
const LEAST_COSINE: f64 = 0.5;

/// The light below the centers of pixels, as far as it has been asked for.
pub struct Known {
    size: [usize; 2],
    tiles: Vec<OnceLock<Box<[Pixel; TILE * TILE]>>>,
}

/// What a pixel's center sees, by [`Way`].
type Pixel = [OnceLock<Option<Box<Center>>>; 2];

/// A point that is seen, and the light below.
pub struct Center {
    pub position: DVec3,
    pub normal: DVec3,
    pub material: u16,
    /// Radiance, W/(m² sr), over the factor of the exit lobe.
    pub light: DVec3,
}

impl Known {
    /// Nothing is known of an image of this size yet.
    pub fn new(size: [usize; 2]) -> Known {
        let [columns, rows] = size.map(|side| side.div_ceil(TILE));
        Known { size, tiles: (0..columns * rows).map(|_| OnceLock::new()).collect() }
    }

    /// What the center of a pixel sees; `look` finds it the first time.
    pub fn center(&self, [x, y]: [usize; 2], way: Way, look: impl FnOnce() -> Option<Center>) -> Option<&Center> {
        let tile = &self.tiles[y / TILE * self.size[0].div_ceil(TILE) + x / TILE];
        let pixels = tile.get_or_init(|| Box::new(std::array::from_fn(|_| Pixel::default())));
        pixels[y % TILE * TILE + x % TILE][way as usize].get_or_init(|| look().map(Box::new)).as_deref()
    }
}

impl Center {
    /// Whether it is on the surface near a point.
    pub fn is_near(&self, point: &SurfacePoint) -> bool {
        let offset = self.position - point.position;
        offset.dot(point.geometric_normal).abs() <= OFF_PLANE * offset.length()
            && self.normal.dot(point.geometric_normal) > LEAST_COSINE
    }
}

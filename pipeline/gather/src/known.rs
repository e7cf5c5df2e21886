//! Light that is known before a path is traced: the light below the point that the ray through a pixel's center meets,
//! and below the one that is mirrored there. It is gathered when it is first asked for, and is the same whoever asks, for
//! any part of the image and any number of paths.

use crate::{
    path_state::{Layer, PathIndex, PathLight, ThreadContext, Way},
    renderer::{Renderer, TranslucentObject},
};
use bsdf::View;
use glam::DVec2;
use scene::{DVec3, Hit, SurfacePoint};
use std::sync::OnceLock;

/// Side of the square tiles in which pixels are kept.
const TILE: usize = 8;

/// The relative error of a gather.
const ACCURACY: f64 = 0.03;

/// The numbers of the paths through a pixel's center.
const CENTER: u32 = u32::MAX - 3;

/// A center counts for a point if it lies off the point's tangent plane by at most this share of their distance, and if
/// the cosine of the angle between their normals exceeds this.
const OFF_PLANE: f64 = 0.5;
const LEAST_COSINE: f64 = 0.5;

/// A point on the outside of a translucent object, as a ray meets it.
pub struct Glimpse<'a> {
    pub object: &'a TranslucentObject<'a>,
    pub hit: Hit,
    pub point: SurfacePoint,
    pub view: View,
}

/// The light below the centers of pixels, as far as it has been asked for.
pub struct Known {
    size: [usize; 2],
    tiles: Vec<OnceLock<Box<[Pixel; TILE * TILE]>>>,
}

/// What a pixel's center sees, by [`Way`].
type Pixel = [OnceLock<Option<Box<Center>>>; 2];

/// A point that is seen, and the light below.
struct Center {
    position: DVec3,
    normal: DVec3,
    material: u16,
    /// Radiance, W/(m² sr), over the factor of the exit lobe.
    light: DVec3,
}

impl Known {
    /// Nothing is known of an image of this size yet.
    pub fn new(size: [usize; 2]) -> Known {
        let [columns, rows] = size.map(|side| side.div_ceil(TILE));
        Known { size, tiles: (0..columns * rows).map(|_| OnceLock::new()).collect() }
    }

    /// What the center of a pixel sees; `look` finds it the first time.
    fn center(&self, [x, y]: [usize; 2], way: Way, look: impl FnOnce() -> Option<Center>) -> Option<&Center> {
        let tile = &self.tiles[y / TILE * self.size[0].div_ceil(TILE) + x / TILE];
        let pixels = tile.get_or_init(|| Box::new(std::array::from_fn(|_| Pixel::default())));
        pixels[y % TILE * TILE + x % TILE][way as usize].get_or_init(|| look().map(Box::new)).as_deref()
    }
}

impl Center {
    /// Whether it is on the surface near a point.
    fn is_near(&self, point: &SurfacePoint) -> bool {
        let offset = self.position - point.position;
        offset.dot(point.geometric_normal).abs() <= OFF_PLANE * offset.length()
            && self.normal.dot(point.geometric_normal) > LEAST_COSINE
    }
}

impl Renderer<'_> {
    /// Radiance that is expected to leave a point which is seen at `first`, or mirrored there, W/(m² sr): that of what the
    /// centers of the four pixels around `first` see in the same way on the surface near the point, or else on any of its
    /// material; zero if they see none. Whatever it is, paths that are corrected by it have the same mean.
    pub fn known_light(&self, first: DVec3, way: Way, glimpse: &Glimpse, context: &mut ThreadContext) -> DVec3 {
        let Glimpse { object, point, view, .. } = glimpse;
        let place = self.input.camera.project(first + self.input.scene.origin, self.settings.size());
        let Some(place) = place.filter(|_| !object.is_dark()) else {
            return DVec3::ZERO;
        };
        let upper_left = (place - 0.5).floor();
        // The sums over the centers that are near the point, and over all others.
        let mut sums = [(DVec3::ZERO, 0.0); 2];
        for [x, y] in [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [1.0, 1.0]] {
            let pixel = upper_left + DVec2::new(x, y);
            let weight = (1.0 - (place - 0.5 - pixel).abs()).element_product();
            let is_inside = pixel.cmpge(DVec2::ZERO).all() && pixel.cmplt(self.settings.size()).all();
            if !is_inside || weight <= 0.0 {
                continue;
            }
            let at = [pixel.x as usize, pixel.y as usize];
            let center = self.known.center(at, way, || self.look_through(at, way, context));
            if let Some(center) = center.filter(|center| center.material == point.material) {
                let (light, weights) = &mut sums[usize::from(!center.is_near(point))];
                *light += weight * center.light;
                *weights += weight;
            }
        }
        let known = sums.into_iter().find(|(_, weights)| *weights > 0.0);
        known.map_or(DVec3::ZERO, |(light, weights)| light / weights * object.factor(point, view))
    }

    /// What the ray through the center of a pixel meets, or mirrors, and the light below.
    fn look_through(&self, [x, y]: [usize; 2], way: Way, context: &mut ThreadContext) -> Option<Center> {
        let (origin, direction) = self.camera_ray(DVec2::new(x as f64 + 0.5, y as f64 + 0.5), None);
        let [direct, mirrored] = self.seen(origin, direction, &mut context.counts);
        let (glimpse, _) = if way == Way::Direct { direct } else { mirrored }?;
        let Glimpse { object, hit, point, view } = &glimpse;
        let pixel = (y * self.settings.width + x) as u64;
        let path = CENTER + 2 * way as u32 + (pixel % 2) as u32;
        let index = PathIndex { pixel, path, edge: false, walks: None, near: None, surface: None };
        let mut state = self.begin(index, origin, direction);
        state.accuracy = Some(ACCURACY);
        // The shard is one of all, whatever paths are planned.
        let start = state.uniform();
        state.shard_pick = self.drawn.pick_shard(state.half, 0, 1, || start);
        let mut light = PathLight::default();
        self.gather(&state, object, (point, hit), view, &mut light, context);
        let (below, factor) = (light.layers[Layer::Subsurface as usize], object.factor(point, view));
        let over = |x: f64, factor: f64| if factor > 0.0 { x / factor } else { 0.0 };
        let light = DVec3::new(over(below.x, factor.x), over(below.y, factor.y), over(below.z, factor.z));
        Some(Center { position: point.position, normal: point.geometric_normal, material: point.material, light })
    }
}

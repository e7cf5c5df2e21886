//! What a ray sees of the light that is scattered below surfaces without a gather of its own: where, which share of it
//! arrives, and how bright it is as far as that is known. Paths in edge pixels are corrected by it.

use crate::{
    counts::Counts,
    edge,
    known::Center,
    meeting::Meeting,
    path_state::{Layer, PathIndex, PathLight, ThreadContext, Way},
    renderer::{Renderer, TranslucentObject},
};
use bsdf::{Bsdf, Lobe, Side, Surface, View};
use glam::DVec2;
use scene::{DVec3, Hit, SurfacePoint};

/// The relative error of a gather.
const ACCURACY: f64 = 0.03;

/// The numbers of the paths through a pixel's center.
const CENTER: u32 = u32::MAX - 3;

/// A point on the outside of a translucent object, as a ray meets it.
pub struct Glimpse<'a> {
    pub object: &'a TranslucentObject<'a>,
    pub hit: Hit,
    pub point: SurfacePoint,
    pub view: View,
}

impl Renderer<'_> {
    /// Replaces what is known of a path in an edge pixel by its mean over rays through the pixel, by the numbers of each
    /// for its place and for that on the lens.
    pub(crate) fn control(
        &self,
        at: [usize; 2],
        light: &mut PathLight,
        rays: impl Iterator<Item = [f64; 4]>,
        context: &mut ThreadContext,
    ) {
        let (corner, mut means) = (DVec2::new(at[0] as f64, at[1] as f64), [DVec3::ZERO; 2]);
        for [x, y, u, v] in rays {
            let (origin, direction) =
                self.camera_ray(corner + DVec2::new(x, y), self.input.camera.lens.map(|_| [u, v]));
            let seen = self.seen(origin, direction, &mut context.counts);
            let Some(first) = seen[0].as_ref().map(|(direct, _)| direct.point.position) else { continue };
            for ((mean, seen), way) in means.iter_mut().zip(&seen).zip([Way::Direct, Way::Mirrored]) {
                if let Some((glimpse, share)) = seen {
                    *mean += share / f64::from(edge::RAYS) * self.known_light(first, way, glimpse, context);
                }
            }
        }
        for ((mean, known), layer) in means.into_iter().zip(light.known).zip(edge::LAYER_OF) {
            light.layers[layer as usize] += mean - known;
            light.halves.iter_mut().for_each(|half| *half += mean - known);
        }
    }

    /// What a ray sees of the light that is scattered below surfaces, by [`Way`]: where, and the expected share of that
    /// light which a path sees.
    pub fn seen(&self, origin: DVec3, direction: DVec3, counts: &mut Counts) -> [Option<(Glimpse<'_>, f64)>; 2] {
        counts.edge_rays += 1;
        let Some(direct) = self.glimpse(origin, direction, None) else {
            return [None, None];
        };
        // What the path's other branch does is nothing that a ray counts.
        let ignored = &mut Counts::default();
        let surface = direct.object.surface(self.input.scene, &direct.hit);
        let meeting = Meeting::new(&direct.point, surface, Side::Outside, -direction, ignored);
        let (transmittance, mirrors) = (meeting.transmittance(), 1.0 - meeting.transmittance());
        let splits = meeting.bsdf.is_specular() && transmittance > 0.0 && mirrors > 0.0;
        let mut mirrored = || {
            let direction = meeting.sample(Lobe::Reflection, || [0.0; 2], ignored)?.direction;
            counts.edge_rays += 1;
            let glimpse = self.glimpse(direct.point.position, direction, Some(direct.point.triangle))?;
            let surface = glimpse.object.surface(self.input.scene, &glimpse.hit);
            let meeting = Meeting::new(&glimpse.point, surface, Side::Outside, -direction, ignored);
            let share = mirrors * meeting.transmittance();
            Some((glimpse, share))
        };
        let mirrored = if splits && self.settings.max_depth > 1 { mirrored() } else { None };
        [Some((direct, transmittance)), mirrored]
    }

    /// The outside of a translucent object, if that is what a ray meets first.
    pub(crate) fn glimpse(&self, origin: DVec3, direction: DVec3, from: Option<u32>) -> Option<Glimpse<'_>> {
        let hit = self.input.rays.closest(origin, direction, from)?;
        let point = self.input.scene.mesh.point(hit.triangle, hit.weights, self.settings.normals);
        let object = self.objects[point.material as usize].as_ref()?;
        if direction.dot(point.geometric_normal) >= 0.0 {
            return None;
        }
        let point = point.facing(-direction);
        let view =
            Meeting::new(&point, Surface::dielectric(1.0), Side::Outside, -direction, &mut Counts::default()).view;
        Some(Glimpse { object, hit, point, view })
    }

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

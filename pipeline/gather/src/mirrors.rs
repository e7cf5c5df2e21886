//! Looks for highlights (docs/method.md 18.8): sends light to surfaces that mirror, and on to rough ones, and one more ray
//! of each path to where it arrived from. The density of its direction is known, so that the mean stays what it is.

use crate::{
    counts::Counts,
    highlights::{Highlight, Highlights},
    lobes::Lobes,
    meeting::Meeting,
    path_state::{Layer, PathLight, PathState},
    renderer::Renderer,
};
use bsdf::{Bsdf, Gloss, Lobe, SMOOTH_BELOW, Side, Surface, View};
use rayon::prelude::*;
use scene::{
    DVec3, GlossStated, Hit, SurfacePoint, Triangle,
    light::{LightChoice, Lit, ReceiverBounds, light_at},
    random::{Item, Stream},
    warp,
};

/// The largest slope scale `α` of a surface whose highlights are looked for: sampled lights show those of rougher ones.
const MIRROR: f64 = 0.1;

/// The fewest and the most tries to send light; between them an image has as many as pixels.
const TRIES: [u64; 2] = [1 << 12, 1 << 18];

/// Number of nodes in the list from which the lights of a mirroring point are picked.
const NODES: usize = 16;

/// A ray that looks for highlights uses the random numbers from this dimension on.
const LOOK: u64 = 1 << 33;

/// Dimensions of the numbers of a try: a place on the surface, a light and a direction towards it, and which are kept. Those
/// of the mirrored direction follow.
const PLACE: [u64; 2] = [1, 2];
const LIGHT: [u64; 3] = [3, 4, 5];
const KEPT: u64 = 6;
const MIRRORED: u64 = 8;

/// The highlights that some tries found, each with a uniform number that decides whether it is kept, and the tries' rays.
#[derive(Default)]
struct Sent {
    found: Vec<(Highlight, f64)>,
    counts: Counts,
}

impl Sent {
    fn and(mut self, next: Sent) -> Sent {
        self.found.extend(next.found);
        self.counts.add(&next.counts);
        self
    }
}

impl Renderer<'_> {
    /// The highlights that an image of so many pixels looks for, and counts of the rays that were sent to find them.
    pub(crate) fn find_highlights(&self, pixels: u64, stream: Stream) -> (Highlights, Counts) {
        let mesh = &self.input.scene.mesh;
        let mut areas = vec![0.0; self.objects.len()];
        let mirrors = || (0u32..).zip(&mesh.triangles).filter(|(_, triangle)| self.may_mirror(triangle.material));
        mirrors().for_each(|(k, triangle)| areas[triangle.material as usize] += mesh.area(k as usize));
        // Each material has as many tries as another: a floor would leave none to what stands on it.
        let mut share = 0.0;
        let share_so_far = |(k, triangle): (u32, &Triangle)| {
            let all = areas[triangle.material as usize];
            share += if all > 0.0 { mesh.area(k as usize) / all } else { 0.0 };
            (share, k)
        };
        let shares: Vec<(f64, u32)> = mirrors().map(share_so_far).collect();
        let all = shares.last().map_or(0.0, |(share, _)| *share);
        if all == 0.0 {
            return Default::default();
        }
        let tries = pixels.clamp(TRIES[0], TRIES[1]);
        let send = |mut sent: Sent, index: u64| {
            let item = stream.item(index);
            let at = (index as f64 + item.uniform(0)) / tries as f64 * all;
            let (_, triangle) = shares[shares.partition_point(|(sum, _)| *sum <= at).min(shares.len() - 1)];
            let area = areas[mesh.triangles[triangle as usize].material as usize];
            let found = self.send(triangle, area, item, &mut sent.counts);
            sent.found.extend(found.map(|found| (found, item.uniform(KEPT))));
            sent
        };
        let sent = (0..tries).into_par_iter().fold(Sent::default, send).reduce(Sent::default, Sent::and);
        (Highlights::bright(sent.found), sent.counts)
    }

    /// Whether a material may mirror like [`MIRROR`], by what it states.
    fn may_mirror(&self, material: u16) -> bool {
        let stated = self.input.scene.materials[material as usize].gloss.as_ref();
        let may_be_smooth = |gloss: &GlossStated| gloss.texture.is_some() || gloss.roughness.powi(2) <= MIRROR;
        stated.map_or(self.objects[material as usize].is_some(), may_be_smooth)
    }

    /// The slope scale `α` of a surface where a ray meets it.
    fn slope_scale(&self, hit: &Hit) -> f64 {
        self.input.scene.roughness(hit.triangle, hit.weights).unwrap_or(0.0).powi(2)
    }

    /// What mirrors light at a surface; none if that scatters it in other ways, or is seen from within.
    fn mirror_at(&self, material: u16, side: Side, hit: &Hit) -> Option<Surface<'_>> {
        let scene = self.input.scene;
        match &self.objects[material as usize] {
            Some(object) => (side == Side::Outside).then(|| object.surface(scene, hit)),
            None if scene.is_pane(material) || scene.is_wall(material) => None,
            None => scene.gloss(hit.triangle, hit.weights).map(|stated| Surface::Gloss(Gloss::new(&stated))),
        }
    }

    /// Sends the light of a lamp or the environment by a point of a triangle, if that mirrors, to a rough surface. The point
    /// stands for an area, m².
    fn send(&self, triangle: u32, area: f64, item: Item, counts: &mut Counts) -> Option<Highlight> {
        let (scene, rays) = (self.input.scene, self.input.rays);
        let hit = Hit { triangle, weights: warp::triangle(PLACE.map(|d| item.uniform(d))), distance: 0.0 };
        if self.slope_scale(&hit) > MIRROR {
            return None;
        }
        let at = scene.mesh.point(triangle, hit.weights, self.settings.normals);
        let surface = self.mirror_at(at.material, Side::Outside, &hit)?;
        let choice = LightChoice::new(&self.lights, &ReceiverBounds::point(&at), NODES);
        let lit = light_at(&choice, rays, &at, LIGHT.map(|d| item.uniform(d)), &mut counts.shadow_rays);
        let Lit::Light { direction, irradiance } = lit else { return None };
        counts.rays += 1;
        let light = match rays.closest(at.position, direction, Some(triangle)) {
            None => self.lights.distant_radiance(at.position, direction),
            Some(lamp) => scene.emission(lamp.triangle, lamp.weights),
        };
        let view = View { normal: at.normal, direction, side: Side::Outside };
        let mut dimension = MIRRORED;
        let xi = || {
            dimension += 2;
            [dimension - 2, dimension - 1].map(|d| item.uniform(d))
        };
        let sample = surface.sample(&view, Lobe::Reflection, xi)?;
        let reflected = sample.weight * (1.0 - surface.transmittance(&view));
        let [power, radiance] = [irradiance * area, light].map(|light| (reflected * light).max_element());
        // No light is sent below the surface, nor that of lights without an image.
        if sample.direction.dot(at.geometric_normal) <= 0.0 || power <= 0.0 || radiance <= 0.0 {
            return None;
        }
        counts.rays += 1;
        let met = rays.closest(at.position, sample.direction, Some(triangle))?;
        let material = scene.mesh.triangles[met.triangle as usize].material;
        let is_rough =
            self.slope_scale(&met) >= SMOOTH_BELOW && self.mirror_at(material, Side::Outside, &met).is_some();
        let arrived = at.position + sample.direction * met.distance;
        is_rough.then_some(Highlight { at: arrived, mirror: at.position, power, radiance })
    }

    /// Adds the light of lamps and the environment that one more surface mirrors towards a rough one, in a direction of the
    /// lobes: the share of it that paths of the rough surface's own directions leave to this (balance heuristic).
    pub(crate) fn look_for_highlights(
        &self,
        lobes: &Lobes,
        state: &PathState,
        meeting: &Meeting,
        light: &mut PathLight,
        counts: &mut Counts,
    ) {
        let mut state = PathState { dimension: state.dimension + LOOK, light: None, mirrored: None, ..*state };
        let direction = lobes.sample([state.uniform(), state.uniform(), state.uniform()]);
        let (view, bsdf) = (&meeting.view, &meeting.bsdf);
        let cosine = view.normal.dot(direction);
        let value = bsdf.evaluate(view, direction);
        if cosine <= 0.0 || meeting.point.geometric_normal.dot(direction) <= 0.0 || value == DVec3::ZERO {
            return;
        }
        state.leave(meeting.point, direction, Layer::Specular);
        let densities = lobes.density(direction) + bsdf.density(view, direction);
        state.throughput *= value * (cosine / (densities * (1.0 - meeting.transmittance())));
        let Some((hit, point, side)) = self.meet(&state, counts) else { return };
        let Some(bsdf) = self.mirror_at(point.material, side, &hit) else { return };
        let mirror = Meeting::new(&point, bsdf, side, -direction, counts);
        state.throughput *= 1.0 - mirror.transmittance();
        if !self.reflect(&mut state, &mirror, light, counts) {
            return;
        }
        let Some((hit, point, side)) = self.meet(&state, counts) else {
            return self.escape(&state, light, counts);
        };
        let material = &self.input.scene.materials[point.material as usize];
        let shown = match &self.objects[point.material as usize] {
            None => f64::from(u8::from(side == Side::Outside || material.double_sided)),
            Some(_) if side == Side::Inside => 0.0,
            Some(object) => {
                let surface = object.surface(self.input.scene, &hit);
                Meeting::new(&point, surface, side, -state.direction, counts).transmittance()
            }
        };
        if material.emits() && shown > 0.0 {
            let emission = self.input.scene.emission(hit.triangle, hit.weights);
            light.add(&state, Layer::Emission, emission * (shown * self.share_of(&state, point.material)));
        }
    }

    /// What a ray in no medium meets: the point with its normals on the side of the ray, and that side.
    fn meet(&self, state: &PathState, counts: &mut Counts) -> Option<(Hit, SurfacePoint, Side)> {
        counts.rays += 1;
        let hit = self.input.rays.closest(state.origin, state.direction, state.from)?;
        let point = self.input.scene.mesh.point(hit.triangle, hit.weights, self.settings.normals);
        let side = if state.direction.dot(point.geometric_normal) < 0.0 { Side::Outside } else { Side::Inside };
        Some((hit, point.facing(-state.direction), side))
    }
}

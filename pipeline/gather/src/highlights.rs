//! Highlights: the images of lights in surfaces that mirror, as rough surfaces see them (docs/method.md 18.8).
//!
//! A path that a rough surface mirrors meets the image of a lamp in a nearby smooth surface by chance alone: rarely, and
//! then it is bright. Light is therefore sent to surfaces that mirror, and on to rough ones. Where it arrives, it tells
//! where such images are to be looked for. One more ray of each path looks for them, in directions whose density is
//! known, so that the mean stays what it is.

use crate::{
    counts::Counts,
    lobes::{self, Lobes},
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

/// The least and the largest angle within which half of the directions of a lobe lie, radians.
const NARROWEST: f64 = 0.02;
const WIDEST: f64 = 0.25;

/// A ray that looks for highlights uses the random numbers from this dimension on.
const LOOK: u64 = 1 << 33;

/// Dimensions of the numbers of a try: a place on the surface, a light and a direction towards it, and which are kept. Those
/// of the mirrored direction follow.
const PLACE: [u64; 2] = [1, 2];
const LIGHT: [u64; 3] = [3, 4, 5];
const KEPT: u64 = 6;
const MIRRORED: u64 = 8;

/// Light that a surface mirrored to a rough one.
#[derive(Clone, Copy, Debug)]
struct Highlight {
    /// Where it arrived, m.
    at: DVec3,
    /// Where it was mirrored, m.
    mirror: DVec3,
    /// In proportion to its flux.
    power: f64,
    /// The radiance of the image, W/(m² sr), of the brightest channel.
    radiance: f64,
}

/// The highlights of a scene, in the order of a tree: the halves of a node lie on either side of a plane.
#[derive(Debug, Default)]
pub struct Highlights {
    found: Vec<Highlight>,
    /// A heap: node `i` has the children `2i + 1` and `2i + 2`. Points whose coordinate of this index is below this value
    /// belong to the first.
    splits: Vec<(usize, f64)>,
}

impl Highlights {
    /// Those that an image of so many pixels looks for. Bright ones are kept: paths meet dim ones often enough.
    pub fn find(renderer: &Renderer, pixels: u64, stream: Stream) -> Highlights {
        let mesh = &renderer.input.scene.mesh;
        let mut areas = vec![0.0; renderer.objects.len()];
        let mirrors = || (0u32..).zip(&mesh.triangles).filter(|(_, triangle)| renderer.may_mirror(triangle.material));
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
            return Highlights::default();
        }
        let tries = pixels.clamp(TRIES[0], TRIES[1]);
        let send = |index: u64| {
            let item = stream.item(index);
            let at = (index as f64 + item.uniform(0)) / tries as f64 * all;
            let (_, triangle) = shares[shares.partition_point(|(sum, _)| *sum <= at).min(shares.len() - 1)];
            let area = areas[mesh.triangles[triangle as usize].material as usize];
            renderer.send(triangle, area, item).map(|found| (found, item.uniform(KEPT)))
        };
        let found: Vec<(Highlight, f64)> = (0..tries).into_par_iter().filter_map(send).collect();
        let sum = |of: &dyn Fn(&Highlight) -> f64| found.iter().map(|(highlight, _)| of(highlight)).sum::<f64>();
        let bright = sum(&|h| h.power * h.radiance) / sum(&|h| h.power);
        let kept = found.into_iter().filter(|(highlight, xi)| highlight.radiance > bright * xi);
        Highlights::new(kept.map(|(highlight, _)| highlight).collect())
    }

    fn new(mut found: Vec<Highlight>) -> Highlights {
        let leaves = found.len().div_ceil(lobes::MOST).next_power_of_two();
        let mut splits = vec![(0, 0.0); 2 * leaves];
        split(&mut found, &mut splits, 0);
        Highlights { found, splits }
    }

    /// The highlights whose light arrived around a point.
    fn around(&self, position: DVec3) -> &[Highlight] {
        let (mut around, mut node) = (&self.found[..], 0);
        while around.len() > lobes::MOST {
            let (axis, value) = self.splits[node];
            let (one, two) = around.split_at(around.len() / 2);
            (around, node) = if position[axis] < value { (one, 2 * node + 1) } else { (two, 2 * node + 2) };
        }
        around
    }

    /// The directions in which a rough surface that is seen so may see highlights, each as likely as its light is seen; none
    /// if there are none. Images move by no more than the point, in front of convex mirrors by less.
    pub fn lobes(&self, at: DVec3, bsdf: &Surface, view: &View) -> Option<Lobes> {
        let mut lobes = Lobes::default();
        for highlight in self.around(at) {
            let (axis, distance) = ((highlight.mirror - at).normalize_or_zero(), highlight.mirror.distance(at));
            let width = 0.5 * at.distance(highlight.at) / distance;
            if width < WIDEST {
                let weight = highlight.power * bsdf.evaluate(view, axis).max_element();
                lobes.add(axis, width.max(NARROWEST), weight);
            }
        }
        (!lobes.is_empty()).then_some(lobes)
    }
}

/// Splits highlights at the median of the longest side of their box, and the halves alike, down to as many as a mixture
/// has lobes.
fn split(found: &mut [Highlight], splits: &mut [(usize, f64)], node: usize) {
    if found.len() <= lobes::MOST {
        return;
    }
    let start = (DVec3::INFINITY, DVec3::NEG_INFINITY);
    let (low, high) = found.iter().fold(start, |(low, high), h| (low.min(h.at), high.max(h.at)));
    let axis = (high - low).max_position();
    let half = found.len() / 2;
    found.sort_by(|a, b| a.at[axis].total_cmp(&b.at[axis]));
    splits[node] = (axis, found[half].at[axis]);
    let (one, two) = found.split_at_mut(half);
    split(one, splits, 2 * node + 1);
    split(two, splits, 2 * node + 2);
}

impl Renderer<'_> {
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
    fn send(&self, triangle: u32, area: f64, item: Item) -> Option<Highlight> {
        let (scene, rays) = (self.input.scene, self.input.rays);
        let hit = Hit { triangle, weights: warp::triangle(PLACE.map(|d| item.uniform(d))), distance: 0.0 };
        if self.slope_scale(&hit) > MIRROR {
            return None;
        }
        let at = scene.mesh.point(triangle, hit.weights, self.settings.normals);
        let surface = self.mirror_at(at.material, Side::Outside, &hit)?;
        let choice = LightChoice::new(&self.lights, &ReceiverBounds::point(&at), NODES);
        let lit = light_at(&choice, rays, &at, LIGHT.map(|d| item.uniform(d)), &mut 0);
        let Lit::Light { direction, irradiance } = lit else { return None };
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

#[cfg(test)]
mod tests {
    use super::*;
    use scene::random::Purpose;

    /// Every highlight is among those around the place where its light arrived, which are never more than a mixture holds.
    ///
    /// Seen to catch: the children of a node changed over; a split beside the median.
    #[test]
    fn highlights_are_found_where_their_light_arrived() {
        let stream = Stream::new(3, Purpose::Highlight);
        for count in [0, 1, lobes::MOST, lobes::MOST + 1, 1000, 4097] {
            let highlight = |k: usize| {
                let at = DVec3::from_array([0, 1, 2].map(|d| stream.item(k as u64).uniform(d)));
                Highlight { at, mirror: DVec3::splat(k as f64), power: 1.0, radiance: 1.0 }
            };
            let all: Vec<Highlight> = (0..count).map(highlight).collect();
            let highlights = Highlights::new(all.clone());
            for one in &all {
                let around = highlights.around(one.at);
                assert!(
                    around.len() <= lobes::MOST && around.iter().any(|h| h.mirror == one.mirror),
                    "{count}: {one:?}"
                );
            }
        }
    }
}

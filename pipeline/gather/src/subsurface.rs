//! The light that leaves a translucent surface scattered: what a camera path gathers from the cloud.

use crate::{
    path_state::{Layer, PathLight, PathState, ThreadContext},
    renderer::{Renderer, Scattering, TranslucentObject},
};
use bsdf::View;
use calibration::Site;
use near_field::{Numbers, Place};
use scene::{DVec3, Hit, SurfacePoint, random::Item};
use sums::{estimator::Estimator, samples::Exit};

/// The largest relative error that is asked of one sum. Above it, the cut does not predict its own error.
const MAX_ERROR: f64 = 0.5;

/// Dimensions of a path's numbers from which those of its later exitant points are taken, each of so many.
const LATER: u64 = 1 << 32;
const NUMBERS: u64 = 8;

/// The dimensions from which on the numbers of a surface of two media are taken.
const OF_MEDIA: u64 = 1 << 40;

impl TranslucentObject<'_> {
    /// The factor of the light that leaves at a point for the eye's `view`: the exit lobe or, if the object is calibrated, the
    /// factor of its surface.
    pub(crate) fn factor(&self, point: &SurfacePoint, view: &View) -> DVec3 {
        match &self.factors {
            None => self.exit_lobe(view.normal.dot(view.direction)),
            Some(factors) => {
                let site = Site { position: point.position, normal: point.geometric_normal };
                let factor = factors.at(&site, view.direction);
                let [smooth, tilted] = [point.geometric_normal, view.normal].map(|normal| normal.dot(view.direction));
                // Only normal maps turn the lobe: interpolated normals are fitted by the factors.
                if point.normal == point.smooth_normal { factor } else { factor * factors.turned_lobe(smooth, tilted) }
            }
        }
    }

    /// Where the model is evaluated for the light that leaves at a point for the eye's `view`, m.
    fn evaluated_at(&self, point: &SurfacePoint, view: &View) -> DVec3 {
        let site = Site { position: point.position, normal: point.geometric_normal };
        let offset = self.factors.as_ref().map_or(DVec3::ZERO, |factors| factors.offset(&site, view.direction));
        point.position + offset
    }
}

impl Renderer<'_> {
    /// `note: [reflectance]` Adds `L_r` at an exitant point: the mean over all drawn samples (docs/method.md 6.7), or
    /// over those of the half and shard that this path gathers from. `view` is that of the eye, by whose angle the
    /// exit lobe of the model varies.
    pub(crate) fn gather(
        &self,
        state: &PathState,
        object: &TranslucentObject,
        (point, hit): (&SurfacePoint, &Hit),
        view: &View,
        light: &mut PathLight,
        context: &mut ThreadContext,
    ) {
        if object.is_dark() {
            return;
        }
        if let Some(walks) = &object.walks {
            return self.walk(state, (walks, object.rough.as_ref()), point, view.normal, light, context);
        }
        let position = object.evaluated_at(point, view);
        // The model knows no bumps of normal maps.
        let faces = point.smooth_normal.dot(view.direction) > 0.0;
        let normal = if faces { point.smooth_normal } else { point.geometric_normal };
        let factor = object.factor(point, view);
        let shares = object.shares(self.input.scene, hit);
        context.counts.gathers += 1;
        for (k, (part, share)) in object.parts.iter().zip(shares).enumerate().filter(|(_, (_, share))| *share > 0.0) {
            let place = Place { surface: *point, position, normal, crossing: DVec3::ONE };
            self.gather_part(state, (part, k as u64), (place, hit), factor * share, light, context);
        }
    }

    /// The same of one part of the light, times a factor.
    fn gather_part(
        &self,
        state: &PathState,
        (part, index): (&Scattering, u64),
        (mut place, hit): (Place, &Hit),
        mut factor: DVec3,
        light: &mut PathLight,
        context: &mut ThreadContext,
    ) {
        if let Some(tint) = &part.tint {
            let color = &self.input.scene.texture_color(hit.triangle, hit.weights);
            place.crossing = tint.entering(color);
            factor *= tint.leaving(color);
        }
        let nearby = self.nearby(state, part, &place, context);
        let besides = 0.5 * (nearby[0] + nearby[1]);
        let exit = |half: usize| {
            let key = state.key.bits(OF_MEDIA * (index % 2) + 2 * state.dimension + half as u64);
            Exit::new(place.position, place.normal, key).besides(besides)
        };
        let estimator = match state.accuracy {
            None => self.estimator_for(state.throughput.max_element()),
            Some(accuracy) => self.settings.estimator.map_accuracy(|_| accuracy),
        };
        let scratch = &mut context.scratch[place.surface.material as usize];
        let mut leaving = if self.gathers_by_shard() {
            part.summation.by_shard(estimator, state.half, state.shard_pick, exit, scratch)
        } else {
            part.summation.whole(estimator, exit, scratch)
        };
        leaving.radiance += besides;
        leaving.halves.iter_mut().zip(nearby).for_each(|(half, nearby)| *half += nearby);
        leaving.radiance *= factor;
        leaving.halves.iter_mut().for_each(|half| *half *= factor);
        context.counts.evaluations += leaving.evaluations;
        context.counts.nodes += leaving.nodes;
        light.add_halves(state, Layer::Subsurface, leaving.radiance, leaving.halves);
    }

    /// The light that enters near an exitant point and is not left to the samples (docs/method.md section 17): one
    /// estimate for each half of the cloud, or the same for both if paths alternate between the halves.
    fn nearby(&self, state: &PathState, part: &Scattering, at: &Place, context: &mut ThreadContext) -> [DVec3; 2] {
        let random =
            |k: usize, half: u64| state.near_points.uniform(LATER + NUMBERS * (2 * state.dimension + half) + k as u64);
        let share = state.throughput.max_element();
        let first = state.near.map_or_else(|| std::array::from_fn(|k| random(k, 0)), |near| near.numbers());
        let one = self.nearby_once(part, (at, share), &first, state.near_points, context);
        if self.gathers_by_shard() {
            return [one; 2];
        }
        let second = std::array::from_fn(|k| random(k, 1));
        [one, self.nearby_once(part, (at, share), &second, state.key, context)]
    }

    /// The same at a point of the surface, with the random numbers of an item.
    pub(crate) fn nearby_at(
        &self,
        part: &Scattering,
        point: &SurfacePoint,
        item: Item,
        context: &mut ThreadContext,
    ) -> DVec3 {
        let numbers = std::array::from_fn(|k| item.uniform(LATER + k as u64));
        let at = Place { surface: *point, position: point.position, normal: point.smooth_normal, crossing: DVec3::ONE };
        self.nearby_once(part, (&at, 1.0), &numbers, item, context)
    }

    fn nearby_once(
        &self,
        part: &Scattering,
        (at, share): (&Place, f64),
        numbers: &Numbers,
        random: Item,
        context: &mut ThreadContext,
    ) -> DVec3 {
        let (Some(near), Some(surroundings)) = (&part.near, &self.surroundings) else {
            return DVec3::ZERO;
        };
        near.light(surroundings, (at, share), numbers, random, &mut context.near)
    }

    /// Whether each path of a pixel gathers from one half of one shard, round-robin, instead of from all samples.
    fn gathers_by_shard(&self) -> bool {
        self.settings.estimator.is_hierarchical() && self.paths_per_pixel > 1.0
    }

    /// The estimator of one sum, of whose light a `share` arrives at the camera. The errors of a pixel's sums are
    /// independent, so the relative error of each may be as many times the pixel's as the root of their number.
    pub fn estimator_for(&self, share: f64) -> Estimator {
        let sums = if self.gathers_by_shard() { self.paths_per_pixel } else { 2.0 * self.drawn.shards() as f64 };
        let of_sum = |accuracy: f64| rounded(accuracy * sums.sqrt());
        self.settings.estimator.map_accuracy(|accuracy| (of_sum(accuracy) / share.max(1e-3)).min(MAX_ERROR))
    }
}

/// An accuracy without its last digits, so that it is the same for any number of paths whose pixels were given the
/// accuracy that goes with their number: an image that is continued takes the same nodes.
fn rounded(accuracy: f64) -> f64 {
    const UNIT: f64 = (1u64 << 40) as f64;
    (accuracy * UNIT).round().max(1.0) / UNIT
}

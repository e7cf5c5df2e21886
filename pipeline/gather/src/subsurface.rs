//! The light that leaves a translucent surface scattered: sums over the halves of a cloud.

use crate::{
    estimator::{Cut, Estimator, Exhaustive, Roulette, Scratch, Sum},
    path_light::{Layer, PathLight},
    path_state::{PathState, ThreadContext},
    renderer::{Method, Renderer, TranslucentObject},
    samples::Exit,
    shards::ShardPick,
};
use bssrdf::{lanes::LaneModel, simd};
use scene::{DVec3, SurfacePoint};

/// A gather is never asked for more than this: beyond, the cut's prediction of its own error means nothing.
const LOOSEST: f64 = 0.5;

impl<M: LaneModel> Renderer<'_, M> {
    /// note: [reflectance] `L_r` at an exitant point: the mean over all drawn samples (method.md 6.7), or over those of
    /// the path's half of the cloud whose turn it is.
    pub(crate) fn gather(
        &self,
        state: &PathState,
        object: &TranslucentObject<M>,
        point: &SurfacePoint,
        normal: DVec3,
        light: &mut PathLight,
        context: &mut ThreadContext,
    ) {
        if object.is_dark() {
            return;
        }
        context.counts.gathers += 1;
        let drawn = [0, 1].map(|half| self.drawn.half(half));
        let mut of_half = |half: usize, part: Option<usize>| {
            let key = state.key.bits(2 * state.dimension + half as u64);
            let exit = Exit::new(point.position, normal, key);
            let share = state.throughput.max_element();
            let scratch = context.scratch(point.material as usize);
            let sum = match part {
                Some(part) => self.sum(object, half, part, &exit, share, scratch),
                None => self.whole(object, half, &exit, share, scratch),
            };
            context.counts.evaluations += sum.evaluations;
            context.counts.nodes += sum.nodes;
            sum.radiance
        };
        // The second half is empty if one sample was drawn.
        let half = if drawn[1] == 0 { 0 } else { state.half };
        if self.alternates() {
            let ShardPick { part, weight } = state.turn;
            let value = weight * of_half(half, Some(part)) / self.drawn.part(half, part).max(1) as f64;
            light.add_halves(state, Layer::Subsurface, value, [value; 2]);
        } else {
            let sums = [of_half(0, None), of_half(1, None)];
            let value = (sums[0] + sums[1]) / (drawn[0] + drawn[1]) as f64;
            let means = [0, 1].map(|k| if drawn[1] == 0 { value } else { sums[k] / drawn[k] as f64 });
            light.add_halves(state, Layer::Subsurface, value, means);
        }
    }

    /// Whether the paths of a pixel gather from the halves of the clouds in turn, instead of each from all of them.
    fn alternates(&self) -> bool {
        matches!(self.estimator, Estimator::Cut { .. }) && self.paths_per_pixel > 1
    }

    /// The accuracy of one sum of which the `share` arrives at the camera: so many sums make a pixel.
    pub fn accuracy(&self, share: f64) -> f64 {
        match self.estimator {
            Estimator::Cut { accuracy } => {
                let sums =
                    if self.alternates() { f64::from(self.paths_per_pixel) } else { 2.0 * self.drawn.clouds() as f64 };
                (accuracy * sums.sqrt() / share.max(1e-3)).min(LOOSEST)
            }
            Estimator::Exhaustive | Estimator::Roulette(_) => 0.0,
        }
    }

    /// The sum over one half of the samples of `object` in all clouds, each with random numbers of its own.
    fn whole(&self, object: &TranslucentObject<M>, half: usize, exit: &Exit, share: f64, scratch: &mut Scratch) -> Sum {
        let of_part = |part: usize| self.sum(object, half, part, &exit.of_part(part), share, scratch);
        (0..object.parts.len()).map(of_part).fold(Sum::default(), Sum::plus)
    }

    /// The sum over one half of the samples of `object` in one cloud.
    pub fn sum(
        &self,
        object: &TranslucentObject<M>,
        half: usize,
        part: usize,
        exit: &Exit,
        share: f64,
        scratch: &mut Scratch,
    ) -> Sum {
        let (model, samples) = (&object.model, &object.parts[part][half]);
        if samples.is_empty() {
            return Sum::default();
        }
        match &object.method {
            Method::Exhaustive => simd::dispatch(Exhaustive { model, samples, exit }),
            Method::Roulette(rates) => simd::dispatch(Roulette { model, samples, exit, rates: *rates }),
            Method::Cut(tables) => {
                let (accuracy, calibration) = (self.accuracy(share) as f32, &object.calibration);
                simd::dispatch(Cut { model, samples, tables, exit, accuracy, calibration, scratch })
            }
        }
    }
}

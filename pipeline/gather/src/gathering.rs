//! The light that leaves a translucent surface scattered: sums over the halves of a cloud.

use crate::{
    clouds::Turn,
    estimator::{Calibration, Cut, Estimator, Exhaustive, Radial, Rates, Roulette, Scratch, Sum},
    film::Layer,
    path::{PathLight, Renderer, Walker, Worker},
    samples::{Exit, LitSamples},
};
use bssrdf::{Medium, lanes::LaneModel, simd};
use scene::{DVec3, SurfacePoint};

/// A translucent material with its medium and its samples.
pub struct Body<'a, M> {
    pub medium: Medium,
    pub model: M,
    /// `σ̃_t` of light that is not scattered, 1/m.
    pub unscattered: [f64; 3],
    pub method: Method,
    /// What the accuracy asked of the cut is multiplied by, see [`crate::calibration`].
    pub calibration: Calibration,
    /// The two independent halves of each cloud.
    pub parts: Vec<[LitSamples<'a>; 2]>,
}

impl<M> Body<'_, M> {
    /// Nothing leaves it scattered.
    pub fn is_dark(&self) -> bool {
        self.medium.is_clear() || self.parts.iter().flatten().all(|samples| samples.is_empty())
    }
}

/// How the samples of a body are summed.
pub enum Method {
    Exhaustive,
    Roulette(Rates),
    Cut(Radial),
}

/// A gather is never asked for more than this: beyond, the cut's prediction of its own error means nothing.
const LOOSEST: f64 = 0.5;

impl<M: LaneModel> Renderer<'_, M> {
    /// note: [reflectance] `L_r` at an exitant point: the mean over all drawn samples (method.md 6.7), or over those of
    /// the path's half of the cloud whose turn it is.
    pub(crate) fn gather(
        &self,
        walker: &Walker,
        body: &Body<M>,
        point: &SurfacePoint,
        normal: DVec3,
        light: &mut PathLight,
        worker: &mut Worker,
    ) {
        if body.is_dark() {
            return;
        }
        worker.counts.gathers += 1;
        let drawn = [0, 1].map(|half| self.drawn.half(half));
        let mut of_half = |half: usize, part: Option<usize>| {
            let key = walker.key.bits(2 * walker.dimension + half as u64);
            let exit = Exit::new(point.position, normal, key);
            let share = walker.throughput.max_element();
            let scratch = &mut worker.scratch[point.material as usize];
            let sum = match part {
                Some(part) => self.sum(body, half, part, &exit, share, scratch),
                None => self.whole(body, half, &exit, share, scratch),
            };
            worker.counts.evaluations += sum.evaluations;
            worker.counts.nodes += sum.nodes;
            sum.radiance
        };
        // The second half is empty if one sample was drawn.
        let half = if drawn[1] == 0 { 0 } else { walker.half };
        if self.alternates() {
            let Turn { part, weight } = walker.turn;
            let value = weight * of_half(half, Some(part)) / self.drawn.part(half, part).max(1) as f64;
            light.add_halves(walker, Layer::Subsurface, value, [value; 2]);
        } else {
            let sums = [of_half(0, None), of_half(1, None)];
            let value = (sums[0] + sums[1]) / (drawn[0] + drawn[1]) as f64;
            let means = [0, 1].map(|k| if drawn[1] == 0 { value } else { sums[k] / drawn[k] as f64 });
            light.add_halves(walker, Layer::Subsurface, value, means);
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

    /// The sum over one half of the samples of `body` in all clouds, each with random numbers of its own.
    fn whole(&self, body: &Body<M>, half: usize, exit: &Exit, share: f64, scratch: &mut Scratch) -> Sum {
        let of_part = |part: usize| self.sum(body, half, part, &exit.of_part(part), share, scratch);
        (0..body.parts.len()).map(of_part).fold(Sum::default(), Sum::plus)
    }

    /// The sum over one half of the samples of `body` in one cloud.
    pub fn sum(&self, body: &Body<M>, half: usize, part: usize, exit: &Exit, share: f64, scratch: &mut Scratch) -> Sum {
        let (model, samples) = (&body.model, &body.parts[part][half]);
        if samples.is_empty() {
            return Sum::default();
        }
        match &body.method {
            Method::Exhaustive => simd::dispatch(Exhaustive { model, samples, exit }),
            Method::Roulette(rates) => simd::dispatch(Roulette { model, samples, exit, rates: *rates }),
            Method::Cut(radial) => {
                let (accuracy, calibration) = (self.accuracy(share) as f32, &body.calibration);
                simd::dispatch(Cut { model, samples, radial, exit, accuracy, calibration, scratch })
            }
        }
    }
}

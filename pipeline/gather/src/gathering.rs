//! The light that leaves a translucent surface scattered: sums over the halves of a cloud.

use crate::{
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
    /// The two independent halves of the cloud.
    pub halves: [LitSamples<'a>; 2],
}

impl<M> Body<'_, M> {
    /// Nothing leaves it scattered.
    pub fn is_dark(&self) -> bool {
        self.medium.is_clear() || self.halves.iter().all(|h| h.is_empty())
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
    /// the path's half of the cloud.
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
        let drawn = self.samples_drawn;
        let mean = |half: usize, sum: &Sum| sum.radiance / drawn[half].max(1) as f64;
        let mut of_half = |half: usize| {
            let key = walker.key.bits(2 * walker.dimension + half as u64);
            let exit = Exit::new(point.position, normal, key);
            let share = walker.throughput.max_element();
            let sum = self.sum(body, half, &exit, share, &mut worker.scratch[point.material as usize]);
            worker.counts.evaluations += sum.evaluations;
            worker.counts.nodes += sum.nodes;
            sum
        };
        // The second half is empty if one sample was drawn.
        let half = if drawn[1] == 0 { 0 } else { walker.half };
        if drawn[1] == 0 || self.alternates() {
            let value = mean(half, &of_half(half));
            light.add_halves(walker, Layer::Subsurface, value, [value; 2]);
        } else {
            let sums = [of_half(0), of_half(1)];
            let value = (sums[0].radiance + sums[1].radiance) / (drawn[0] + drawn[1]) as f64;
            light.add_halves(walker, Layer::Subsurface, value, [mean(0, &sums[0]), mean(1, &sums[1])]);
        }
    }

    /// Whether the paths of a pixel gather from the halves of the cloud in turn, instead of each from both.
    fn alternates(&self) -> bool {
        matches!(self.estimator, Estimator::Cut { .. }) && self.paths_per_pixel > 1
    }

    /// The accuracy of one sum of which the `share` arrives at the camera: so many sums make a pixel.
    pub fn accuracy(&self, share: f64) -> f64 {
        match self.estimator {
            Estimator::Cut { accuracy } => {
                let sums = f64::from(self.paths_per_pixel.max(2));
                (accuracy * sums.sqrt() / share.max(1e-3)).min(LOOSEST)
            }
            Estimator::Exhaustive | Estimator::Roulette(_) => 0.0,
        }
    }

    /// The sum over one half of the samples of `body`.
    pub fn sum(&self, body: &Body<M>, half: usize, exit: &Exit, share: f64, scratch: &mut Scratch) -> Sum {
        let (model, samples) = (&body.model, &body.halves[half]);
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

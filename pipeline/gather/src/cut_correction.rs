//! Corrects the cut's prediction for this camera and these media: its true error is measured at a few points of the
//! image before the image is rendered, so that it meets the target.

use crate::{path_state::ThreadContext, renderer::Renderer};
use glam::DVec2;
use rayon::prelude::*;
use scene::{
    DVec3, SurfacePoint,
    random::{Purpose, Stream},
    sequence::Sequence,
};
use sums::{
    estimator::{CutCorrection, Sum},
    samples::Exit,
};

/// Points for each material, and the camera rays that are traced to find them.
const POINTS: usize = 128;
const RAYS: u32 = 8192;

/// The points are grouped by the predicted sum; each group has a factor.
const GROUPS: usize = 8;

/// Number of sums at each point in a round, each with its own random numbers.
const REPLICATES: u64 = 2;
const ROUNDS: u64 = 3;

/// Points darker than this share of the brightest one are left out.
const DARKEST: f64 = 1e-6;

/// The range of the factors. With the smallest one the cut evaluates every sample, at hardly more than the cost of the
/// whole sum.
const RANGE: (f64, f64) = (0.01, 8.0);

/// Measures the correction of each object.
pub fn correct(renderer: &mut Renderer) {
    if renderer.settings.reference || renderer.estimator_for(1.0).accuracy().is_none() {
        return;
    }
    let stream = Stream::new(renderer.settings.seed, Purpose::CutCorrection);
    let points = points(renderer, stream);
    for (material, points) in points.iter().enumerate() {
        let parts = renderer.objects[material].as_ref().map_or(0, |object| object.parts.len());
        for part in 0..parts {
            let mut measured = Vec::new();
            for round in 0..ROUNDS {
                measured.extend(measure(renderer, (material, part), points, stream, round));
                if let Some(object) = &mut renderer.objects[material] {
                    object.parts[part].summation.correction = fit(&measured);
                }
            }
        }
    }
}

/// The factors with which the measured errors would have met their targets.
fn fit(measured: &[Measured]) -> CutCorrection {
    let brightest = measured.iter().fold(0.0f64, |max, m| max.max(m.mean));
    let mut counted: Vec<&Measured> = measured
        .iter()
        .filter(|m| m.mean > DARKEST * brightest && m.predicted > 0.0 && m.predicted.is_finite())
        .collect();
    counted.sort_by(|a, b| a.predicted.total_cmp(&b.predicted));
    let factors = counted.chunks(counted.len().div_ceil(GROUPS).max(1)).map(|group| {
        let n = group.len() as f64;
        let excess = (group.iter().map(|m| m.excess).sum::<f64>() / n).sqrt();
        let predicted = (group.iter().map(|m| m.predicted.ln()).sum::<f64>() / n).exp();
        (predicted, (1.0 / excess).clamp(RANGE.0, RANGE.1))
    });
    CutCorrection::new(&factors.collect::<Vec<_>>())
}

/// For each material, points that the camera sees.
fn points(renderer: &Renderer, stream: Stream) -> Vec<Vec<SurfacePoint>> {
    let (input, size) = (&renderer.input, renderer.settings.size());
    let mut points = vec![Vec::new(); renderer.objects.len()];
    let spread = Sequence::new(stream.item(0), stream);
    let mut missing = renderer.objects.iter().flatten().count() * POINTS;
    for index in 0..RAYS {
        if missing == 0 {
            break;
        }
        let [x, y, u, v] = spread.point(index);
        let (origin, direction) = renderer.camera_ray(DVec2::new(x, y) * size, input.camera.lens.map(|_| [u, v]));
        let Some(hit) = input.rays.closest(origin, direction, None) else {
            continue;
        };
        let point = input.scene.mesh.point(hit.triangle, hit.weights, renderer.settings.normals);
        let own: &mut Vec<_> = &mut points[point.material as usize];
        let is_translucent = renderer.objects[point.material as usize].is_some();
        if is_translucent && own.len() < POINTS && point.normal.dot(direction) < 0.0 {
            own.push(point);
            missing -= 1;
        }
    }
    points
}

/// The sums at one point in one round.
struct Measured {
    /// Length of the mean color, W/(m² sr).
    mean: f64,
    /// The sum over channels that the cut predicts, W/(m² sr).
    predicted: f64,
    /// Relative variance of one sum over the square of its target error.
    excess: f64,
}

/// Sums at each point of one part of the light of a material; none if it is opaque.
fn measure(
    renderer: &Renderer,
    (material, part): (usize, usize),
    points: &[SurfacePoint],
    stream: Stream,
    round: u64,
) -> Vec<Measured> {
    let estimator = renderer.estimator_for(1.0);
    let (Some(object), Some(accuracy)) = (&renderer.objects[material], estimator.accuracy()) else {
        return Vec::new();
    };
    let part = &object.parts[part];
    let summation = &part.summation;
    let at = |(index, point): (usize, &SurfacePoint)| {
        let mut context = ThreadContext::new(renderer.objects.len());
        let item = stream.item(1 + (material * POINTS + index) as u64);
        let nearby = renderer.nearby_at(part, point, item, &mut context);
        let sum = |replicate: u64| {
            let exit = Exit::new(point.position, point.smooth_normal, item.bits(round * REPLICATES + replicate));
            let exit = exit.besides(nearby);
            let (half, shard) = (index % 2, index / 2 % summation.shards());
            summation.sum(estimator, half, shard, &exit, &mut context.scratch[material])
        };
        let sums: Vec<Sum> = (0..REPLICATES).map(sum).collect();
        let (mean, variance) = moments(&sums, nearby);
        let predicted = sums[0].predicted;
        let target = accuracy * f64::from(summation.correction.factor(predicted));
        Measured { mean, predicted, excess: variance / (mean * target).powi(2) }
    };
    points.par_iter().enumerate().map(at).collect()
}

/// Length of the mean color with the light that leaves besides, and the variance of one sum.
fn moments(sums: &[Sum], besides: DVec3) -> (f64, f64) {
    let n = sums.len() as f64;
    let mean = sums.iter().map(|s| s.radiance).sum::<DVec3>() / n;
    (
        (mean + besides.max(DVec3::ZERO)).length(),
        sums.iter().map(|s| s.radiance.distance_squared(mean)).sum::<f64>() / (n - 1.0),
    )
}

//! How good the cut's prediction of its own error is, for this camera and medium: measured at a few points of the image
//! before it is rendered, so that the error asked for is the error that comes.

use crate::{
    estimator::{Calibration, Estimator, Sum},
    path_state::ThreadContext,
    renderer::{Renderer, TranslucentObject},
    samples::Exit,
};
use bssrdf::lanes::LaneModel;
use glam::DVec2;
use rayon::prelude::*;
use scene::{
    DVec3,
    random::{Purpose, Stream},
    sequence::Sequence,
};

/// Points for each medium, and the camera rays that look for them.
const POINTS: usize = 128;
const RAYS: u32 = 8192;

/// The points in groups by the sum that is predicted at them: each group has a factor.
const GROUPS: usize = 8;

/// Sums at each point in a round, with random numbers of their own.
const REPLICATES: u64 = 2;
const ROUNDS: u64 = 3;

/// A point darker than this share of the brightest does not count.
const DARKEST: f64 = 1e-6;

/// The factors stay within these. With the smallest every sample is summed, which costs hardly more than to do so at once.
const RANGE: (f64, f64) = (0.01, 8.0);

/// Sets the factors of each object by which the accuracy asked of its sums is multiplied. `size` is the image's, pixels.
pub fn calibrate<M: LaneModel>(renderer: &mut Renderer<M>, size: DVec2, seed: u64) {
    let Estimator::Cut { .. } = renderer.estimator else {
        return;
    };
    let stream = Stream::new(seed, Purpose::Calibration);
    let points = points(renderer, size, stream);
    for (material, points) in points.iter().enumerate() {
        let mut measured = Vec::new();
        for round in 0..ROUNDS {
            if let Some(object) = &renderer.objects[material] {
                measured.extend(measure(renderer, object, material, points, stream, round));
            }
            if let Some(object) = &mut renderer.objects[material] {
                object.calibration = fit(&measured);
            }
        }
    }
}

/// The factors that would have made the error met the one asked for.
fn fit(measured: &[Measured]) -> Calibration {
    let brightest = measured.iter().fold(0.0f64, |most, m| most.max(m.mean));
    let mut counted: Vec<&Measured> = measured
        .iter()
        .filter(|m| m.mean > DARKEST * brightest && m.predicted > 0.0 && m.predicted.is_finite())
        .collect();
    counted.sort_by(|a, b| a.predicted.total_cmp(&b.predicted));
    let known = counted.chunks(counted.len().div_ceil(GROUPS).max(1)).map(|group| {
        let n = group.len() as f64;
        let worse = (group.iter().map(|m| m.worse).sum::<f64>() / n).sqrt();
        let predicted = (group.iter().map(|m| m.predicted.ln()).sum::<f64>() / n).exp();
        (predicted, (1.0 / worse).clamp(RANGE.0, RANGE.1))
    });
    Calibration::new(&known.collect::<Vec<_>>())
}

/// Points of each material that the camera sees, with the normals there.
fn points<M: LaneModel>(renderer: &Renderer<M>, size: DVec2, stream: Stream) -> Vec<Vec<(DVec3, DVec3)>> {
    let mut points = vec![Vec::new(); renderer.objects.len()];
    let spread = Sequence::new(stream.item(0), stream);
    for index in 0..RAYS {
        let [x, y, ..] = spread.point(index);
        let (origin, direction) = renderer.camera.ray(DVec2::new(x, y) * size, size);
        let Some(hit) = renderer.rays.closest(origin - renderer.scene.origin, direction, None) else {
            continue;
        };
        let point = renderer.scene.mesh.point(hit.triangle, hit.weights, renderer.normals);
        let own: &mut Vec<_> = &mut points[point.material as usize];
        if own.len() < POINTS && point.normal.dot(direction) < 0.0 {
            own.push((point.position, point.normal));
        }
    }
    points
}

/// What the sums at one point were in one round.
struct Measured {
    /// Length of the mean color, and what the cut predicts of it.
    mean: f64,
    predicted: f64,
    /// Relative variance of one sum over the square of the accuracy that was asked of it.
    worse: f64,
}

/// At each point.
fn measure<M: LaneModel>(
    renderer: &Renderer<M>,
    object: &TranslucentObject<M>,
    material: usize,
    points: &[(DVec3, DVec3)],
    stream: Stream,
    round: u64,
) -> Vec<Measured> {
    let at = |(index, (position, normal)): (usize, &(DVec3, DVec3))| {
        let mut context = ThreadContext::new(renderer.objects.len());
        let item = stream.item(1 + (material * POINTS + index) as u64);
        let sum = |replicate: u64| {
            let exit = Exit::new(*position, *normal, item.bits(round * REPLICATES + replicate));
            renderer.sum(object, index % 2, index / 2 % object.parts.len(), &exit, 1.0, context.scratch(material))
        };
        let sums: Vec<Sum> = (0..REPLICATES).map(sum).collect();
        let (mean, variance) = moments(&sums);
        let predicted = sums[0].predicted;
        let asked = renderer.accuracy(1.0) * f64::from(object.calibration.factor(predicted));
        Measured { mean, predicted, worse: variance / (mean * asked).powi(2) }
    };
    points.par_iter().enumerate().map(at).collect()
}

/// Length of the mean color, and the variance of one.
fn moments(sums: &[Sum]) -> (f64, f64) {
    let n = sums.len() as f64;
    let mean = sums.iter().map(|s| s.radiance).sum::<DVec3>() / n;
    (mean.length(), sums.iter().map(|s| s.radiance.distance_squared(mean)).sum::<f64>() / (n - 1.0))
}

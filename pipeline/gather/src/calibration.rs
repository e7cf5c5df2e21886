//! How good the cut's prediction of its own error is, for this camera and medium: measured at a few points of the image
//! before it is rendered, so that the error asked for is the error that comes.

use crate::{
    estimator::Estimator,
    path::{Renderer, Worker},
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
const POINTS: usize = 64;
const RAYS: u32 = 4096;

/// Sums at each point, with random numbers of their own.
const REPLICATES: u64 = 4;
const ROUNDS: u64 = 3;

/// A point darker than this share of the brightest does not count.
const DARKEST: f64 = 1e-6;

/// The factor stays within these.
const RANGE: (f64, f64) = (0.3, 10.0);

/// Sets the factor of each body by which the accuracy asked of its sums is multiplied. `size` is the image's, pixels.
pub fn calibrate<M: LaneModel>(renderer: &mut Renderer<M>, size: DVec2, seed: u64) {
    let Estimator::Cut { .. } = renderer.estimator else {
        return;
    };
    let stream = Stream::new(seed, Purpose::Calibration);
    let points = points(renderer, size, stream);
    for material in 0..renderer.bodies.len() {
        for round in 0..ROUNDS {
            let factor = factor(renderer, material, &points[material], stream, round);
            if let Some(body) = &mut renderer.bodies[material] {
                body.calibration = (body.calibration * factor).clamp(RANGE.0, RANGE.1);
            }
        }
    }
}

/// Points of each material that the camera sees, with the normals there.
fn points<M: LaneModel>(renderer: &Renderer<M>, size: DVec2, stream: Stream) -> Vec<Vec<(DVec3, DVec3)>> {
    let mut points = vec![Vec::new(); renderer.bodies.len()];
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

/// The wanted error over the one that is met.
fn factor<M: LaneModel>(
    renderer: &Renderer<M>,
    material: usize,
    points: &[(DVec3, DVec3)],
    stream: Stream,
    round: u64,
) -> f64 {
    let Some(body) = &renderer.bodies[material] else {
        return 1.0;
    };
    let measure = |(index, (position, normal)): (usize, &(DVec3, DVec3))| {
        let mut worker = Worker::new(renderer.bodies.len());
        let item = stream.item(1 + (material * POINTS + index) as u64);
        let sum = |replicate: u64| {
            let exit = Exit::new(*position, *normal, item.bits(round * REPLICATES + replicate));
            renderer.sum(body, index % 2, &exit, 1.0, worker.scratch(material)).radiance
        };
        moments((0..REPLICATES).map(sum).collect())
    };
    let moments: Vec<(f64, f64)> = points.par_iter().enumerate().map(measure).collect();
    let brightest = moments.iter().fold(0.0f64, |most, (mean, _)| most.max(*mean));
    let counted: Vec<f64> =
        moments.iter().filter(|(mean, _)| *mean > DARKEST * brightest).map(|(mean, v)| v / (mean * mean)).collect();
    let met = (counted.iter().sum::<f64>() / counted.len().max(1) as f64).sqrt();
    let wanted = renderer.accuracy(1.0);
    if counted.is_empty() { 1.0 } else { wanted / met.max(0.1 * wanted) }
}

/// Length of the mean colour, and the variance of one.
fn moments(colors: Vec<DVec3>) -> (f64, f64) {
    let n = colors.len() as f64;
    let mean = colors.iter().sum::<DVec3>() / n;
    (mean.length(), colors.iter().map(|c| c.distance_squared(mean)).sum::<f64>() / (n - 1.0))
}

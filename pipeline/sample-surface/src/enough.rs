//! How many samples are enough: the error of the light that leaves the surface, by what the two halves of a cloud differ
//! by. The one place where phase one knows a medium; the samples themselves depend on their number alone.

use crate::{Numbers, Pattern, Place, Plan, SampleError, Sampled, Settings, sample};
use bssrdf::{
    Medium, Model,
    lanes::{DirectionalLanes, LaneModel},
    simd,
};
use glam::DVec3;
use rayon::prelude::*;
use scene::{Rays, Scene, SurfacePoint};
use sums::{
    estimator::{Calibration, Cut, Radial, Scratch},
    samples::{Exit, LitSamples},
};

/// An error to reach in a medium, by the directional dipole.
pub struct Goal<'a> {
    pub medium: &'a Medium,
    /// Root mean square error over root mean square, all channels, all of the surface.
    pub error: f64,
    /// Samples that there is memory for.
    pub most: u64,
}

/// Points that the error is measured at.
const POINTS: u64 = 1024;

/// Samples of the first attempt.
const FIRST: u64 = 1 << 16;

/// The error of well-spread samples falls at least as their number to the power 3/4.
const POWER: f64 = 4.0 / 3.0;

/// Draws clouds of more and more samples until one is good enough. Returns it with its error.
pub fn sample_enough(
    scene: &Scene,
    rays: &Rays,
    settings: &Settings,
    plan: &Plan,
    goal: &Goal,
    tell: impl Fn(u64, f64) + Sync,
) -> Result<(Sampled, f64), SampleError> {
    let mut samples = FIRST.min(goal.most);
    loop {
        let settings = Settings { samples, ..settings.clone() };
        let sampled = sample(scene, rays, &settings, plan, |_| ())?;
        let error = relative_error(scene, &sampled, &settings, plan, goal);
        tell(samples, error);
        if error <= goal.error {
            return Ok((sampled, error));
        }
        let growth = (error / goal.error).powf(POWER).clamp(1.5, 64.0);
        let next = (samples as f64 * growth).ceil() as u64;
        if next > goal.most {
            return Err(SampleError::TooMany { samples, error, next, most: goal.most });
        }
        samples = next;
    }
}

/// The relative standard error of the light that leaves the sampled surface.
pub fn relative_error(scene: &Scene, sampled: &Sampled, settings: &Settings, plan: &Plan, goal: &Goal) -> f64 {
    let model = DirectionalLanes::new(goal.medium);
    let radial = Radial::new(goal.medium, &*Model::DirectionalDipole.of(goal.medium), f64::INFINITY);
    let choice = plan.choice(scene, settings);
    // The points have nothing to do with the samples: another seed.
    let numbers = Numbers::new(Pattern::Stratified, !settings.seed(), POINTS);
    let places: Vec<Place> = numbers.places(&choice, 0..POINTS).map(|(_, place)| place).collect();
    let measure = |(index, place): (usize, &Place)| {
        let point = scene.mesh.point(place.triangle, place.weights, settings.normals);
        let sum = |half| radiance(sampled, half, &point, index as u64, (&model, &radial, goal));
        let [one, two] = [sum(0), sum(1)];
        // Points are not spread by area under the note's choice of triangles.
        let weight = 1.0 / place.pdf_area;
        (weight * (one - two).length_squared() / 4.0, weight * ((one + two) / 2.0).length_squared())
    };
    let measured: Vec<(f64, f64)> = places.par_iter().enumerate().map(measure).collect();
    let (variance, power) = measured.iter().fold((0.0, 0.0), |sum, m| (sum.0 + m.0, sum.1 + m.1));
    if power > 0.0 { (variance / power).sqrt() } else { 0.0 }
}

/// `L_r` at a point, as one half of the samples has it.
fn radiance(
    sampled: &Sampled,
    half: usize,
    point: &SurfacePoint,
    index: u64,
    (model, radial, goal): (&DirectionalLanes, &Radial, &Goal),
) -> DVec3 {
    let Some(material) = sampled.meta.materials.iter().find(|m| m.index == point.material) else {
        return DVec3::ZERO;
    };
    let group = &material.halves[half];
    if group.samples == 0 {
        return DVec3::ZERO;
    }
    let (tiles, nodes) = sampled.content.group(group);
    let samples = &LitSamples::of(tiles, nodes, group.samples as usize, goal.medium.eta);
    let exit = &Exit::new(point.position, point.normal, 2 * index + half as u64);
    // Less than the goal by so much that it does not show in the difference.
    let accuracy = (0.3 * goal.error) as f32;
    let (calibration, scratch) = (&Calibration::default(), &mut Scratch::default());
    let cut = Cut { model, samples, radial, exit, accuracy, calibration, scratch };
    simd::dispatch(cut).radiance / sampled.meta.drawn_by_half()[half].max(1) as f64
}

//! The light of a cloud that leaves the surface at points all over it, by the directional dipole.

use crate::{Numbers, Pattern, Plan, SamplePoint, Sampled, Settings};
use bssrdf::{
    Medium, Model,
    lanes::{DirectionalLanes, LaneModel},
    simd,
};
use glam::DVec3;
use rayon::prelude::*;
use scene::{Scene, SurfacePoint};
use sums::{
    estimator::{Calibration, Cut, FalloffTables, Scratch},
    samples::{Exit, LitSamples},
};

/// An error to reach in a medium, by the directional dipole.
pub struct Goal<'a> {
    pub medium: &'a Medium,
    /// Relative standard error: root mean square error over root mean square, all channels, all of the surface.
    pub error: f64,
    /// Samples that there is memory for.
    pub most: u64,
}

/// Points of the surface, as many from each area, that light is compared at.
pub(crate) struct Points<'a> {
    scene: &'a Scene,
    settings: &'a Settings,
    points: Vec<SamplePoint>,
}

impl<'a> Points<'a> {
    pub fn new(scene: &'a Scene, settings: &'a Settings, plan: &Plan, count: u64) -> Self {
        // The points have nothing to do with the samples: another seed.
        let numbers = Numbers::new(Pattern::Stratified, !settings.seed(), count);
        let points = numbers.points(&plan.choice(scene, settings), 0..count).map(|(_, point)| point).collect();
        Points { scene, settings, points }
    }

    /// `L_r` as one half of a cloud has it, all channels of all points, each times the root of the area that it stands
    /// for. `stream` tells the random numbers of the sums.
    pub fn light(&self, sampled: &Sampled, half: usize, stream: u64, goal: &Goal) -> Vec<f64> {
        let model = DirectionalLanes::new(goal.medium);
        let tables = FalloffTables::new(goal.medium, &*Model::DirectionalDipole.of(goal.medium), f64::INFINITY);
        let at = |(index, sample): (usize, &SamplePoint)| {
            let point = self.scene.mesh.point(sample.triangle, sample.weights, self.settings.normals);
            let key = 2 * (stream * self.points.len() as u64 + index as u64) + half as u64;
            let light = radiance(sampled, half, &point, key, (&model, &tables, goal));
            // Points are not spread by area under the note's choice of triangles.
            (light / sample.pdf_area.sqrt()).to_array()
        };
        self.points.par_iter().enumerate().flat_map_iter(at).collect()
    }
}

/// The relative standard error of the light that leaves the sampled surface; none if there is none.
pub(crate) fn relative_error(points: &Points, sampled: &Sampled, goal: &Goal) -> Option<f64> {
    let [one, two] = [0, 1].map(|half| points.light(sampled, half, 0, goal));
    let pairs = || one.iter().zip(&two);
    let variance: f64 = pairs().map(|(a, b)| (a - b) * (a - b) / 4.0).sum();
    let power: f64 = pairs().map(|(a, b)| (a + b) * (a + b) / 4.0).sum();
    (power > 0.0).then(|| (variance / power).sqrt())
}

/// `L_r` at a point, as one half of the samples has it.
fn radiance(
    sampled: &Sampled,
    half: usize,
    point: &SurfacePoint,
    key: u64,
    (model, tables, goal): (&DirectionalLanes, &FalloffTables, &Goal),
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
    let exit = &Exit::new(point.position, point.normal, key);
    // Less than the goal by so much that it does not show in the difference.
    let accuracy = (0.3 * goal.error) as f32;
    let (calibration, scratch) = (&Calibration::default(), &mut Scratch::default());
    let cut = Cut { model, samples, tables, exit, accuracy, calibration, scratch };
    simd::dispatch(cut).radiance / sampled.meta.drawn_by_half()[half].max(1) as f64
}

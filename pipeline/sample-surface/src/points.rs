//! The light of a cloud that leaves the surface at points all over it, by the half-space model.

use crate::{
    pattern::{Numbers, Pattern, SamplePoint},
    plan::{Plan, Settings},
    portions::Sampled,
};
use bssrdf::{Medium, Model};
use formats::cloud::SampledMaterial;
use glam::DVec3;
use rayon::prelude::*;
use scene::Scene;
use std::sync::Arc;
use sums::{
    Summation,
    drawn::DrawnCounts,
    estimator::{Estimator, Scatterer, Scratch},
    samples::{Exit, LitSamples},
};

/// A target error in a medium, by the half-space model.
pub struct Goal<'a> {
    pub medium: &'a Medium,
    /// Relative standard error: the root mean square error over the root mean square, of all channels and all of the
    /// surface.
    pub error: f64,
    /// The largest number of samples that fits in memory.
    pub max_samples: u64,
}

/// Points of the surface at which light is compared.
pub(crate) struct Points<'a> {
    scene: &'a Scene,
    settings: &'a Settings,
    points: Vec<SamplePoint>,
    scatterer: Arc<Scatterer>,
    estimator: Estimator,
}

impl<'a> Points<'a> {
    pub fn new(scene: &'a Scene, settings: &'a Settings, plan: &Plan, goal: &Goal, count: u64) -> Self {
        // Another seed makes the points independent of the samples.
        let numbers = Numbers::new(Pattern::Stratified, !settings.seed(), count);
        Points {
            scene,
            settings,
            points: numbers.points(&plan.choice(scene, settings), 0..count).map(|(_, point)| point).collect(),
            scatterer: Arc::new(Scatterer::new(Model::HalfSpace, goal.medium, f64::INFINITY)),
            // The error of the cut is so far below the target that it does not show in differences between clouds.
            estimator: Estimator::Cut { accuracy: 0.3 * goal.error },
        }
    }

    /// `L_r` at all points as one half of a cloud estimates it: three channels of each point, times the root of the
    /// area that the point represents. `stream` selects the random numbers of the sums.
    pub fn light(&self, sampled: &Sampled, half: usize, stream: u64) -> Vec<f64> {
        let materials = &sampled.meta.materials;
        let summations: Vec<Summation> = materials.iter().map(|material| self.summation(sampled, material)).collect();
        let at = |scratch: &mut Scratch, (index, sample): (usize, &SamplePoint)| {
            let point = self.scene.mesh.point(sample.triangle, sample.weights, self.settings.normals());
            let key = 2 * (stream * self.points.len() as u64 + index as u64) + half as u64;
            let exit = Exit::new(point.position, point.smooth_normal, key);
            let slot = materials.iter().position(|material| material.index == point.material);
            let light = slot.map_or(DVec3::ZERO, |slot| summations[slot].half(self.estimator, half, &exit, scratch));
            // With the note's choice of triangles, points do not represent equal areas.
            (light / sample.pdf_area.sqrt()).to_array()
        };
        self.points.par_iter().enumerate().map_init(Scratch::default, at).flatten_iter().collect()
    }

    fn summation<'s>(&self, sampled: &'s Sampled, material: &SampledMaterial) -> Summation<'s> {
        let halves = material.halves.map(|group| {
            let (tiles, nodes) = sampled.content.group(&group);
            LitSamples::of(tiles, nodes, group.samples as usize, self.scatterer.eta())
        });
        let drawn = DrawnCounts::new(vec![sampled.meta.drawn_by_half()]);
        Summation::new(self.scatterer.clone(), vec![halves], drawn)
    }
}

/// The relative standard error of the light that leaves the surface, by the difference of the cloud's halves; none if
/// no light leaves it.
pub(crate) fn relative_error(points: &Points, sampled: &Sampled) -> Option<f64> {
    let [one, two] = [0, 1].map(|half| points.light(sampled, half, 0));
    let pairs = || one.iter().zip(&two);
    let variance: f64 = pairs().map(|(a, b)| (a - b) * (a - b) / 4.0).sum();
    let power: f64 = pairs().map(|(a, b)| (a + b) * (a + b) / 4.0).sum();
    (power > 0.0).then(|| (variance / power).sqrt())
}

//! Sums over a cloud at any point, by any model and estimator: phase two without a camera.

use bssrdf::{
    Medium, Model,
    lanes::{BetterLanes, DirectionalLanes, LaneModel, StandardLanes},
    simd,
};
use formats::cloud::Cloud;
use gather::{
    estimator::{Calibration, Cut, Estimator, Exhaustive, FalloffTables, Roulette, Scratch, Sum},
    samples::{Exit, LitSamples},
};
use glam::DVec3;
use std::sync::OnceLock;

/// A medium under one model, ready for sums over samples.
pub struct Scatterer {
    model: Model,
    medium: Medium,
    /// Only the cut needs it.
    tables: OnceLock<FalloffTables>,
}

impl Scatterer {
    pub fn new(model: Model, medium: &Medium) -> Scatterer {
        Scatterer { model, medium: medium.clone(), tables: OnceLock::new() }
    }

    /// The tables that the cut decides by.
    pub fn tables(&self) -> &FalloffTables {
        self.tables.get_or_init(|| FalloffTables::new(&self.medium, &*self.model.of(&self.medium), f64::INFINITY))
    }

    /// The sum over samples, with the widest vectors there are.
    pub fn sum(&self, samples: &LitSamples, exit: &Exit, estimator: Estimator) -> Sum {
        match self.model {
            Model::DirectionalDipole => self.sum_with::<DirectionalLanes>(samples, exit, estimator),
            Model::BetterDipole => self.sum_with::<BetterLanes>(samples, exit, estimator),
            Model::StandardDipole => self.sum_with::<StandardLanes>(samples, exit, estimator),
        }
    }

    fn sum_with<M: LaneModel>(&self, samples: &LitSamples, exit: &Exit, estimator: Estimator) -> Sum {
        let model = &M::new(&self.medium);
        match estimator {
            Estimator::Exhaustive => simd::dispatch(Exhaustive { model, samples, exit }),
            Estimator::Roulette(rule) => {
                let rates = rule.rates(self.model.of(&self.medium).transport());
                simd::dispatch(Roulette { model, samples, exit, rates })
            }
            Estimator::Cut { accuracy } => {
                let (tables, accuracy, scratch) = (self.tables(), accuracy as f32, &mut Scratch::default());
                let calibration = &Calibration::default();
                simd::dispatch(Cut { model, samples, tables, exit, accuracy, calibration, scratch })
            }
        }
    }
}

/// A point that light leaves from.
#[derive(Clone, Copy, Debug)]
pub struct Point {
    /// World position, m.
    pub position: DVec3,
    pub normal: DVec3,
}

/// A cloud lit into a medium, ready for sums at any point of its first material.
pub struct Lit<'a> {
    scatterer: Scatterer,
    halves: [LitSamples<'a>; 2],
    drawn: [f64; 2],
    origin: DVec3,
}

impl<'a> Lit<'a> {
    pub fn new(cloud: &'a Cloud, medium: &Medium, model: Model) -> Lit<'a> {
        let meta = cloud.meta();
        Lit {
            scatterer: Scatterer::new(model, medium),
            halves: meta.materials[0].halves.map(|half| LitSamples::new(cloud, &half, medium.eta)),
            drawn: meta.drawn_by_half().map(|n| n as f64),
            origin: DVec3::from_array(meta.origin_m),
        }
    }

    /// The sum over one half of the cloud; `key` chooses the random numbers.
    pub fn sum(&self, half: usize, estimator: Estimator, point: Point, key: u64) -> Sum {
        let exit = Exit::new(point.position - self.origin, point.normal, key);
        self.scatterer.sum(&self.halves[half], &exit, estimator)
    }

    /// `L_r` at a point by one half of the cloud, W/(m² sr).
    pub fn half(&self, half: usize, estimator: Estimator, point: Point, key: u64) -> DVec3 {
        self.sum(half, estimator, point, key).radiance / self.drawn[half]
    }

    /// `L_r` at a point, W/(m² sr). The accuracy of a cut is that of both halves together, whose errors are independent.
    pub fn radiance(&self, estimator: Estimator, point: Point, key: u64) -> DVec3 {
        let of_half = match estimator {
            Estimator::Cut { accuracy } => Estimator::Cut { accuracy: accuracy * 2f64.sqrt() },
            other => other,
        };
        let keys = [key, key.rotate_left(32) ^ 0x9E37_79B9_7F4A_7C15];
        let sums = [0, 1].map(|half| self.sum(half, of_half, point, keys[half]).radiance);
        (sums[0] + sums[1]) / (self.drawn[0] + self.drawn[1])
    }

    /// The mean of `L_r` over points by the whole sum.
    pub fn mean(&self, points: &[Point]) -> DVec3 {
        let radiance = |p: &Point| self.radiance(Estimator::Exhaustive, *p, 0);
        points.iter().map(radiance).sum::<DVec3>() / points.len() as f64
    }
}

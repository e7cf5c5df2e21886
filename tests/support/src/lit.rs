//! Sums over a cloud at any point, by any model and estimator: phase two without a camera.

use bssrdf::{Medium, Model, Partition};
use formats::cloud::Cloud;
use gather::{
    Summation,
    estimator::{CutCorrection, Estimator, Scatterer, Scratch, Sum},
    samples::{Exit, LitSamples},
};
use glam::DVec3;
use std::{
    f64::consts::SQRT_2,
    sync::{Arc, LazyLock},
};

/// The sum over samples, without a correction.
pub fn sum(scatterer: &Scatterer, samples: &LitSamples, exit: &Exit, estimator: Estimator) -> Sum {
    static UNCORRECTED: LazyLock<CutCorrection> = LazyLock::new(CutCorrection::default);
    estimator.sum(scatterer, &UNCORRECTED, samples, exit, &mut Scratch::default())
}

/// A medium under a model, on a plane.
pub fn scatterer(model: Model, medium: &Medium) -> Scatterer {
    Scatterer::new(model, medium, f64::INFINITY)
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
    summation: Summation<'a>,
    origin: DVec3,
}

impl<'a> Lit<'a> {
    pub fn new(cloud: &'a Cloud, medium: &Medium, model: Model) -> Lit<'a> {
        Lit::far(cloud, medium, model, Partition::NONE)
    }

    /// The cloud with the far part of the model alone.
    pub fn far(cloud: &'a Cloud, medium: &Medium, model: Model, partition: Partition) -> Lit<'a> {
        let (clouds, scatterer) = (std::slice::from_ref(cloud), scatterer(model, medium).far(partition));
        let summation = Summation::of_clouds(Arc::new(scatterer), clouds, 0);
        Lit { summation, origin: DVec3::from_array(cloud.meta().origin_m) }
    }

    fn exit(&self, point: Point, key: u64) -> Exit {
        Exit::new(point.position - self.origin, point.normal, key)
    }

    /// The sum over one half of the cloud; `key` selects the random numbers.
    pub fn sum(&self, half: usize, estimator: Estimator, point: Point, key: u64) -> Sum {
        self.summation.sum(estimator, half, 0, &self.exit(point, key), &mut Scratch::default())
    }

    /// `L_r` at a point by one half of the cloud, W/(m² sr).
    pub fn half(&self, half: usize, estimator: Estimator, point: Point, key: u64) -> DVec3 {
        self.summation.half(estimator, half, &self.exit(point, key), &mut Scratch::default())
    }

    /// `L_r` at a point, W/(m² sr). The accuracy of a cut is that of both halves together, whose errors are
    /// independent.
    pub fn radiance(&self, estimator: Estimator, point: Point, key: u64) -> DVec3 {
        let keys = [key, key.rotate_left(32) ^ 0x9E37_79B9_7F4A_7C15];
        let estimator = estimator.map_accuracy(|accuracy| accuracy * SQRT_2);
        self.summation.whole(estimator, |half| self.exit(point, keys[half]), &mut Scratch::default()).radiance
    }

    /// The mean of `L_r` over points by the whole sum.
    pub fn mean(&self, points: &[Point]) -> DVec3 {
        let radiance = |p: &Point| self.radiance(Estimator::Exhaustive, *p, 0);
        points.iter().map(radiance).sum::<DVec3>() / points.len() as f64
    }
}

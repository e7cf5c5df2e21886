//! Both phases as functions: a scene to a cloud, a cloud to radiance at a point.

use crate::meshes::World;
use bssrdf::{
    Medium, Model,
    lanes::{BetterLanes, DirectionalLanes, LaneModel, StandardLanes},
    simd,
};
use formats::{
    atomic::Output,
    cloud::{self, Cloud, Options},
};
use gather::{
    Filter,
    estimator::{Estimator, Exhaustive, Roulette, Rule, Sum},
    samples::{Exit, LitSamples},
};
use glam::DVec3;
use sample_surface::{Choice, Plan, Sampled, Settings};
use scene::{Camera, NormalKind, Projection};
use std::path::Path;

/// How phase one samples in a test.
#[derive(Clone, Copy, Debug)]
pub struct Sampling {
    pub samples: u64,
    pub choice: Choice,
    pub seed: u64,
}

/// Independent samples by area.
pub fn by_area(samples: u64, seed: u64) -> Sampling {
    Sampling { samples, choice: Choice::Area, seed }
}

/// Phase one in memory.
pub fn sampled(world: &World, sampling: &Sampling) -> Sampled {
    sampled_with(world, sampling, NormalKind::Geometric)
}

/// Phase one in memory, with these normals.
pub fn sampled_with(world: &World, sampling: &Sampling, normals: NormalKind) -> Sampled {
    let settings = Settings {
        samples: sampling.samples,
        choice: sampling.choice,
        normals,
        translucent: Vec::new(),
        options: Options {
            seed: sampling.seed,
            choice: sampling.choice.name().into(),
            pattern: "independent".into(),
            normals: if normals == NormalKind::Geometric { "geometric" } else { "shading" }.into(),
            metres_per_unit: 1.0,
            light_unit: "radiometric".into(),
            environment: [0.0; 3],
        },
    };
    let plan = Plan::new(&world.scene, &settings).expect("the scene has light and a surface");
    sample_surface::sample(&world.scene, &world.rays, &settings, &plan, |_| ()).expect("every flux is finite")
}

/// Writes what phase one made.
pub fn write(sampled: &Sampled, path: &Path) {
    let mut output = Output::create(path).expect("the temporary folder is writable");
    cloud::write(&mut output, path, &sampled.samples, &sampled.meta).expect("the temporary folder is writable");
    output.commit().expect("the temporary folder is writable");
}

/// Phase one to a file and back.
pub fn cloud(world: &World, sampling: &Sampling) -> Cloud {
    filed(&sampled(world, sampling))
}

/// What phase one made, to a file and back.
pub fn filed(sampled: &Sampled) -> Cloud {
    let folder = tempfile::tempdir().expect("the temporary folder is writable");
    let path = folder.path().join("test.cloud");
    write(sampled, &path);
    Cloud::open(&path).expect("the cloud was written whole")
}

/// A cloud lit into a medium, ready for sums at any point of its first material.
pub struct Lit {
    model: Model,
    medium: Medium,
    samples: LitSamples,
    drawn: f64,
    origin: DVec3,
}

/// A point that light leaves from.
#[derive(Clone, Copy, Debug)]
pub struct Point {
    /// World position, m.
    pub position: DVec3,
    pub normal: DVec3,
}

impl Lit {
    pub fn new(cloud: &Cloud, medium: &Medium, model: Model) -> Lit {
        let meta = cloud.meta();
        let first = &meta.materials[0];
        Lit {
            model,
            medium: medium.clone(),
            samples: LitSamples::new(cloud.samples(first.first, first.count), medium.eta),
            drawn: meta.samples_drawn as f64,
            origin: DVec3::from_array(meta.origin_m),
        }
    }

    /// `L_r` at a point, W/(m² sr); `key` chooses the roulette's random numbers.
    pub fn radiance(&self, estimator: Estimator, point: Point, key: u64) -> DVec3 {
        let exit = Exit::new(point.position - self.origin, point.normal, key);
        sum(self.model, &self.medium, &self.samples, &exit, estimator).radiance / self.drawn
    }

    /// The mean of `L_r` over points by the whole sum.
    pub fn mean(&self, points: &[Point]) -> DVec3 {
        let radiance = |p: &Point| self.radiance(Estimator::Exhaustive, *p, 0);
        points.iter().map(radiance).sum::<DVec3>() / points.len() as f64
    }
}

/// The sum over samples by any model and estimator, with the widest vectors there are.
pub fn sum(model: Model, medium: &Medium, samples: &LitSamples, exit: &Exit, estimator: Estimator) -> Sum {
    let transport = model.of(medium).transport();
    match model {
        Model::DirectionalDipole => sum_with::<DirectionalLanes>(medium, transport, samples, exit, estimator),
        Model::BetterDipole => sum_with::<BetterLanes>(medium, transport, samples, exit, estimator),
        Model::StandardDipole => sum_with::<StandardLanes>(medium, transport, samples, exit, estimator),
    }
}

fn sum_with<M: LaneModel>(
    medium: &Medium,
    transport: [f64; 3],
    samples: &LitSamples,
    exit: &Exit,
    estimator: Estimator,
) -> Sum {
    let model = &M::new(medium);
    match estimator {
        Estimator::Exhaustive => simd::dispatch(Exhaustive { model, samples, exit }),
        Estimator::Roulette(rule) => simd::dispatch(Roulette { model, samples, exit, rates: rule.rates(transport) }),
    }
}

/// A camera that looks from the direction `towards` at the origin.
pub fn orthographic(towards: DVec3, half_height: f64) -> Camera {
    let forward = -towards.normalize();
    let right = forward.any_orthonormal_vector();
    Camera {
        name: "test".into(),
        node: "test".into(),
        position: -10.0 * forward,
        right,
        up: right.cross(forward),
        forward,
        projection: Projection::Orthographic { half_height },
        aspect: None,
    }
}

/// One path through the centre of each pixel, the whole sum, and nothing but the cloud's light.
pub fn settings(model: Model, width: usize, height: usize) -> gather::Settings {
    gather::Settings {
        width,
        height,
        paths_per_pixel: 1,
        filter: Filter::Point,
        estimator: Estimator::Exhaustive,
        model,
        normals: NormalKind::Geometric,
        environment: DVec3::ZERO,
        max_depth: 16,
        seed: 1,
    }
}

/// All three models.
pub const MODELS: [Model; 3] = [Model::DirectionalDipole, Model::BetterDipole, Model::StandardDipole];

/// All rules of the roulette.
pub const RULES: [Rule; 3] = [Rule::Mixture, Rule::Mean, Rule::Min];

/// Coefficients of one grey channel in 1/m, the same in all three.
pub fn grey(sigma_a: f64, sigma_s: f64, asymmetry: f64, eta: f64) -> Medium {
    medium([bssrdf::Coefficients { sigma_a, sigma_s, asymmetry }; 3], eta)
}

/// A medium that was never a file: coefficients in 1/m.
pub fn medium(channels: [bssrdf::Coefficients; 3], eta: f64) -> Medium {
    let interface = bssrdf::Interface::new(eta);
    Medium { name: "test".into(), source: String::new(), channels, eta, interface }
}

//! Both phases as functions: a scene to a cloud, a cloud to radiance at a point.

use crate::meshes::World;
use bssrdf::{Medium, Model};
use formats::{
    atomic::Output,
    cloud::{self, Cloud, LightUnit, Normals, Options, Shard},
};
use gather::{
    Filter,
    estimator::{Estimator, Rule},
};
use glam::DVec3;
use sample_surface::{Choice, Pattern, Plan, Sampled, Settings};
use scene::{Camera, NormalKind, Projection};
use std::path::Path;

pub use crate::lit::{Lit, Point};

/// How phase one samples in a test.
#[derive(Clone, Copy, Debug)]
pub struct Sampling {
    pub samples: u64,
    pub choice: Choice,
    pub pattern: Pattern,
    /// Of the samples, on the first material.
    pub share: Option<f64>,
    pub seed: u64,
    pub shard: Shard,
}

/// Independent samples by area.
pub fn by_area(samples: u64, seed: u64) -> Sampling {
    Sampling { samples, choice: Choice::Area, pattern: Pattern::Independent, share: None, seed, shard: Shard::ALONE }
}

/// Well-spread samples by area: what the programs draw by default.
pub fn stratified(samples: u64, seed: u64) -> Sampling {
    Sampling { pattern: Pattern::Stratified, ..by_area(samples, seed) }
}

/// Phase one in memory.
pub fn sampled(world: &World, sampling: &Sampling) -> Sampled {
    sampled_with(world, sampling, NormalKind::Geometric)
}

/// Phase one in memory, with these normals.
pub fn sampled_with(world: &World, sampling: &Sampling, normals: NormalKind) -> Sampled {
    let first = world.scene.materials[0].name.clone();
    let settings = sample_settings(sampling, normals, &first);
    let plan = Plan::new(&world.scene, &settings).expect("the scene has light and a surface");
    sample_surface::sample(&world.scene, &world.rays, &settings, &plan, |_| ()).expect("every flux is finite")
}

/// Settings of phase one for a scene whose first material has this name.
pub fn sample_settings(sampling: &Sampling, normals: NormalKind, first: &str) -> Settings {
    let shares: Vec<(String, f64)> = sampling.share.map(|share| (first.into(), share)).into_iter().collect();
    Settings {
        samples: sampling.samples,
        choice: sampling.choice,
        pattern: sampling.pattern,
        normals,
        translucent: Vec::new(),
        shares: shares.clone(),
        options: Options {
            seed: sampling.seed,
            shard: sampling.shard,
            choice: sampling.choice,
            pattern: sampling.pattern,
            shares,
            normals: if normals == NormalKind::Geometric { Normals::Geometric } else { Normals::Shading },
            metres_per_unit: 1.0,
            light_unit: LightUnit::Radiometric,
            emission_unit: LightUnit::Radiometric,
            environment: "0,0,0".into(),
        },
    }
}

/// Writes what phase one made.
pub fn write(sampled: &Sampled, path: &Path) {
    let mut output = Output::create(path).expect("the temporary folder is writable");
    cloud::write(&mut output, path, &sampled.content, &sampled.meta).expect("the temporary folder is writable");
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
        crop: None,
        paths_per_pixel: 1,
        filter: Filter::Point,
        estimator: Estimator::Exhaustive,
        model,
        normals: NormalKind::Geometric,
        max_depth: 16,
        seed: 1,
    }
}

/// All three models.
pub const MODELS: [Model; 3] = [Model::DirectionalDipole, Model::BetterDipole, Model::StandardDipole];

/// All rules of the roulette.
pub const RULES: [Rule; 3] = [Rule::Mixture, Rule::Mean, Rule::Min];

/// Every estimator: the roulette by each rule, the cut at the accuracy that is its default and at a loose one.
pub const ESTIMATORS: [Estimator; 6] = [
    Estimator::Exhaustive,
    Estimator::Roulette(Rule::Mixture),
    Estimator::Roulette(Rule::Mean),
    Estimator::Roulette(Rule::Min),
    Estimator::Cut { accuracy: 0.01 },
    Estimator::Cut { accuracy: 0.5 },
];

/// Coefficients of one grey channel in 1/m, the same in all three.
pub fn grey(sigma_a: f64, sigma_s: f64, asymmetry: f64, eta: f64) -> Medium {
    medium([bssrdf::Coefficients { sigma_a, sigma_s, asymmetry }; 3], eta)
}

/// A medium that was never a file: coefficients in 1/m.
pub fn medium(channels: [bssrdf::Coefficients; 3], eta: f64) -> Medium {
    let interface = bssrdf::Interface::new(eta);
    Medium { name: "test".into(), source: String::new(), channels, eta, interface }
}

//! Sampling and gathering as functions: a scene to a cloud, a cloud to radiance at a point.

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
use sample_surface::{Choice, Pattern, Plan, Sampled, Settings, Surfaces};
use scene::{Camera, NormalKind, Projection};
use std::path::Path;

pub use crate::lit::{Lit, Point};

/// Settings of sampling in a test.
#[derive(Clone, Copy, Debug)]
pub struct Sampling {
    pub samples: u64,
    pub choice: Choice,
    pub pattern: Pattern,
    /// Share of the samples on the first material.
    pub share: Option<f64>,
    pub seed: u64,
    pub shard: Shard,
}

/// Independent samples by area.
pub fn by_area(samples: u64, seed: u64) -> Sampling {
    Sampling { samples, choice: Choice::Area, pattern: Pattern::Independent, share: None, seed, shard: Shard::ALONE }
}

/// Stratified samples by area, which the programs draw by default.
pub fn stratified(samples: u64, seed: u64) -> Sampling {
    Sampling { pattern: Pattern::Stratified, ..by_area(samples, seed) }
}

/// Samples in memory.
pub fn sampled(world: &World, sampling: &Sampling) -> Sampled {
    sampled_with(world, sampling, NormalKind::Geometric)
}

/// Samples in memory, with these normals.
pub fn sampled_with(world: &World, sampling: &Sampling, normals: NormalKind) -> Sampled {
    let first = world.scene.materials[0].name.clone();
    let settings = sample_settings(sampling, normals, &first);
    let (translucent, _) = Surfaces::translucent(&world.scene).expect("the scene has a surface");
    let surfaces = Surfaces { shares: sampling.share.map(|share| (0, share)).into_iter().collect(), ..translucent };
    let plan = Plan::new(&world.scene, &settings, surfaces).expect("the scene has light");
    sample_surface::sample(&world.scene, &world.rays, &settings, &plan, |_| ()).expect("every flux is finite")
}

/// Settings of `sample-surface` for a scene whose first material has this name.
pub fn sample_settings(sampling: &Sampling, normals: NormalKind, first: &str) -> Settings {
    let options = Options {
        seed: sampling.seed,
        shard: sampling.shard,
        choice: sampling.choice,
        pattern: sampling.pattern,
        shares: sampling.share.map(|share| (first.into(), share)).into_iter().collect(),
        normals: if normals == NormalKind::Geometric { Normals::Geometric } else { Normals::Shading },
        metres_per_unit: 1.0,
        light_unit: LightUnit::Radiometric,
        emission_unit: LightUnit::Radiometric,
        pose: String::new(),
        environment: "0,0,0".into(),
    };
    Settings { samples: sampling.samples, options }
}

/// Writes a cloud.
pub fn write(sampled: &Sampled, path: &Path) {
    let mut output = Output::create(path).expect("the temporary folder is writable");
    cloud::write(&mut output, path, &sampled.content, &sampled.meta).expect("the temporary folder is writable");
    output.commit().expect("the temporary folder is writable");
}

/// Samples a scene into a file and opens it.
pub fn cloud(world: &World, sampling: &Sampling) -> Cloud {
    filed(&sampled(world, sampling))
}

/// Writes a cloud to a file and opens it.
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
        lens: None,
        aspect: None,
    }
}

/// What an uncalibrated image of a world is rendered from.
pub fn input<'a>(world: &'a World, clouds: &'a [Cloud], media: &'a [Medium], camera: &'a Camera) -> gather::Input<'a> {
    gather::Input { scene: &world.scene, rays: &world.rays, clouds, media, tints: &[], calibration: None, camera }
}

/// One path through the center of each pixel, the exhaustive sum, and no light but that of the cloud.
pub fn settings(model: Model, width: usize, height: usize) -> gather::Settings {
    gather::Settings {
        width,
        height,
        crop: None,
        paths_per_pixel: 1,
        filter: Filter::Point,
        estimator: Estimator::Exhaustive,
        balances: false,
        model,
        near_field: false,
        reference: false,
        normals: NormalKind::Geometric,
        max_depth: 16,
        seed: 1,
        backdrop: None,
    }
}

/// All models.
pub const MODELS: [Model; 4] = Model::ALL;

/// The published models, whose values and errors are tabulated.
pub const DIPOLES: [Model; 3] = [Model::DirectionalDipole, Model::BetterDipole, Model::StandardDipole];

/// All rules of the roulette.
pub const RULES: [Rule; 3] = [Rule::Mixture, Rule::Mean, Rule::Min];

/// Every estimator: the roulette with each rule, the cut with its default accuracy and with a loose one.
pub const ESTIMATORS: [Estimator; 6] = [
    Estimator::Exhaustive,
    Estimator::Roulette(Rule::Mixture),
    Estimator::Roulette(Rule::Mean),
    Estimator::Roulette(Rule::Min),
    Estimator::Cut { accuracy: 0.01 },
    Estimator::Cut { accuracy: 0.5 },
];

/// A medium with these coefficients in all three channels, 1/m.
pub fn gray(sigma_a: f64, sigma_s: f64, asymmetry: f64, eta: f64) -> Medium {
    medium([bssrdf::Coefficients { sigma_a, sigma_s, asymmetry }; 3], eta)
}

/// A medium from coefficients, 1/m.
pub fn medium(channels: [bssrdf::Coefficients; 3], eta: f64) -> Medium {
    let interface = bssrdf::Interface::new(eta);
    Medium { name: "test".into(), source: String::new(), channels, eta, interface }
}

//! Sampling and gathering on an accepted scene.

use bssrdf::{Medium, Model, built_in};
use formats::cloud::Cloud;
use gather::{
    Filter, Input,
    estimator::{Estimator, Rule},
};
use sample_surface::{Choice, Pattern, Plan, SampleError, Sampled, Surfaces, sample};
use scene::{NormalKind, Rays, Scene};
use test_support::pipeline::{self, Sampling, by_area, sample_settings};

const SAMPLES: u64 = 40;

/// Side of the image, pixels.
const SIDE: usize = 2;

/// Beyond this, numbers may leave float32; the programs then end with exit code 3.
const SANE: f64 = 1e12;

/// A cloud is drawn or refused. A drawn cloud can be read again, and an image of it has finite numbers, unless those
/// of the scene are absurd.
pub fn check_pipeline(scene: &Scene, rays: &Rays) {
    let ways = [
        (Choice::Area, Pattern::Stratified, NormalKind::Shading, Estimator::Cut { accuracy: 0.01 }),
        (Choice::Uniform, Pattern::Independent, NormalKind::Geometric, Estimator::Roulette(Rule::Mixture)),
    ];
    for (choice, pattern, normals, estimator) in ways {
        let sampling = Sampling { choice, pattern, ..by_area(SAMPLES, 0) };
        let settings = sample_settings(&sampling, normals, "");
        let Ok((surfaces, _)) = Surfaces::translucent(scene) else { return };
        let Ok(plan) = Plan::new(scene, &settings, surfaces) else { return };
        match sample(scene, rays, &settings, &plan, |_| ()) {
            Ok(sampled) => render(scene, rays, &filed(&sampled), normals, estimator),
            Err(error) => assert!(matches!(error, SampleError::NotFinite { .. }), "{error}"),
        }
    }
}

fn filed(sampled: &Sampled) -> Cloud {
    crate::file::with_file("a.cloud", &[], |path| {
        pipeline::write(sampled, path);
        let cloud = Cloud::open(path).expect("its own cloud");
        cloud.verify(path).expect("undamaged");
        cloud
    })
}

fn render(scene: &Scene, rays: &Rays, cloud: &Cloud, normals: NormalKind, estimator: Estimator) {
    let medium = |index: u16| {
        let own = cli::scene_medium(&scene.materials[usize::from(index)]).ok().flatten();
        own.or_else(|| built_in("marble").ok()).expect("a medium")
    };
    let media: Vec<Medium> = cloud.meta().materials.iter().map(|m| medium(m.index)).collect();
    let brightest = cloud.meta().mean_flux_w.into_iter().fold(0.0, f64::max) * SAMPLES as f64;
    let size = scene.mesh.diagonal();
    for camera in &scene.cameras {
        let settings = gather::Settings {
            paths_per_pixel: 2,
            filter: Filter::Box,
            estimator,
            balances: false,
            normals,
            max_depth: 8,
            near_field: true,
            ..pipeline::settings(Model::DirectionalDipole, SIDE, SIDE)
        };
        let input = Input {
            scene,
            rays,
            clouds: std::slice::from_ref(cloud),
            media: &media,
            tints: &[],
            calibration: None,
            camera,
        };
        let rendered = gather::render(&input, &settings, |_| ());
        let sane = brightest < SANE && (1.0 / SANE..SANE).contains(&size);
        assert!(!sane || rendered.non_finite_count == 0, "{brightest} W, {size} m: {:?}", rendered.non_finite);
    }
}

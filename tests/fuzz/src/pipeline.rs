//! Both phases, on a scene that was accepted.

use bssrdf::{Medium, Model, built_in};
use formats::{
    atomic::Output,
    cloud::{self, Cloud, Options, Shard},
};
use gather::{
    Filter, Input,
    estimator::{Estimator, Rule},
};
use sample_surface::{Choice, Pattern, Plan, SampleError, Sampled, Settings, sample};
use scene::{NormalKind, Rays, Scene};

const SAMPLES: u64 = 40;

/// Pixels a side.
const SIDE: usize = 2;

/// Beyond, numbers may get too large for float32; then the programs end with 3.
const SANE: f64 = 1e12;

/// A cloud is drawn or refused. One that was drawn can be read again, and an image is made of it: of finite numbers, unless
/// the scene's are absurd.
pub fn check_pipeline(scene: &Scene, rays: &Rays) {
    let ways = [
        (Choice::Area, Pattern::Stratified, NormalKind::Shading, Estimator::Cut { accuracy: 0.01 }),
        (Choice::Uniform, Pattern::Independent, NormalKind::Geometric, Estimator::Roulette(Rule::Mixture)),
    ];
    for (choice, pattern, normals, estimator) in ways {
        let settings = sampling(choice, pattern, normals);
        let Ok(plan) = Plan::new(scene, &settings) else { return };
        match sample(scene, rays, &settings, &plan, |_| ()) {
            Ok(sampled) => render(scene, rays, &filed(&sampled), normals, estimator),
            Err(error) => assert!(matches!(error, SampleError::NotFinite { .. }), "{error}"),
        }
    }
}

fn sampling(choice: Choice, pattern: Pattern, normals: NormalKind) -> Settings {
    Settings {
        samples: SAMPLES,
        choice,
        pattern,
        normals,
        translucent: Vec::new(),
        shares: Vec::new(),
        options: Options {
            seed: 0,
            shard: Shard::ALONE,
            choice: choice.name().into(),
            pattern: pattern.name().into(),
            shares: Vec::new(),
            normals: if normals == NormalKind::Shading { "shading" } else { "geometric" }.into(),
            metres_per_unit: 1.0,
            light_unit: "radiometric".into(),
            emission_unit: "radiometric".into(),
            environment: "0,0,0".into(),
        },
    }
}

fn filed(sampled: &Sampled) -> Cloud {
    crate::file::with_file("a.cloud", &[], |path| {
        let mut output = Output::create(path).expect("a temporary file");
        cloud::write(&mut output, path, &sampled.content, &sampled.meta).expect("room");
        output.commit().expect("a temporary file");
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
            width: SIDE,
            height: SIDE,
            crop: None,
            paths_per_pixel: 2,
            filter: Filter::Box,
            estimator,
            model: Model::DirectionalDipole,
            normals,
            max_depth: 8,
            seed: 0,
        };
        let input = Input { scene, rays, clouds: std::slice::from_ref(cloud), media: &media, camera };
        let rendered = gather::render(&input, &settings, |_| ());
        let sane = brightest < SANE && (1.0 / SANE..SANE).contains(&size);
        assert!(!sane || rendered.non_finite_count == 0, "{brightest} W, {size} m: {:?}", rendered.non_finite);
    }
}

//! Whole scenes at all scales: mean free paths from a millionth to a million times the object.

use crate::scenes::{aimed_at, render};
use bssrdf::{Coefficients, Model};
use gather::{Filter, Settings, estimator::Estimator};
use glam::DVec3;
use test_support::{
    meshes::{Light, Part, World, slab, world},
    pipeline::{ESTIMATORS, MODELS, by_area, cloud, gray, medium, settings},
};

fn lit_slab(size: f64) -> World {
    let sun = Light::Directional { towards: DVec3::new(0.36, 0.48, 0.8), irradiance: DVec3::ONE };
    world(&[Part::translucent(slab(DVec3::new(1.0, 1.0, 0.25) * size, 2))], &[sun], DVec3::ZERO)
}

/// From opaque to almost clear, by all models and estimators. At a millionth of a mean free path almost nothing is
/// left to scatter: `S` is below its value at the sample, which is `σ_t'²` times that for `σ_t' = 1`. The half-space
/// model follows light of one scattering, `1/r`, down to 2⁻¹¹ mean free paths.
#[test]
fn mean_free_path_from_a_millionth_to_a_million_of_the_object() {
    let world = lit_slab(0.5);
    let cloud = cloud(&world, &by_area(2000, 1));
    let camera = aimed_at(DVec3::ZERO, DVec3::new(0.3, 0.2, 1.0), 0.4);
    for exponent in -6..=6 {
        let sigma = 10f64.powi(exponent);
        let media = [medium([0.0, 0.01, 1.0].map(|share| channel(sigma, share)), 1.3)];
        for (model, estimator) in MODELS.into_iter().flat_map(|m| ESTIMATORS.map(|e| (m, e))) {
            let settings = Settings { paths_per_pixel: 2, filter: Filter::Box, estimator, ..settings(model, 8, 8) };
            let rendered = render(&world, &cloud, &media, &camera, &settings);
            assert!(rendered.counts.gathers > 0);
            let brightest = rendered.pixels.iter().map(|p| p.beauty().max_element()).fold(0.0, f64::max);
            let peak = if model == Model::HalfSpace { 100.0 } else { 10.0 };
            assert!(exponent > -3 || brightest < peak * sigma * sigma, "{model:?} {estimator:?} {sigma}: {brightest}");
        }
    }
}

fn channel(sigma_s: f64, share: f64) -> Coefficients {
    Coefficients { sigma_a: share * sigma_s, sigma_s, asymmetry: 0.0 }
}

/// Object, camera and mean free path scaled together by powers of two give every bit of the image again.
#[test]
fn pictures_of_any_size_are_the_same() {
    let picture = |exponent: i32| {
        let size = 2f64.powi(exponent);
        let world = lit_slab(size);
        let cloud = cloud(&world, &by_area(500, 1));
        let camera = aimed_at(DVec3::ZERO, DVec3::new(0.3, 0.2, 1.0), size);
        let camera = scene::Camera { position: camera.position * size, ..camera };
        let medium = [gray(1.0 / size, 10.0 / size, 0.0, 1.3)];
        let estimator = Estimator::Roulette(gather::estimator::Rule::Mixture);
        MODELS.map(|model| {
            let settings = Settings { paths_per_pixel: 4, filter: Filter::Box, estimator, ..settings(model, 8, 8) };
            let rendered = render(&world, &cloud, &medium, &camera, &settings);
            rendered.pixels.iter().map(|p| p.beauty()).collect::<Vec<_>>()
        })
    };
    let first = picture(0);
    assert!(first.iter().flatten().any(|p| p.x > 0.0));
    for exponent in [-30, -20, -10, 10, 20, 30] {
        assert_eq!(picture(exponent), first, "2^{exponent} m");
    }
}

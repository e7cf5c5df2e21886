//! Textures of translucent surfaces (docs/method.md section 20).

use crate::stripes::{Stripes, along, medium};
use bssrdf::{Medium, Model};
use formats::cloud::Cloud;
use gather::{
    Input, Settings,
    estimator::{Estimator, Scatterer, Scratch},
};
use glam::DVec3;
use scene::texture::{Picture, Texture, Wrap};
use std::{slice::from_ref, sync::Arc};
use sums::{Summation, drawn::DrawnCounts, samples::Exit};
use test_support::{
    EFFORT,
    meshes::{Light, Part, World, sphere, world},
    pipeline::{cloud, orthographic, settings, stratified},
    random::Random,
    z_test::{Estimate, assert_equal, assert_mean},
};
use tint::{Tint, Tinted};

/// The medium of this name.
fn named(name: &str, sigma_s: f64) -> Medium {
    let text = format!(
        r#"{{"name":"{name}","unit":"1/m","sigma_a":[50,100,200],"sigma_s":[{sigma_s},{sigma_s},{sigma_s}],"eta":1.3}}"#
    );
    Medium::from_json(&text).expect("a medium")
}

/// A sphere in the sun whose texture has these codes, one beside the other along x.
fn textured(codes: &[[u8; 4]]) -> World {
    let towards = DVec3::new(0.3, 0.2, 1.0).normalize();
    let sun = Light::Directional { towards, irradiance: DVec3::splat(3.0) };
    let mut world = world(&[Part::translucent(sphere(0.01, 3))], &[sun], DVec3::ZERO);
    let picture = Arc::new(Picture { width: codes.len(), texels: codes.to_vec() });
    let texture = Texture { picture, wrap: [Wrap::Clamp; 2], nearest: true };
    world.scene.materials[0].base_texture = Some(texture);
    world.scene.mesh.coordinates = world.scene.mesh.positions.iter().map(|p| [0.5 + 40.0 * p.x, 0.5]).collect();
    world
}

fn tinted(world: &World, cloud: &Cloud, medium: &Medium, model: Model) -> Tinted {
    let (tint, _) = Tint::new(&world.scene, 0, medium, model).expect("it has a texture");
    let tinted = Tinted::new(&world.scene, &world.rays, from_ref(cloud), 0, tint);
    assert_eq!(tinted.lost, 0);
    tinted
}

/// The pixels of an image of the world from above.
fn image(world: &World, cloud: &Cloud, medium: &Medium, tints: &[Option<Tinted>], settings: &Settings) -> Vec<DVec3> {
    let camera = orthographic(DVec3::new(0.2, -0.3, 1.0), 0.011);
    let (scene, rays, clouds, media) = (&world.scene, &world.rays, from_ref(cloud), from_ref(medium));
    let input = Input { scene, rays, clouds, media, tints, calibration: None, camera: &camera };
    gather::render(&input, settings, |_| ()).pixels.iter().map(|pixel| pixel.beauty()).collect()
}

/// A texture of one color is the same factor on the light that is scattered if the file states the medium by colors; below
/// any other medium it has no effect, for the medium is that of its mean.
///
/// Seen to catch: the whole factor at each crossing; no factor at the exit; near points without factor.
#[test]
fn a_constant_texture_is_a_factor() {
    /// The linear value of the code 188 of sRGB (IEC 61966-2-1).
    const GRAY: f64 = 0.502_886_458;
    let world = textured(&[[188, 188, 188, 255]]);
    let cloud = cloud(&world, &stratified(5000, 3));
    for near_field in [false, true] {
        let settings = Settings { near_field, max_depth: 1, ..settings(Model::HalfSpace, 8, 8) };
        for (name, factor) in [("KHR_materials_scatter", GRAY), ("wax", 1.0)] {
            let medium = named(name, 4000.0);
            let tints = [Some(tinted(&world, &cloud, &medium, Model::HalfSpace))];
            let plain = image(&world, &cloud, &medium, &[], &settings);
            let own = image(&world, &cloud, &medium, &tints, &settings);
            assert!(plain.iter().filter(|light| light.x > 0.0).count() > 20);
            for (own, plain) in own.iter().zip(&plain) {
                assert!((*own - factor * *plain).abs().max_element() <= 1e-5 * plain.max_element(), "{own} {plain}");
            }
        }
    }
}

const TWO_TONES: [[u8; 4]; 2] = [[255, 120, 60, 255], [60, 255, 120, 255]];

/// The cut of tinted samples has the mean of their whole sum, over the random numbers of many gathers.
#[test]
fn the_cut_of_tinted_samples_has_the_mean_of_the_sum() {
    let world = textured(&TWO_TONES);
    let (cloud, medium) = (cloud(&world, &stratified(20_000, 5)), named("wax", 1500.0));
    let tinted = tinted(&world, &cloud, &medium, Model::HalfSpace);
    let scatterer = Arc::new(Scatterer::new(Model::HalfSpace, &medium, 0.02));
    let summation = Summation::new(scatterer, tinted.samples(medium.eta), DrawnCounts::of(from_ref(&cloud)));
    let radiance = |estimator: Estimator, normal: DVec3, key: u64| {
        let exit = |half: usize| Exit::new(normal * 0.01, normal, key ^ half as u64);
        summation.whole(estimator, exit, &mut Scratch::default()).radiance
    };
    let mut random = Random(17);
    for normal in [DVec3::Z, DVec3::X, DVec3::new(-0.8, 0.0, 0.6)] {
        let whole = radiance(Estimator::Exhaustive, normal, 0).element_sum();
        let mut run = || radiance(Estimator::Cut { accuracy: 0.3 }, normal, random.bits()).element_sum() / whole;
        let runs: Vec<f64> = (0..400 * EFFORT).map(|_| run()).collect();
        let estimate = Estimate::of(&runs);
        assert!(estimate.error < 0.02, "{estimate:?}");
        assert_mean(&format!("at {normal}"), estimate, 1.0);
    }
}

/// Light that enters near is tinted as that of samples: both estimates have the same mean over clouds.
#[test]
fn near_points_are_tinted_as_samples() {
    let world = textured(&TWO_TONES);
    let medium = named("wax", 3000.0);
    let [with, without] = [true, false].map(|near_field| {
        let run = |seed: u64| {
            let cloud = cloud(&world, &stratified(2000, seed));
            let tints = [Some(tinted(&world, &cloud, &medium, Model::HalfSpace))];
            let settings = Settings { near_field, max_depth: 1, seed, ..settings(Model::HalfSpace, 12, 12) };
            image(&world, &cloud, &medium, &tints, &settings).iter().sum::<DVec3>().element_sum()
        };
        Estimate::of(&(1..=40 * EFFORT).map(run).collect::<Vec<f64>>())
    });
    assert!(with.relative_error() < 0.01 && without.relative_error() < 0.03, "{with:?} {without:?}");
    assert_equal("near points", with, without);
}

/// Stripes whose reflectance is `1 ± contrast` times that of the medium: beyond one mean free path from their edges the
/// model with a texture is within 10 % of random walks through stripes of the albedos with these reflectances.
///
/// Seen to catch: the whole factor at the exit; one color.
#[test]
fn stripes_reflect_as_striped_media() {
    const PERIOD: f64 = 16.0;
    const BINS: usize = 32;
    for (albedo, contrast) in [(0.5, 0.6), (0.8, 0.5), (0.9, 0.3), (0.97, 0.15)] {
        let own = Model::HalfSpace.reflectance(&medium([1.0, albedo]))[0];
        let factors = [1.0 + contrast, 1.0 - contrast];
        let albedos = factors.map(|factor| {
            let (mut low, mut high) = (0.0, 1.0);
            for _ in 0..30 {
                let middle = 0.5 * (low + high);
                let reflected = Model::HalfSpace.reflectance(&medium([1.0, middle]))[0];
                if reflected < factor * own { low = middle } else { high = middle }
            }
            high
        });
        let stripes = Stripes { media: albedos.map(|albedo| [1.0, albedo]), period: PERIOD, bins: BINS };
        let bare = along(&medium([1.0, albedo]));
        let model = stripes.model(|a, b, x| bare(x) * (factors[a] * factors[b]).sqrt());
        let worst = stripes.worst(&model);
        println!("albedo {albedo}, {albedos:?}: within {:.1} %", 100.0 * worst);
        assert!(worst < 0.1, "albedo {albedo}, contrast {contrast}: {worst}");
    }
}

//! One result per seed: pinned random numbers, the same bytes for any number of threads, the same bits for any vector
//! width.

use bssrdf::{
    Medium, Model, built_in,
    lanes::{BetterLanes, DirectionalLanes, LaneModel, StandardLanes},
    simd,
};
use formats::cloud::Cloud;
use gather::{
    Filter, Input, Rendered, Settings,
    estimator::{Estimator, Exhaustive, Roulette, Rule, Sum, random_bits},
    samples::{Exit, LitSamples},
};
use glam::DVec3;
use scene::{
    NormalKind,
    random::{Purpose, Stream},
};
use std::fs;
use support::{
    meshes::{Light, Part, World, slab, sphere, world},
    pipeline::{MODELS, RULES, by_area, cloud, orthographic, sampled, settings, write},
};

/// Changing these changes every cloud and image: a new cloud version, and new golden images.
#[test]
fn first_random_numbers_are_pinned() {
    let bits = |stream: Stream, item: u64| [0, 1, 2, 3].map(|d| stream.item(item).bits(d));
    let surface = Stream::new(0, Purpose::Surface);
    assert_eq!(
        bits(surface, 0),
        [0x568a_9b0b_1a2c_05ec, 0x44e5_b8b1_47ef_718b, 0x4585_63ab_5552_1133, 0x7aec_6445_39b6_c0f9]
    );
    assert_eq!(
        bits(surface, 1 << 40),
        [0x889f_9966_eed6_89d8, 0x7de5_aaba_8463_a129, 0xdc8a_a0b6_20e8_c511, 0xb7b6_2ec8_6b79_e925]
    );
    assert_eq!(
        bits(Stream::new(1, Purpose::CameraPath), 7),
        [0xfef7_27d1_3e88_ad18, 0x04e9_e17f_5b62_d955, 0xe03c_af98_49e6_3f94, 0x20f2_fb99_4103_c58c]
    );
    assert_eq!(
        bits(Stream::new(u64::MAX, Purpose::Roulette), 1),
        [0x35a5_92f9_18c4_fefe, 0xa1ea_2792_e273_8ac8, 0x29e4_02d1_c0ea_0e74, 0x05e6_d95d_aae0_6379]
    );
    assert_eq!(surface.item(0).uniform(0), 0.338_052_454_195_505_45);
}

/// The roulette's own bits: changing these changes images, not clouds.
#[test]
fn first_bits_of_the_roulette_are_pinned() {
    let values = [(1, 0), (0, 1 << 32), (7, 0x0123_4567_89ab_cdef)].map(|(index, key)| random_bits(index, key));
    assert_eq!(values, [0x58f5_4975, 0x6889_90c0, 0xc4fb_e3e2]);
}

/// Two bodies, three kinds of light, shadows.
fn still_life() -> World {
    let lights = [
        Light::Directional { towards: DVec3::new(0.48, 0.6, 0.64), irradiance: DVec3::new(1.0, 0.8, 0.5) },
        Light::Point { position: DVec3::new(-0.02, 0.01, 0.03), intensity: DVec3::splat(1e-3) },
    ];
    let ball = Part::translucent(sphere(4e-3, 3));
    let mut plate = slab(DVec3::new(8e-3, 8e-3, 1e-3), 4);
    plate.positions.iter_mut().for_each(|p| p.z -= 6e-3);
    world(&[ball, Part::opaque(plate)], &lights, DVec3::splat(0.2))
}

fn with_threads<T: Send>(threads: usize, work: impl FnOnce() -> T + Send) -> T {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads can be started");
    pool.install(work)
}

#[test]
fn clouds_have_the_same_bytes_for_any_number_of_threads() {
    let folder = tempfile::tempdir().expect("the temporary folder is writable");
    let file = |threads: usize| {
        let path = folder.path().join(format!("{threads}.cloud"));
        with_threads(threads, || write(&sampled(&still_life(), &by_area(100_000, 3)), &path));
        fs::read(path).expect("the cloud was written")
    };
    let one = file(1);
    assert!(one.len() > 1_000_000);
    assert!(one == file(2) && one == file(7), "the cloud depends on the number of threads");
}

fn render(world: &World, cloud: &Cloud, estimator: Estimator) -> Rendered {
    let media = [built_in("skin1").expect("a built-in medium")];
    let camera = orthographic(DVec3::new(0.2, -1.0, 0.5), 8e-3);
    let settings = Settings {
        paths_per_pixel: 4,
        filter: Filter::Box,
        estimator,
        normals: NormalKind::Shading,
        environment: DVec3::splat(0.2),
        ..settings(Model::DirectionalDipole, 40, 30)
    };
    let input = Input { scene: &world.scene, rays: &world.rays, cloud, media: &media, camera: &camera };
    gather::render(&input, &settings, |_| ())
}

#[test]
fn images_are_the_same_for_any_number_of_threads() {
    let world = still_life();
    let cloud = cloud(&world, &by_area(3000, 3));
    for estimator in [Estimator::Exhaustive, Estimator::Roulette(Rule::Mixture)] {
        let image = |threads: usize| {
            let rendered = with_threads(threads, || render(&world, &cloud, estimator));
            let image = gather::film::image(&rendered.pixels, 40, 30);
            let bits: Vec<u32> = image.channels.iter().flat_map(|c| c.samples.iter().map(|x| x.to_bits())).collect();
            (bits, format!("{:?}", rendered.counts))
        };
        let one = image(1);
        assert!(one.0.iter().any(|x| *x != 0));
        assert!(one == image(2) && one == image(7), "the image depends on the number of threads: {estimator:?}");
    }
}

/// Sums by the plain body and by the widest vectors of this processor.
fn both_ways<M: LaneModel>(
    medium: &Medium,
    transport: [f64; 3],
    samples: &LitSamples,
    exit: &Exit,
    estimator: Estimator,
) -> [Sum; 2] {
    let model = &M::new(medium);
    match estimator {
        Estimator::Exhaustive => {
            let kernel = || Exhaustive { model, samples, exit };
            [simd::run_plain(kernel()), simd::dispatch(kernel())]
        }
        Estimator::Roulette(rule) => {
            let kernel = || Roulette { model, samples, exit, rates: rule.rates(transport) };
            [simd::run_plain(kernel()), simd::dispatch(kernel())]
        }
    }
}

#[test]
fn sums_have_the_same_bits_for_any_vector_width() {
    let world = still_life();
    let cloud = cloud(&world, &by_area(20_000, 3));
    let estimators = RULES.map(Estimator::Roulette).into_iter().chain([Estimator::Exhaustive]);
    let cases: Vec<(Model, Estimator)> = estimators.flat_map(|e| MODELS.map(|model| (model, e))).collect();
    let mut lit = 0;
    for medium in ["skin1", "marble", "espresso"].map(|name| built_in(name).expect("a built-in medium")) {
        let samples = LitSamples::new(cloud.samples(0, cloud.meta().materials[0].count), medium.eta);
        for (model, estimator) in &cases {
            for normal in [DVec3::Z, DVec3::NEG_X, DVec3::new(0.6, -0.8, 0.0)] {
                let exit = Exit::new(normal * 4e-3, normal, 77);
                let transport = model.of(&medium).transport();
                let both = match model {
                    Model::DirectionalDipole => both_ways::<DirectionalLanes>,
                    Model::BetterDipole => both_ways::<BetterLanes>,
                    Model::StandardDipole => both_ways::<StandardLanes>,
                };
                let [plain, wide] = both(&medium, transport, &samples, &exit, *estimator);
                let bits = |s: &Sum| (s.radiance.to_array().map(f64::to_bits), s.evaluations);
                assert_eq!(bits(&plain), bits(&wide), "{} {} {estimator:?}", medium.name, model.name());
                lit += u32::from(plain.radiance.min_element() > 0.0);
            }
        }
    }
    assert!(lit > 80, "only {lit} of 108 sums are not zero");
}
